// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/offset.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "ground/numbers/rounding.h"
#include "space/query/closest_query.h"
#include "support/oracles.h"
#include "support/random_scenes.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

Polygons triangles_of(const Polygons& mesh) {
  Polygons result;
  result.positions = mesh.positions;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    for (std::size_t k = 2; k < face.size(); ++k) result.add_face({face[0], face[k - 1], face[k]});
  }
  return result;
}

double diagonal_of(const Polygons& mesh) { return build_surface(mesh.view(), {}).facts.diagonal; }

OffsetOptions options_for(Distances distance, Corners corners = Corners::Round) {
  OffsetOptions options;
  options.distance = std::move(distance);
  options.corners = corners;
  return options;
}

Tolerance tolerance_of(double share, std::size_t most_faces = 0) {
  Tolerance tolerance;
  tolerance.share = share;
  tolerance.most_faces = most_faces;
  return tolerance;
}

const CertifiedFaces& certified_of(const RefinedOffset& refined) { return refined.result.statistics.certified.value(); }

/// The source's vertices come first and are where they were, the pieces of its faces stand in their place.
void require_source_kept(const Polygons& mesh, const RefinedOffset& refined) {
  const auto& [polygons, parent, added, over_ridges, over_corners] = refined.refinement;
  REQUIRE(refined.result.positions.size() == polygons.positions.size());
  REQUIRE(refined.refinement.source_vertices() == mesh.positions.size());
  CHECK(std::equal(mesh.positions.begin(), mesh.positions.end(), polygons.positions.begin()));
  CHECK(std::is_sorted(parent.begin(), parent.end()));
  REQUIRE(parent.size() == polygons.face_count());
  CHECK((parent.front() == 0 && parent.back() + 1 == mesh.face_count()));
  CHECK(certified_of(refined).source_faces == mesh.face_count());
  CHECK(certified_of(refined).source_vertices == mesh.positions.size());
}

void require_result_valid(const RefinedOffset& refined, const OffsetOptions& options) {
  CheckOptions check;
  check.distance = refined.result.distances;
  check.corners = options.corners;
  for (const auto f : refined.refinement.parent)
    if (!options.only.empty()) check.only.push_back(options.only[f]);
  CHECK(check_offset(refined.refinement.polygons.view(), refined.result.positions, check).valid());
}

/// Points spread evenly over the area of the triangles whose vertices all get there.
struct SpreadPoints {
  std::vector<Vec3d> at;
  std::vector<double> asked;
};
SpreadPoints spread_points(const RefinedOffset& refined, int count, const std::vector<std::uint8_t>& only = {}) {
  const PolygonView mesh = refined.refinement.polygons.view();
  const auto& [positions, states, achieved, distances, turned, statistics, field, paths, errors, faults] =
      refined.result;
  const auto gets_there = [&, &all = states](std::uint32_t v) {
    return all[v] == VertexState::Reached || all[v] == VertexState::Mitered;
  };
  std::vector<double> area_up_to;
  std::vector<std::size_t> faces;
  double area = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    REQUIRE(face.size() == 3);
    if (!std::all_of(face.begin(), face.end(), gets_there)) continue;
    if (!only.empty() && !only[refined.refinement.parent[f]]) continue;
    const Vec3d &a = refined.result.positions[face[0]], &b = refined.result.positions[face[1]];
    area += (b - a).cross(refined.result.positions[face[2]] - a).length();
    area_up_to.push_back(area);
    faces.push_back(f);
  }
  REQUIRE(area > 0);
  std::mt19937 random(1);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  SpreadPoints points;
  for (int i = 0; i < count; ++i) {
    const auto one = std::upper_bound(area_up_to.begin(), area_up_to.end(), unit() * area) - area_up_to.begin();
    const auto face = mesh.face(faces[std::min(static_cast<std::size_t>(one), faces.size() - 1)]);
    double u = unit(), v = unit();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const std::array<double, 3> shares = {1 - u - v, u, v};
    Vec3d x(0.0);
    double asked = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      x += refined.result.positions[face[k]] * shares[k];
      asked += std::abs(refined.result.distances[face[k]]) * shares[k];
    }
    points.at.push_back(x);
    points.asked.push_back(asked);
  }
  return points;
}

/// The errors of some points, as shares of what is asked there, from exact distances to a mesh.
std::vector<double> errors_of(const Polygons& source, const SpreadPoints& points) {
  Surface surface = build_surface(source.view(), {});
  to_local_frame(surface, surface.facts.diagonal / 50);
  const ClosestQuery query(surface);
  std::vector<Vec3d> local = points.at;
  for (Vec3d& x : local) x -= surface.origin;
  const std::vector<Closest> closest = closest_points(query, local);
  std::vector<double> errors(closest.size());
  for (std::size_t i = 0; i < closest.size(); ++i)
    errors[i] = std::abs(closest[i].distance - points.asked[i]) / points.asked[i];
  return errors;
}
double worst_share(const Polygons& source, const SpreadPoints& points) {
  const std::vector<double> errors = errors_of(source, points);
  return *std::max_element(errors.begin(), errors.end());
}

double worst_share_by_brute_force(const Polygons& source, const SpreadPoints& points) {
  double worst = 0;
  for (std::size_t i = 0; i < points.at.size(); ++i)
    worst = std::max(
        worst, std::abs(test::brute_force_distance(source.view(), points.at[i]) - points.asked[i]) / points.asked[i]);
  return worst;
}

/// The most pieces that a face has which stays, and has no corner in the part.
std::size_t largest_split_off(const Polygons& mesh, const Polygons& part, const std::vector<std::uint8_t>& only,
                              const Refinement& refinement) {
  std::vector<std::uint8_t> on_part(mesh.positions.size(), 0);
  for (const auto v : part.corners) on_part[v] = 1;
  std::vector<std::size_t> pieces(mesh.face_count(), 0);
  for (const auto f : refinement.parent) ++pieces[f];
  std::size_t most = 0;
  for (std::size_t f = 0; f < pieces.size(); ++f) {
    const auto face = mesh.view().face(f);
    if (!only[f] && std::none_of(face.begin(), face.end(), [&](auto v) { return on_part[v] != 0; }))
      most = std::max(most, pieces[f]);
  }
  return most;
}

/// A cone with so many sides, over one polygon of as many corners.
Polygons cone(std::uint32_t sides) {
  constexpr double kPi = 3.14159265358979323846;
  Polygons mesh;
  std::vector<std::uint32_t> base;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * kPi * i / sides;
    mesh.positions.emplace_back(2 * std::cos(angle), 2 * std::sin(angle), -2);
    base.insert(base.begin(), i);
  }
  mesh.positions.emplace_back(0, 0, 2);
  for (std::uint32_t i = 0; i < sides; ++i) mesh.add_face({i, (i + 1) % sides, sides});
  mesh.corners.insert(mesh.corners.end(), base.begin(), base.end());
  mesh.close_face();
  return mesh;
}

/// A box of 6 by 18 by 5.5 with a hole along z that leaves walls of `wall` in x, and of 1.85 in y.
Polygons frame(double wall) {
  Polygons mesh;
  for (const double z : {0.0, 5.5}) {
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {6.0, 0.0}, {6.0, 18.0}, {0.0, 18.0}})
      mesh.positions.emplace_back(x, y, z);
    for (const auto& [x, y] : {std::pair{wall, 1.85}, {6 - wall, 1.85}, {6 - wall, 16.15}, {wall, 16.15}})
      mesh.positions.emplace_back(x, y, z);
  }
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t a = i, b = (i + 1) % 4;
    mesh.add_face({a, b, b + 8, a + 8});            // outside
    mesh.add_face({b + 4, a + 4, a + 12, b + 12});  // in the hole
    mesh.add_face({b, a, a + 4, b + 4});            // below
    mesh.add_face({a + 8, b + 8, b + 12, a + 12});  // above
  }
  return triangles_of(mesh);
}

/// Pairs of faces of a mesh, the lower number first, that meet where its vertices, or those of its pieces, stand.
std::vector<std::pair<std::uint32_t, std::uint32_t>> faces_that_meet(const Polygons& pieces,
                                                                     const std::vector<Vec3d>& positions,
                                                                     const std::vector<std::uint32_t>& parent) {
  const Surface surface = build_surface(pieces.view(), {});
  std::vector<Vec3d> moved(surface.vertices.size());
  for (std::size_t w = 0; w < moved.size(); ++w) moved[w] = positions[surface.representative[w]];
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& [s, t] : CrossingFinder(surface, moved).all()) {
    const auto [first, second] = std::minmax(parent[surface.face[s]], parent[surface.face[t]]);
    pairs.emplace_back(first, second);
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

constexpr int kManyPoints = 100000;
// Of the tolerance: rounding, and what the prover allows for it.
constexpr double kRounded = 1 + 1e-9;

/// Offsets a mesh of triangles, all of which has room.
RefinedOffset offset_all(const Polygons& mesh, const OffsetOptions& options, double share) {
  RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(share));
  require_source_kept(mesh, refined);
  require_result_valid(refined, options);
  const CertifiedFaces& certified = certified_of(refined);
  CHECK(certified.share == share);
  CHECK(certified.there == 1);
  CHECK(certified.certified == Approx(1).epsilon(1e-12));
  CHECK(certified.worst_left == 0);
  CHECK(!certified.out_of_faces);
  CHECK(worst_share(mesh, spread_points(refined, kManyPoints)) <= share * kRounded);
  return refined;
}

}  // namespace

TEST_CASE("tolerance: a cube with round corners, against brute force", "[tolerance][no_races]") {
  const Polygons mesh = shapes::box(Vec3d(1), 1, true);
  for (const double share : {0.05, 0.01, -0.05, -0.01}) {
    CAPTURE(share);
    const OffsetOptions options = options_for(share * std::sqrt(3));
    const RefinedOffset refined = offset_all(mesh, options, 0.01);
    CHECK(worst_share_by_brute_force(mesh, spread_points(refined, kManyPoints)) <= 0.01 * kRounded);
    // Vertices of the cube go where they go without.
    const OffsetResult coarse = offset(mesh.view(), options);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) CHECK(refined.result.positions[v] == coarse.positions[v]);
    // Without, an eighth of a ball is one point, unless it is on the inside.
    const double off = share > 0 ? 1 - std::sqrt(1 / 3.0) : 0;
    CHECK(coarse.statistics.faces.worst == Approx(off).margin(0.02));
    if (share < 0) CHECK(refined.refinement.added.empty());
  }
}

TEST_CASE("tolerance: balls, rings and bumps at 1 % of the distance", "[tolerance][long]") {
  const std::vector<std::pair<const char*, Polygons>> kMeshes = {{"ball", shapes::icosphere(1, 2)},
                                                                 {"ring", triangles_of(shapes::torus(1, 0.4, 32, 16))},
                                                                 {"bumps", shapes::bumpy_sphere(1, 0.1, 1, 3, 3)}};
  for (const auto& [name, mesh] : kMeshes)
    for (const double share : {0.01, 0.05, -0.01, -0.05}) {
      CAPTURE(name, share);
      offset_all(mesh, options_for(share * diagonal_of(mesh)), 0.01);
    }
}

TEST_CASE("tolerance: the same at 0.1 %", "[tolerance][long]") {
  const Polygons cube = shapes::box(Vec3d(1), 1, true);
  const RefinedOffset round = offset_all(cube, options_for(0.05 * std::sqrt(3)), 0.001);
  CHECK(worst_share_by_brute_force(cube, spread_points(round, kManyPoints)) <= 0.001 * kRounded);
  const Polygons ball = shapes::icosphere(1, 2), bumps = shapes::bumpy_sphere(1, 0.1, 1, 3, 2);
  offset_all(ball, options_for(-0.05 * diagonal_of(ball)), 0.001);
  offset_all(ball, options_for(-0.01 * diagonal_of(ball)), 0.001);
  offset_all(bumps, options_for(0.05 * diagonal_of(bumps)), 0.001);
}

TEST_CASE("tolerance: a tenth of it takes no more than ten times the faces", "[tolerance][long]") {
  // A chord of length h sags by h^2 / 8 d, so that pieces are smaller by the root of ten: in two directions where the
  // offset is a part of a ball, in one where it is round an edge, and not at all where it is flat. As edges are halved,
  // pieces are up to two times smaller than they need be, more of them for one tolerance than for the other: 1.3 is for
  // that. Meshes that hardly need a split at the larger tolerance tell nothing.
  const std::vector<std::pair<const char*, Polygons>> kMeshes = {{"ball", shapes::icosphere(1, 1)},
                                                                 {"ring", triangles_of(shapes::torus(1, 0.4, 16, 8))}};
  for (const auto& [name, mesh] : kMeshes) {
    CAPTURE(name);
    const OffsetOptions options = options_for(0.05 * diagonal_of(mesh));
    const auto many = static_cast<double>(offset_all(mesh, options, 0.01).refinement.polygons.face_count());
    const auto more = static_cast<double>(offset_all(mesh, options, 0.001).refinement.polygons.face_count());
    CHECK(many > 10.0 * static_cast<double>(mesh.face_count()));
    CHECK(more > 2 * many);
    CHECK(more < 10 * 1.3 * many);
  }
}

TEST_CASE("tolerance: faces that the source has twice are split like others", "[tolerance][check]") {
  const Polygons ball = shapes::icosphere(1, 1);
  Polygons twice = ball;
  for (std::uint32_t f = 0; f < ball.face_count(); ++f) {
    const auto face = ball.view().face(f);
    twice.add_face({face[2], face[1], face[0]});
  }
  const OffsetOptions options = options_for(0.1);
  const RefinedOffset one = offset_all(ball, options, 0.01), both = offset_all(twice, options, 0.01);
  CHECK(one.refinement.polygons.face_count() > ball.face_count());
  CHECK(both.refinement.polygons.face_count() == 2 * one.refinement.polygons.face_count());
  CHECK(both.result.positions == one.result.positions);
  CHECK(certified_of(both).certified == certified_of(one).certified);
  // No more faces than may be, with both of them counted.
  constexpr std::size_t kMost = 400;
  const RefinedOffset few = offset_to_tolerance(twice.view(), options, tolerance_of(0.01, kMost));
  CHECK(few.refinement.polygons.face_count() <= kMost);
  CHECK(certified_of(few).out_of_faces);
}

TEST_CASE("tolerance: vertices that hang on edges hold nothing back", "[tolerance][hanging][check]") {
  // Triangles of a cylinder, each tenth of which is split at the middle of a side where its neighbour is not.
  const Polygons clean = triangles_of(shapes::cylinder(0.5, 1, 24, 4, 2));
  Polygons mesh;
  mesh.positions = clean.positions;
  for (std::uint32_t f = 0; f < clean.face_count(); ++f) {
    const auto face = clean.view().face(f);
    if (f % 10 != 0) {
      mesh.add_face({face[0], face[1], face[2]});
      continue;
    }
    const auto middle = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back((mesh.positions[face[0]] + mesh.positions[face[1]]) / 2.0);
    mesh.add_face({face[0], middle, face[2]});
    mesh.add_face({middle, face[1], face[2]});
  }
  for (const double distance : {0.05, -0.05})
    for (const Corners corners : {Corners::Round, Corners::Miter}) {
      CAPTURE(distance, static_cast<int>(corners));
      OffsetOptions options = options_for(distance, corners);
      options.weld = WeldOptions::automatic();
      const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.01));
      require_source_kept(mesh, refined);
      CHECK(refined.result.statistics.facts.seams.hanging > 0);
      CHECK(certified_of(refined).certified > 0.9999);
      CheckOptions check;
      check.distance = refined.result.distances;
      check.corners = corners;
      check.weld = options.weld;
      check.tolerance_share = 0.01;
      const CheckResult checked = check_offset(refined.refinement.polygons.view(), refined.result.positions, check);
      CHECK(checked.valid());
      CHECK(checked.certified.value().certified == Approx(certified_of(refined).certified).epsilon(1e-9));
    }
}

TEST_CASE("tolerance: miters need no split, inward or outward", "[tolerance][miter]") {
  for (const int divisions : {1, 3})
    for (const double share : {0.01, 0.05, -0.01, -0.05}) {
      CAPTURE(divisions, share);
      const Polygons mesh = shapes::box(Vec3d(1), divisions, true);
      const OffsetOptions options = options_for(share * std::sqrt(3), Corners::Miter);
      const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.001));
      CHECK(refined.refinement.added.empty());
      CHECK(refined.refinement.polygons.corners == mesh.corners);
      CHECK(refined.result.positions == offset(mesh.view(), options).positions);
      CHECK(certified_of(refined).certified == 1);
      CHECK(certified_of(refined).there == 1);
    }
}

TEST_CASE("tolerance: beside a miter that is cut, faces hold to it", "[tolerance][miter][check]") {
  // A prism whose sharp edge, of ten degrees, has a miter that is 11.5 distances long.
  const double angle = 5 * M_PI / 180;
  Polygons blade;
  for (const double y : {0.0, 1.0})
    for (const double z : {0.0, -1.0, 1.0}) blade.positions.emplace_back(std::abs(z), y, z * std::tan(angle));
  for (const auto& [a, b, c] : {std::tuple(0U, 1U, 2U), std::tuple(3U, 5U, 4U)}) blade.add_face({a, b, c});
  for (std::uint32_t i = 0; i < 3; ++i) blade.add_face({(i + 1) % 3, i, 3 + i, 3 + (i + 1) % 3});
  constexpr double kDistance = 0.02;
  for (const auto& [limit, least] : {std::pair(4.0, 0.97), std::pair(1.2, 0.91)}) {
    CAPTURE(limit);
    OffsetOptions options = options_for(kDistance, Corners::Miter);
    options.miter_limit = limit;
    const RefinedOffset refined = offset_to_tolerance(blade.view(), options, tolerance_of(0.01));
    const PolygonView mesh = refined.refinement.polygons.view();
    double farthest = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      farthest = std::max(farthest, (refined.result.positions[v] - mesh.positions[v]).length());
    CHECK(farthest < limit * kDistance * (1 + 1e-9));
    CHECK(certified_of(refined).certified > least);
    // Whoever looks at the pair sees the same.
    const CheckResult found = check_offset(
        mesh, refined.result.positions,
        {.distance = Distances(kDistance), .corners = Corners::Miter, .miter_limit = limit, .tolerance_share = 0.01});
    CHECK(found.states == refined.result.states);
    CHECK(found.beyond == 0);
    CHECK(found.certified->certified == Approx(certified_of(refined).certified).epsilon(1e-12));
  }
}

TEST_CASE("tolerance: what is added on a border stays in its plane", "[tolerance][symmetry][miter][check][long]") {
  for (const auto& [mesh, size] : {std::pair{test::oblique_tube(), 1.0}, {test::open_loft(64), 30.0}})
    for (const double distance : {0.02, -0.02, 0.08})
      for (const Corners corners : {Corners::Round, Corners::Miter}) {
        CAPTURE(size, distance, corners == Corners::Miter);
        const OffsetOptions options = options_for(distance * size, corners);
        const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.01));
        const auto& source = refined.refinement.polygons.positions;
        std::size_t off = 0, short_of = 0;
        for (std::size_t v = 0; v < source.size(); ++v) {
          off += (source[v][2] == 0 || source[v][2] == size) && refined.result.positions[v][2] != source[v][2];
          short_of += refined.result.states[v] == VertexState::Limited;
        }
        CHECK(off == 0);
        CHECK(short_of == 0);
        CHECK(certified_of(refined).certified > 0.985);
        // Planes are found again, and miters lie in them.
        CheckOptions check;
        check.distance = options.distance;
        check.corners = corners;
        const CheckResult found = check_offset(refined.refinement.polygons.view(), refined.result.positions, check);
        CHECK(found.valid());
        CHECK(found.beyond == 0);
      }
}

TEST_CASE("tolerance: what is added on a face in a named plane stays in it", "[tolerance][symmetry]") {
  const Polygons tube = test::oblique_tube();
  OffsetOptions options = options_for(0.02);
  options.symmetry = {false, {{Vec3d(0, 0, 1), 0}}};
  const RefinedOffset refined = offset_to_tolerance(tube.view(), options, tolerance_of(0.01));
  const auto& source = refined.refinement.polygons.positions;
  std::size_t on_named = 0, off_named = 0, off_other = 0;
  for (std::size_t v = 0; v < source.size(); ++v) {
    on_named += source[v][2] == 0;
    off_named += source[v][2] == 0 && refined.result.positions[v][2] != 0;
    off_other += source[v][2] == 1 && refined.result.positions[v][2] != 1;
  }
  CHECK(on_named > 8);
  CHECK(off_named == 0);
  CHECK(off_other > 8);
}

namespace {

/// A mesh with its vertices moved by random amounts.
Polygons crumpled(Polygons mesh, unsigned seed, double most) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> by(-most, most);
  for (Vec3d& x : mesh.positions) x += Vec3d(by(random), by(random), by(random));
  return mesh;
}

}  // namespace

TEST_CASE("tolerance: check does not take the split edge of a part for one that lies in a plane",
          "[tolerance][miter][parts][check][long]") {
  for (unsigned seed = 1; seed <= 6; ++seed)
    for (const double distance : {0.15, -0.15}) {
      CAPTURE(seed, distance);
      const Polygons mesh = crumpled(shapes::box(Vec3d(2), 2, true), seed, 0.3);
      OffsetOptions options = options_for(distance, Corners::Miter);
      options.border = Border::Free;
      options.only.assign(mesh.face_count(), 0);
      std::fill_n(options.only.begin(), mesh.face_count() / 3, 1);
      const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.02));
      CheckOptions check;
      check.distance = options.distance;
      check.corners = Corners::Miter;
      check.border = options.border;
      check.tolerance_share = 0.02;
      for (const auto face : refined.refinement.parent) check.only.push_back(options.only[face]);
      const CheckResult found = check_offset(refined.refinement.polygons.view(), refined.result.positions, check);
      CHECK(found.valid());
      CHECK(found.beyond == 0);
      CHECK(found.certified->certified == Approx(certified_of(refined).certified).epsilon(1e-12));
    }
}

TEST_CASE("tolerance: check finds the miters of corners with more planes than meet in a point",
          "[tolerance][miter][check][long][no_races]") {
  std::vector<Polygons> meshes;
  for (unsigned seed = 1; seed <= 6; ++seed) meshes.push_back(crumpled(shapes::box(Vec3d(3), 3, true), seed, 0.25));
  // And one without a floor: at a corner of its border, planes do not meet in a point of the border's plane.
  Polygons open;
  open.positions = {{0.117336, 0.128782, 0.000000},  {-0.095351, 0.800181, 0.000000}, {-0.011898, 1.103892, 0.949264},
                    {0.108056, -0.090921, 1.120766}, {1.091930, -0.034397, 0.000000}, {1.072821, 0.877194, 0.000000},
                    {1.122050, 0.906208, 1.121346},  {1.074276, 0.137713, 0.934233}};
  for (const std::array<std::uint32_t, 3>& face : std::initializer_list<std::array<std::uint32_t, 3>>{{3, 2, 1},
                                                                                                      {3, 1, 0},
                                                                                                      {4, 5, 6},
                                                                                                      {4, 6, 7},
                                                                                                      {4, 7, 3},
                                                                                                      {4, 3, 0},
                                                                                                      {1, 2, 6},
                                                                                                      {1, 6, 5},
                                                                                                      {3, 7, 6},
                                                                                                      {3, 6, 2}})
    open.add_face({face[0], face[1], face[2]});
  meshes.push_back(std::move(open));
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    CAPTURE(i);
    const OffsetOptions options = options_for(0.1, Corners::Miter);
    const RefinedOffset refined = offset_to_tolerance(meshes[i].view(), options, tolerance_of(0.02));
    CheckOptions check;
    check.distance = options.distance;
    check.corners = Corners::Miter;
    check.tolerance_share = 0.02;
    const CheckResult found = check_offset(refined.refinement.polygons.view(), refined.result.positions, check);
    CHECK(found.beyond == 0);
    const auto mitered = [](const std::vector<VertexState>& states) {
      return std::count(states.begin(), states.end(), VertexState::Mitered);
    };
    CHECK(mitered(found.states) == mitered(refined.result.states));
    CHECK(found.certified.value().certified == Approx(certified_of(refined).certified).epsilon(1e-9));
  }
}

TEST_CASE("tolerance: a pair in single precision is what it says", "[tolerance][miter][check][long][no_races]") {
  // Rounding tilts the pieces of split faces. If it counted as an error, a tenth of the vertices would be short; if
  // `check` took the pieces for planes of their own, hundreds of mitered corners would be beyond the distance, and with
  // a source that is only rounded when it is written, some faces inverted.
  const Rounding single(Precision::Kind::Single);
  for (unsigned seed = 1; seed <= 6; ++seed)
    for (const Corners corners : {Corners::Round, Corners::Miter})
      for (const bool rounds_all : {false, true}) {
        CAPTURE(seed, corners == Corners::Miter, rounds_all);
        Polygons mesh = crumpled(shapes::box(Vec3d(2), 2, true), seed, seed % 2 == 0 ? 0.15 : 0.3);
        if (!rounds_all)
          for (Vec3d& position : mesh.positions) position = single(position);
        OffsetOptions options = options_for(0.1, corners);
        options.precision = {.kind = Precision::Kind::Single, .rounds_all = true};
        Tolerance tolerance = tolerance_of(0.02);
        tolerance.precision = {.kind = Precision::Kind::Single, .rounds_all = rounds_all};
        const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance);
        CHECK(std::none_of(refined.result.states.begin(), refined.result.states.end(), falls_short));
        CheckOptions check;
        check.distance = options.distance;
        check.corners = corners;
        check.precision = options.precision;
        check.tolerance_share = 0.02;
        const CheckResult found = check_offset(refined.refinement.polygons.view(), refined.result.positions, check);
        CHECK(found.valid());
        CHECK(found.beyond == 0);
        CHECK(found.certified->certified == Approx(certified_of(refined).certified).margin(1e-4));
      }
}

TEST_CASE("tolerance: check takes faces for one plane that rounding has tilted against each other",
          "[tolerance][miter][check][long]") {
  // In single precision, and turned, so that no coordinates of a flat face are alike.
  Polygons mesh = shapes::gear(18, 0.8, 1, 0.3, 0.3, 6);
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (Vec3d& p : mesh.positions) {
    const Vec3d turned(c * p[0] - s * p[1], c * (s * p[0] + c * p[1]) - s * p[2], s * (s * p[0] + c * p[1]) + c * p[2]);
    for (int k = 0; k < 3; ++k) p[k] = static_cast<float>(turned[k]);
  }
  const OffsetOptions options = options_for(0.056, Corners::Miter);
  const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.01));
  CheckOptions check;
  check.distance = refined.result.distances;
  check.corners = Corners::Miter;
  check.tolerance_share = 0.01;
  const CheckResult checked = check_offset(refined.refinement.polygons.view(), refined.result.positions, check);
  const auto get_there = [](const std::vector<VertexState>& states) {
    return std::count_if(states.begin(), states.end(), [](VertexState state) { return !falls_short(state); });
  };
  CHECK(checked.beyond == 0);
  CHECK(get_there(checked.states) == get_there(refined.result.states));
  CHECK(checked.certified.value().certified == Approx(certified_of(refined).certified).epsilon(1e-9));
}

TEST_CASE("tolerance: pieces of needles do not get narrower and narrower", "[tolerance][miter]") {
  const Polygons loft = test::open_loft(64);
  const RefinedOffset refined = offset_to_tolerance(loft.view(), options_for(0.54, Corners::Miter), tolerance_of(0.01));
  const PolygonView pieces = refined.refinement.polygons.view();
  double shortest = 30;
  for (std::size_t f = 0; f < pieces.face_count(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      shortest = std::min(
          shortest, (pieces.positions[pieces.face(f)[k]] - pieces.positions[pieces.face(f)[(k + 1) % 3]]).length());
  CHECK(shortest > 1e-4);  // a twentieth of the tolerance; they came down to 6e-11
}

TEST_CASE("tolerance: added vertices keep to the miter limit where faces are folded", "[tolerance][miter][long]") {
  for (const unsigned seed : {1U, 2U}) {
    CAPTURE(seed);
    constexpr double kDistance = 0.05, kLimit = 4;
    const RefinedOffset refined = offset_to_tolerance(test::crumpled_box(seed).view(),
                                                      options_for(kDistance, Corners::Miter), tolerance_of(0.05));
    double farthest = 0;
    for (std::size_t v = 0; v < refined.result.states.size(); ++v)
      if (refined.result.states[v] == VertexState::Mitered)
        farthest = std::max(
            farthest, (refined.result.positions[v] - refined.refinement.polygons.positions[v]).length() / kDistance);
    CHECK(farthest > 1.5);
    CHECK(farthest < kLimit * (1 + 1e-9));
  }
}

TEST_CASE("tolerance: distances that differ from vertex to vertex", "[tolerance]") {
  const Polygons mesh = shapes::icosphere(1, 2);
  std::vector<double> each;
  for (const Vec3d& p : mesh.positions) each.push_back(0.1 + 0.04 * p[2]);
  const OffsetOptions options = options_for(Distances(each));
  const RefinedOffset refined = offset_all(mesh, options, 0.01);
  CHECK(refined.refinement.added.size() > mesh.positions.size());
  // What is asked of an added vertex is interpolated.
  double worst = 0;
  for (std::size_t i = 0; i < refined.refinement.added.size(); ++i) {
    const VertexOrigin& origin = refined.refinement.added[i];
    double asked = 0;
    for (std::size_t k = 0; k < 3; ++k) asked += each[origin.vertex[k]] * origin.share[k];
    worst = std::max(worst, std::abs(refined.result.distances[mesh.positions.size() + i] - asked));
  }
  CHECK(worst < 1e-15);
}

TEST_CASE("tolerance: distances that differ hold where vertices share positions, or hang", "[tolerance][hanging]") {
  const auto at = [](const Polygons& mesh) {
    std::vector<double> each;
    for (const Vec3d& p : mesh.positions) each.push_back(0.1 + 0.03 * p[2]);
    return Distances(std::move(each));
  };
  const Polygons ball = shapes::icosphere(1, 1), torn = test::torn(ball);
  const RefinedOffset whole = offset_to_tolerance(ball.view(), options_for(at(ball)), tolerance_of(0.01)),
                      in_pieces = offset_to_tolerance(torn.view(), options_for(at(torn)), tolerance_of(0.01));
  CHECK(certified_of(whole).certified > 0.9999);
  CHECK(certified_of(in_pieces).certified == Approx(certified_of(whole).certified).epsilon(1e-9));
  CHECK(in_pieces.refinement.polygons.face_count() == whole.refinement.polygons.face_count());
  CHECK(in_pieces.result.statistics.disagreeing_distances == 0);
  Polygons hanging = shapes::box(Vec3d(1), 1, true);
  const auto first = hanging.view().face(0);
  const std::array<std::uint32_t, 3> split{first[0], first[1], first[2]};
  const auto middle = static_cast<std::uint32_t>(hanging.positions.size());
  hanging.positions.push_back((hanging.positions[split[0]] + hanging.positions[split[1]]) / 2.0);
  hanging.corners[1] = middle;  // the first face is the half at its first corner, and the other half is added
  hanging.add_face({middle, split[1], split[2]});
  OffsetOptions options = options_for(at(hanging));
  options.weld = WeldOptions::automatic();
  const RefinedOffset joined = offset_to_tolerance(hanging.view(), options, tolerance_of(0.01));
  CHECK(joined.result.statistics.facts.seams.hanging == 1);
  CHECK(joined.result.statistics.disagreeing_distances == 0);
  CHECK(certified_of(joined).certified > 0.9999);
}

TEST_CASE("tolerance: a part of a mesh is split, and little of what stays", "[tolerance]") {
  const Polygons mesh = shapes::icosphere(1, 2);
  OffsetOptions options = options_for(0.1);
  Polygons part;
  part.positions = mesh.positions;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    options.only.push_back(mesh.positions[face[0]][2] + mesh.positions[face[1]][2] + mesh.positions[face[2]][2] > 0);
    if (options.only.back()) part.add_face({face[0], face[1], face[2]});
  }
  for (const Border border : {Border::Free, Border::Slide, Border::Fixed}) {
    CAPTURE(static_cast<int>(border));
    options.border = border;
    const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.01));
    require_source_kept(mesh, refined);
    require_result_valid(refined, options);
    const CertifiedFaces& certified = certified_of(refined);
    CHECK((certified.certified > 0.65 && certified.certified <= certified.there));
    if (border == Border::Free) CHECK((certified.there == 1 && certified.certified == Approx(1).epsilon(1e-12)));
    CHECK(largest_split_off(mesh, part, options.only, refined.refinement) == 1);
    // Of the area that is there, no more is off than is not certified. Where the edge slides, faces beside it have
    // another share of the area in the offset than in the source.
    if (border == Border::Slide) continue;
    const std::vector<double> errors = errors_of(part, spread_points(refined, kManyPoints, options.only));
    const double off = static_cast<double>(std::count_if(errors.begin(), errors.end(),
                                                         [](double error) { return error > 0.01 * kRounded; })) /
                       kManyPoints;
    const double open = 1 - certified.certified / certified.there;
    CHECK(off <= open + 5 * std::sqrt(open / kManyPoints));
  }
}

TEST_CASE("tolerance: no more faces are made than may be", "[tolerance]") {
  const Polygons mesh = shapes::icosphere(1, 1);
  const OffsetOptions options = options_for(0.1);
  const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.01, 1000));
  require_source_kept(mesh, refined);
  require_result_valid(refined, options);
  CHECK(refined.refinement.polygons.face_count() <= 1000);
  CHECK(refined.refinement.polygons.face_count() > 500);
  const CertifiedFaces& certified = certified_of(refined);
  CHECK(certified.out_of_faces);
  CHECK(certified.there == 1);
  CHECK(certified.certified < 1);
  CHECK(certified.worst_left > 0.01);
}

TEST_CASE("tolerance: where a round is done again, as many faces are made as may be", "[tolerance][no_races]") {
  const Polygons mesh = shapes::gear(18, 0.8, 1, 0.3, 0.3, 6);
  constexpr std::size_t kMost = 10000;
  const RefinedOffset refined = offset_to_tolerance(mesh.view(), options_for(0.0284), tolerance_of(0.01, kMost));
  CHECK(certified_of(refined).out_of_faces);
  CHECK(refined.refinement.polygons.face_count() <= kMost);
  CHECK(refined.refinement.polygons.face_count() > 0.8 * kMost);
}

TEST_CASE("tolerance: as many faces as come of it are enough, of large polygons as well", "[tolerance][no_races]") {
  const Polygons mesh = cone(24);
  const OffsetOptions options = options_for(0.1);
  const RefinedOffset full = offset_to_tolerance(mesh.view(), options, tolerance_of(0.02));
  CHECK(!certified_of(full).out_of_faces);
  CHECK(certified_of(full).certified > 0.9999);
  const std::size_t needed = full.refinement.polygons.face_count();
  CHECK(needed > 1000);
  const RefinedOffset just_enough = offset_to_tolerance(mesh.view(), options, tolerance_of(0.02, needed));
  CHECK(!certified_of(just_enough).out_of_faces);
  CHECK(just_enough.refinement.polygons.corners == full.refinement.polygons.corners);
  const RefinedOffset too_few = offset_to_tolerance(mesh.view(), options, tolerance_of(0.02, needed / 2));
  CHECK(certified_of(too_few).out_of_faces);
  CHECK(certified_of(too_few).worst_left > 0.02);
  CHECK(too_few.refinement.polygons.face_count() <= needed / 2);
  CHECK(too_few.refinement.polygons.face_count() > needed / 4);
}

TEST_CASE("tolerance: what is added stays on its own side of where fronts meet", "[tolerance][no_races]") {
  // Behind a corner of the hole the middle of the edge is nearer to the outside than to that corner. Beside the ends of
  // these edges, where the source's vertices go, a strip is left; it is 36 % of the area if nothing is split.
  for (const double wall : {0.45, 0.6, 1.0}) {
    const Polygons mesh = frame(wall);
    for (const double share : {0.3, 0.44, 0.49}) {
      CAPTURE(wall, share);
      const OffsetOptions options = options_for(-share * wall);
      const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.01));
      require_source_kept(mesh, refined);
      require_result_valid(refined, options);
      CHECK(certified_of(refined).there == 1);
      CHECK(certified_of(refined).certified > 0.98);
      const std::vector<double> errors = errors_of(mesh, spread_points(refined, kManyPoints));
      CHECK(std::count_if(errors.begin(), errors.end(), [](double e) { return e > 0.01; }) < 0.02 * kManyPoints);
    }
  }
}

TEST_CASE("tolerance: where the source crosses itself, pieces of no more faces meet than without",
          "[tolerance][no_races]") {
  // Two coarse balls through each other, and a third one that is near.
  const Polygons ball = shapes::icosphere(1, 1);
  Polygons mesh;
  for (const Vec3d& at : {Vec3d(0, 0, 0), Vec3d(1.1, 0.3, 0.2), Vec3d(0.4, 2.15, 0)}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3d& p : ball.positions) mesh.positions.push_back(p + at);
    for (std::size_t f = 0; f < ball.face_count(); ++f) {
      for (const auto v : ball.view().face(f)) mesh.corners.push_back(first + v);
      mesh.close_face();
    }
  }
  std::vector<std::uint32_t> own(mesh.face_count());
  for (std::uint32_t f = 0; f < own.size(); ++f) own[f] = f;
  for (const double distance : {0.05, -0.05}) {
    CAPTURE(distance);
    const OffsetOptions options = options_for(distance);
    const OffsetResult coarse = offset(mesh.view(), options);
    const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.01));
    CHECK(certified_of(refined).source_crossings == coarse.statistics.limit.source_crossings);
    CHECK(certified_of(refined).certified > 0.5);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> before = faces_that_meet(mesh, mesh.positions, own);
    REQUIRE(!before.empty());
    for (const auto& pair : faces_that_meet(mesh, coarse.positions, own)) before.push_back(pair);
    std::sort(before.begin(), before.end());
    std::size_t more = 0;
    for (const auto& pair :
         faces_that_meet(refined.refinement.polygons, refined.result.positions, refined.refinement.parent))
      more += !std::binary_search(before.begin(), before.end(), pair);
    CHECK(more == 0);
  }
}

TEST_CASE("tolerance: what crosses by rounding alone is the refined source's, and not the source's", "[tolerance]") {
  // Two cubes, tilted, with a gap of one unit of the last digit or two.
  const Polygons cube = triangles_of(shapes::box(Vec3d(1), 1, false));
  const Rounding single(Precision{.kind = Precision::Kind::Single});
  Polygons mesh;
  for (const double z : {0.0, 1 + 3e-7}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3d& at : cube.positions) {
      const Vec3d p = at + Vec3d(0.5);
      const double x = p[0] * std::cos(0.2) - p[1] * std::sin(0.2), y = p[0] * std::sin(0.2) + p[1] * std::cos(0.2),
                   up = p[2] + z;
      mesh.positions.push_back(
          single(Vec3d(x + 3, y * std::cos(0.7) - up * std::sin(0.7) + 3, y * std::sin(0.7) + up * std::cos(0.7) + 3)));
    }
    for (std::size_t f = 0; f < cube.face_count(); ++f) {
      for (const auto v : cube.view().face(f)) mesh.corners.push_back(first + v);
      mesh.close_face();
    }
  }
  Tolerance tolerance = tolerance_of(0.05);
  tolerance.precision.kind = Precision::Kind::Single;
  OffsetOptions options = options_for(0.1);
  options.precision = tolerance.precision;
  const auto crossings_of = [](const Polygons& polygons) {
    const Surface surface = build_surface(polygons.view(), {});
    return CrossingFinder(surface, surface.vertices).all().size();
  };
  REQUIRE(crossings_of(mesh) == 0);
  const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance);
  CHECK(certified_of(refined).source_crossings == 0);
  CHECK(refined.result.statistics.limit.source_crossings > 0);
  CHECK(refined.result.statistics.limit.source_crossings == crossings_of(refined.refinement.polygons));
}

TEST_CASE("tolerance: the same bits for any number of threads", "[tolerance]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.2, 1, 3, 2);
  OffsetOptions options = options_for(0.15);
  options.threads = 1;
  const RefinedOffset one = offset_to_tolerance(mesh.view(), options, tolerance_of(0.01));
  CHECK(one.refinement.added.size() > 1000);
  for (const int threads : {2, 5}) {
    CAPTURE(threads);
    options.threads = threads;
    const RefinedOffset other = offset_to_tolerance(mesh.view(), options, tolerance_of(0.01));
    CHECK(other.refinement.polygons.positions == one.refinement.polygons.positions);
    CHECK(other.refinement.polygons.corners == one.refinement.polygons.corners);
    CHECK(other.refinement.parent == one.refinement.parent);
    CHECK(other.result.positions == one.result.positions);
    CHECK(other.result.states == one.result.states);
    CHECK(certified_of(other).certified == certified_of(one).certified);
    CHECK(certified_of(other).there == certified_of(one).there);
    CHECK(certified_of(other).worst_left == certified_of(one).worst_left);
  }
}

TEST_CASE("tolerance: a share of the distance and the length that it is are the same", "[tolerance][no_races]") {
  const Polygons mesh = shapes::icosphere(1, 1);
  Tolerance length;
  length.length = 0.01 * 0.1;
  const RefinedOffset by_share = offset_to_tolerance(mesh.view(), options_for(0.1), tolerance_of(0.01)),
                      by_length = offset_to_tolerance(mesh.view(), options_for(0.1), length);
  CHECK(!by_share.refinement.added.empty());
  CHECK(by_length.refinement.polygons.corners == by_share.refinement.polygons.corners);
  CHECK(by_length.result.positions == by_share.result.positions);
  CHECK(certified_of(by_length).length == length.length);
  CHECK(certified_of(by_length).share == 0);
  CHECK(length.at(-0.1) == tolerance_of(0.01).at(0.1));
}

TEST_CASE("tolerance: at no distance a mesh stays as it is", "[tolerance]") {
  const Polygons mesh = shapes::box(Vec3d(1), 2, false);
  const RefinedOffset refined = offset_to_tolerance(mesh.view(), options_for(0), tolerance_of(0.01));
  CHECK(refined.refinement.polygons.corners == mesh.corners);
  CHECK(refined.refinement.added.empty());
  CHECK(refined.result.positions == mesh.positions);
}

TEST_CASE("tolerance: options that cannot be used are refused", "[tolerance]") {
  const Polygons mesh = shapes::box(Vec3d(1), 1, true);
  const auto refuses = [&](const std::function<void(OffsetOptions&, Tolerance&)>& change) {
    OffsetOptions options = options_for(0.1);
    Tolerance tolerance = tolerance_of(0.01);
    change(options, tolerance);
    CHECK_THROWS_AS(offset_to_tolerance(mesh.view(), options, tolerance), InvalidInput);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();
  refuses([](auto&, Tolerance& tolerance) { tolerance.share = 0; });
  refuses([](auto&, Tolerance& tolerance) { tolerance.length = 0.01; });
  for (const double share : {-0.01, 0.9e-5, 1.0, kNan, kInfinite})
    refuses([&](auto&, Tolerance& tolerance) { tolerance.share = share; });
  for (const double length : {-0.01, 0.9e-6, kNan, kInfinite})
    refuses([&](auto&, Tolerance& tolerance) {
      tolerance.share = 0;
      tolerance.length = length;
    });
  refuses([](OffsetOptions& options, auto&) { options.metric.scale = Vec3d(1, 1, 2); });
  refuses([](OffsetOptions& options, auto&) { options.off_source = true; });
  refuses([](OffsetOptions& options, auto&) { options.inner_skin_last = true; });
  refuses([](OffsetOptions& options, auto&) { options.keep_field = true; });
  refuses([](OffsetOptions& options, auto&) { options.keep_paths = true; });
  refuses([](OffsetOptions& options, auto&) { options.distance = Distances(std::vector<double>(7, 0.1)); });
  OffsetOptions usable = options_for(0.1);
  CHECK_NOTHROW(offset_to_tolerance(mesh.view(), usable, tolerance_of(0.5)));
}

TEST_CASE("tolerance: no faces are wasted on what cannot be there", "[tolerance]") {
  // The gap is half of what both would need: nothing of the sides that face each other has room, all else has.
  const Polygons near = triangles_of(shapes::plates(1, 0.2, 0.06, 4)), far = triangles_of(shapes::plates(1, 0.2, 6, 4));
  const double live = (1 + 4 * 0.2) / (2 + 4 * 0.2);
  const OffsetOptions options = options_for(0.06);
  const RefinedOffset refined = offset_to_tolerance(near.view(), options, tolerance_of(0.01));
  require_source_kept(near, refined);
  require_result_valid(refined, options);
  const CertifiedFaces& certified = certified_of(refined);
  CHECK(certified.certified <= live);
  CHECK(certified.certified > 0.99 * live);
  const RefinedOffset apart = offset_all(far, options, 0.01);
  CHECK(refined.refinement.polygons.face_count() < apart.refinement.polygons.face_count());
}

TEST_CASE("tolerance: what has gone to its distance on the inside stays there", "[tolerance][long]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.1, 1, 3, 2);
  for (const double share : {-0.05, -0.01}) {
    CAPTURE(share);
    const OffsetOptions options = options_for(share * diagonal_of(mesh));
    const OffsetResult coarse = offset(mesh.view(), options);
    const RefinedOffset refined = offset_to_tolerance(mesh.view(), options, tolerance_of(0.001));
    std::size_t lost = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      lost += falls_short(refined.result.states[v]) && !falls_short(coarse.states[v]);
    CHECK(lost == 0);
  }
}

TEST_CASE("tolerance: near creases on the inside hardly anything is left", "[tolerance][no_races]") {
  const Polygons ball = shapes::icosphere(1, 1), ring = triangles_of(shapes::torus(1, 0.4, 16, 8));
  for (const Polygons* mesh : {&ball, &ring}) {
    const OffsetOptions options = options_for(-0.01 * diagonal_of(*mesh));
    const RefinedOffset refined = offset_to_tolerance(mesh->view(), options, tolerance_of(0.01));
    require_source_kept(*mesh, refined);
    require_result_valid(refined, options);
    CHECK(certified_of(refined).there == 1);
    CHECK(certified_of(refined).certified > 0.9995);
  }
}

TEST_CASE("tolerance: halves that are folded are split in turn", "[tolerance][long][no_races]") {
  // Sharp valleys between few faces. With triangles that stay whole where their halves are folded: 82.1 %.
  const Polygons mesh = shapes::bumpy_sphere(1, 0.6, 4, 1, 3);
  const RefinedOffset refined =
      offset_to_tolerance(mesh.view(), options_for(0.05 * diagonal_of(mesh)), tolerance_of(0.01));
  CHECK(certified_of(refined).there == Approx(1).epsilon(1e-3));
  CHECK(certified_of(refined).certified > 0.83);
  CHECK(refined.result.statistics.limit.left.total() == 0);
}

TEST_CASE("tolerance: a flat face on the inside needs no split", "[tolerance]") {
  const Polygons mesh = shapes::box(Vec3d(1), 3, false);
  const RefinedOffset refined =
      offset_to_tolerance(mesh.view(), options_for(-0.01 * std::sqrt(3)), tolerance_of(0.001));
  CHECK(refined.refinement.added.empty());
}
