// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/iso_surface.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "ground/numbers/rounding.h"
#include "products/iso/iso_grid.h"
#include "products/iso/mend.h"
#include "products/iso/source_lookup.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles all_triangles(const Polygons& mesh) {
  Triangles triangles;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    REQUIRE(face.size() == 3);
    triangles.push_back({face[0], face[1], face[2]});
  }
  return triangles;
}

IsoResult captured(const Polygons& mesh, double distance, double voxel_size, double adaptivity = 0) {
  IsoOptions options;
  options.distance = distance;
  options.grid.voxel_size = voxel_size;
  options.adaptivity = adaptivity;
  return make_iso_surface(mesh.view(), options);
}

/// Edges that do not have two faces, one each way, and vertices whose faces are not one ring: by maps, which share
/// nothing with the library.
std::size_t unsound(const Polygons& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> next;  // around a vertex
  std::size_t wrong = 0;
  for (const auto& t : all_triangles(mesh))
    for (std::size_t k = 0; k < 3; ++k) {
      wrong += ++edges[{t[k], t[(k + 1) % 3]}] > 1;
      next[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
    }
  for (const auto& [edge, count] : edges) wrong += edges.count({edge.second, edge.first}) == 0;
  if (wrong > 0) return wrong;
  for (const auto& [vertex, ring] : next) {
    std::size_t steps = 0;
    std::uint32_t at = ring.begin()->first;
    do at = ring.at(at);
    while (++steps <= ring.size() && at != ring.begin()->first);
    wrong += steps != ring.size();
  }
  const std::set<std::pair<double, std::pair<double, double>>> distinct = [&] {
    std::set<std::pair<double, std::pair<double, double>>> all;
    for (const Vec3d& p : mesh.positions) all.insert({p[0], {p[1], p[2]}});
    return all;
  }();
  return wrong + (mesh.positions.size() - distinct.size());
}

double six_volumes(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Whether a segment passes through a triangle, by the signs of volumes.
bool passes(const Vec3d& p, const Vec3d& q, const std::array<Vec3d, 3>& t) {
  const double above = six_volumes(t[0], t[1], t[2], p), below = six_volumes(t[0], t[1], t[2], q);
  if (!(above * below < 0)) return false;
  const double u = six_volumes(p, q, t[0], t[1]), v = six_volumes(p, q, t[1], t[2]), w = six_volumes(p, q, t[2], t[0]);
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

/// Pairs of triangles of which an edge of one, away from what they share, passes through the other: tries all that
/// could.
std::size_t brute_force_crossings(const Polygons& mesh) {
  const Triangles triangles = all_triangles(mesh);
  const auto corners_of = [&](const std::array<std::uint32_t, 3>& t) {
    return std::array<Vec3d, 3>{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  };
  const auto is_apart = [&](const std::array<Vec3d, 3>& a, const std::array<Vec3d, 3>& b) {
    for (int k = 0; k < 3; ++k)
      if (std::max({a[0][k], a[1][k], a[2][k]}) < std::min({b[0][k], b[1][k], b[2][k]}) ||
          std::max({b[0][k], b[1][k], b[2][k]}) < std::min({a[0][k], a[1][k], a[2][k]}))
        return true;
    return false;
  };
  const auto cuts = [&](const std::array<std::uint32_t, 3>& s, const std::array<std::uint32_t, 3>& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = s[k], b = s[(k + 1) % 3];
      if (std::count(t.begin(), t.end(), a) + std::count(t.begin(), t.end(), b) > 0) continue;
      if (passes(mesh.positions[a], mesh.positions[b], corners_of(t))) return true;
    }
    return false;
  };
  // In the order of their least x, whatever starts behind a triangle's end is apart.
  std::vector<std::pair<double, double>> extent;
  for (const auto& t : triangles) {
    const auto [a, b, c] = corners_of(t);
    extent.emplace_back(std::min({a[0], b[0], c[0]}), std::max({a[0], b[0], c[0]}));
  }
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return extent[i] < extent[j]; });
  std::size_t found = 0;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && extent[order[j]].first <= extent[order[i]].second; ++j) {
      const auto &s = triangles[order[i]], &t = triangles[order[j]];
      if (!is_apart(corners_of(s), corners_of(t))) found += cuts(s, t) || cuts(t, s);
    }
  return found;
}

/// Largest | |distance| - target | / target of a vertex, and how many are on the wrong side.
void check_distances(const Polygons& source, const IsoResult& result, double distance, std::size_t stride = 1) {
  double worst = 0;
  std::size_t wrong_side = 0;
  for (std::size_t v = 0; v < result.polygons.positions.size(); v += stride) {
    const Vec3d& x = result.polygons.positions[v];
    const double found = test::brute_force_distance(source.view(), x);
    worst = std::max(worst, std::abs(found / std::abs(distance) - 1));
    if (result.statistics.is_signed) wrong_side += test::is_inside(source.view(), x) != (distance < 0);
  }
  CHECK(worst < 1e-6);
  CHECK(wrong_side == 0);
}

void check_sound(const IsoResult& result) {
  CHECK(unsound(result.polygons) == 0);
  CHECK(brute_force_crossings(result.polygons) == 0);
  CHECK(result.statistics.valid());
  CHECK(result.statistics.vertices == result.polygons.positions.size());
  CHECK(result.statistics.triangles == result.polygons.face_count());
}

double volume(const Polygons& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : all_triangles(mesh))
    sum += mesh.positions[a].dot(mesh.positions[b].cross(mesh.positions[c])) / 6;
  return sum;
}

std::ptrdiff_t euler(const IsoResult& result) {
  const auto faces = static_cast<std::ptrdiff_t>(result.polygons.face_count());
  return static_cast<std::ptrdiff_t>(result.polygons.positions.size()) - faces / 2;
}

/// Signed distance to a box around the origin.
double box_distance(const Vec3d& half, const Vec3d& x) {
  Vec3d beyond(0.0);
  double most = -1e300;
  for (int k = 0; k < 3; ++k) {
    beyond[k] = std::max(0.0, std::abs(x[k]) - half[k]);
    most = std::max(most, std::abs(x[k]) - half[k]);
  }
  return most > 0 ? beyond.length() : most;
}

void add(Polygons& to, const Polygons& mesh, const Vec3d& by) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  for (const Vec3d& p : mesh.positions) to.positions.push_back(p + by);
  for (const auto v : mesh.corners) to.corners.push_back(first + v);
  for (std::size_t f = 1; f < mesh.face_begin.size(); ++f)
    to.face_begin.push_back(static_cast<std::uint32_t>(to.corners.size() - mesh.corners.size()) + mesh.face_begin[f]);
}

}  // namespace

TEST_CASE("capture: the judges of soundness reject what is not", "[capture]") {
  Polygons sphere = shapes::icosphere(1, 2);
  CHECK(unsound(sphere) == 0);
  CHECK(brute_force_crossings(sphere) == 0);
  Polygons pierced = sphere;
  pierced.positions[0] *= -1.5;
  CHECK(brute_force_crossings(pierced) > 0);
  Polygons open = sphere;
  open.corners.resize(open.corners.size() - 3);
  open.face_begin.pop_back();
  CHECK(unsound(open) > 0);
  Polygons pinched = sphere;
  add(pinched, sphere, {2.5, 0, 0});
  for (auto& v : pinched.corners)
    if (v == sphere.positions.size()) v = 0;
  CHECK(unsound(pinched) > 0);
}

TEST_CASE("capture: around a box every vertex is at the closed form's distance", "[capture][no_races]") {
  const Polygons box = shapes::box({1, 0.7, 0.5}, 3, false);
  const double d = GENERATE(0.1, -0.1);
  const IsoResult result = captured(box, d, 0.03);
  check_sound(result);
  double worst = 0, worst_normal = 0;
  for (std::size_t v = 0; v < result.polygons.positions.size(); ++v) {
    const Vec3d& x = result.polygons.positions[v];
    worst = std::max(worst, std::abs(box_distance({0.5, 0.35, 0.25}, x) - d));
    // Central differences; at the medial axis, which the inner box's edges lie on, phi has no gradient.
    const double step = 1e-6;
    Vec3d gradient;
    for (int k = 0; k < 3; ++k) {
      Vec3d to(0.0);
      to[k] = step;
      gradient[k] = (box_distance({0.5, 0.35, 0.25}, x + to) - box_distance({0.5, 0.35, 0.25}, x - to)) / (2 * step);
    }
    if (std::abs(gradient.length() - 1) < 1e-6)
      worst_normal = std::max(worst_normal, (gradient - result.normals[v]).length());
  }
  CHECK(worst < 1e-9);
  CHECK(worst_normal < 1e-4);
  CHECK(result.statistics.worst_error < 1e-8);
  CHECK(euler(result) == 2);
  // Steiner's formula, or the smaller box; chords of voxels cut off their sagittas.
  const double exact =
      d > 0 ? 0.35 + 2 * d * (0.7 + 0.5 + 0.35) + M_PI * d * d * 2.2 + 4.0 / 3 * M_PI * d * d * d : 0.8 * 0.5 * 0.3;
  CHECK(volume(result.polygons) == Approx(exact).epsilon(0.02));
}

TEST_CASE("capture: creases are sharp, and vertices stand on them", "[capture][no_races]") {
  // Inward of a box they are its edges and corners, so that all of the smaller box is exact, between vertices, too.
  const IsoResult inner = captured(shapes::box({1, 0.7, 0.52}, 3, true), -0.1, 0.03);
  check_sound(inner);
  CHECK(volume(inner.polygons) == Approx(0.8 * 0.5 * 0.32).epsilon(1e-7));
  CHECK(inner.statistics.faces.worst < 1e-7);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d at(corner & 1 ? 0.4 : -0.4, corner & 2 ? 0.25 : -0.25, corner & 4 ? 0.16 : -0.16);
    double least = 1;
    for (const Vec3d& p : inner.polygons.positions) least = std::min(least, (p - at).length());
    CHECK(least < 1e-8);
  }
  // Outward, where spheres around two balls meet: in a plane between them.
  Polygons balls = shapes::icosphere(1, 4);
  add(balls, shapes::icosphere(1, 4), {2.2, 0, 0});
  const IsoResult outer = captured(balls, 0.4, 0.1);
  check_sound(outer);
  const double exact = std::sqrt(1.4 * 1.4 - 1.1 * 1.1);
  double least = 10, most = 0;  // distance from the axis, of vertices in the plane
  std::size_t count = 0;
  for (const Vec3d& p : outer.polygons.positions) {
    if (std::abs(p[0] - 1.1) > 1e-6) continue;
    const double radius = std::hypot(p[1], p[2]);
    least = std::min(least, radius);
    most = std::max(most, radius);
    ++count;
  }
  CHECK(count > 30);  // a voxel has a tenth, and the circle is 5.4 long: 36 to 60, as voxels happen to lie
  CHECK(least > exact - 0.01);
  CHECK(most < exact + 0.01);
}

TEST_CASE("capture: spheres and tori keep their shape", "[capture][no_races]") {
  const Polygons sphere = shapes::icosphere(1, 3);
  const IsoResult ball = captured(sphere, 0.3, 0.12);
  check_sound(ball);
  check_distances(sphere, ball, 0.3);
  CHECK(euler(ball) == 2);
  CHECK(volume(ball.polygons) == Approx(4.0 / 3 * M_PI * 1.3 * 1.3 * 1.3).epsilon(0.02));

  const Polygons torus = shapes::torus(1, 0.4, 48, 24);
  const IsoResult ring = captured(torus, -0.15, 0.08);
  check_sound(ring);
  check_distances(torus, ring, -0.15);
  CHECK(euler(ring) == 0);
  CHECK(volume(ring.polygons) == Approx(2 * M_PI * M_PI * 0.25 * 0.25).epsilon(0.05));
}

TEST_CASE("capture: what is merged where it is flat is still closed and at the distance", "[capture]") {
  const Polygons box = shapes::box({1, 0.7, 0.5}, 3, true);
  const double adaptivity = GENERATE(0.1, 1.0);
  const IsoResult all = captured(box, 0.1, 0.03), merged = captured(box, 0.1, 0.03, adaptivity);
  CHECK(merged.polygons.face_count() < all.polygons.face_count() / 2);
  check_sound(merged);
  check_distances(box, merged, 0.1);
}

TEST_CASE("capture: the result does not depend on the number of threads", "[capture]") {
  const Polygons gear = shapes::gear(8, 0.7, 1, 0.3, 0.4, 3);
  IsoOptions options;
  options.distance = 0.03;
  options.grid.voxel_size = 0.04;
  options.adaptivity = GENERATE(std::optional<double>(), std::optional(0.0), std::optional(0.2));
  options.threads = 1;
  const IsoResult alone = make_iso_surface(gear.view(), options);
  options.threads = 2;
  const IsoResult together = make_iso_surface(gear.view(), options);
  CHECK(alone.polygons.positions == together.polygons.positions);
  CHECK(alone.polygons.corners == together.polygons.corners);
  CHECK(alone.normals == together.normals);
  CHECK(alone.closest == together.closest);
  CHECK((alone.statistics.merged_vertices > 0) == !options.adaptivity);
  check_sound(alone);
}

TEST_CASE("capture: a sheet gets a tube around it", "[capture][no_races]") {
  const Polygons sheet = shapes::patch(1, 0, 4);
  const IsoResult tube = captured(sheet, 0.1, 0.04);
  check_sound(tube);
  check_distances(sheet, tube, 0.1);
  CHECK(!tube.statistics.is_signed);
  CHECK(euler(tube) == 2);
  CHECK(volume(tube.polygons) == Approx(0.2 + 2 * M_PI * 0.01 + 4.0 / 3 * M_PI * 0.001).epsilon(0.02));
  CHECK(captured(sheet, -0.1, 0.04).polygons.positions == tube.polygons.positions);
}

TEST_CASE("capture: solids that overlap or lie in each other are one, cavities are none", "[capture][no_races]") {
  const Polygons box = shapes::box({1, 1, 1}, 2, true);
  Polygons overlapping = box;
  add(overlapping, box, {0.6, 0.3, 0.2});
  const IsoResult both = captured(overlapping, 0.1, 0.05);
  check_sound(both);
  CHECK(both.statistics.components == 1);
  check_distances(overlapping, both, 0.1, 7);

  Polygons nested = box;
  add(nested, shapes::box({0.3, 0.3, 0.3}, 1, true), {0, 0, 0});
  const IsoResult outer = captured(nested, 0.1, 0.05);
  CHECK(outer.statistics.components == 1);
  CHECK(volume(outer.polygons) == Approx(volume(captured(box, 0.1, 0.05).polygons)).epsilon(1e-3));

  const Polygons hollow = shapes::hollow_box(1, 0.3, 4);
  const IsoResult shell = captured(hollow, 0.05, 0.03);
  check_sound(shell);
  CHECK(shell.statistics.components == 2);
  check_distances(hollow, shell, 0.05, 5);
}

TEST_CASE("capture: where the faces point is outward, also of a solid that is inside out", "[capture]") {
  Polygons sphere = shapes::icosphere(1, 3);
  std::reverse(sphere.corners.begin(), sphere.corners.end());
  const IsoResult inner = captured(sphere, 0.2, 0.12);
  for (const Vec3d& p : inner.polygons.positions) CHECK(p.length() < 0.81);
  CHECK(volume(inner.polygons) < 0);
  for (std::size_t v = 0; v < inner.normals.size(); ++v)
    CHECK(inner.normals[v].dot(inner.polygons.positions[v]) < -0.7);
  IsoOptions options;
  options.distance = 0.2;
  options.grid.voxel_size = 0.12;
  options.orient = Orient::FixDirectionOnly;
  CHECK(volume(make_iso_surface(sphere.view(), options).polygons) ==
        Approx(4.0 / 3 * M_PI * 1.2 * 1.2 * 1.2).epsilon(0.02));
}

TEST_CASE("capture: validity is that of coordinates as written", "[capture]") {
  IsoOptions options;
  options.distance = 0.1;
  options.grid.voxel_size = 0.05;
  options.precision = {Precision::Kind::Digits, 3};
  const Polygons box = shapes::box({1, 0.7, 0.5}, 3, true);
  const IsoResult result = make_iso_surface(box.view(), options);
  for (const Vec3d& p : result.polygons.positions) CHECK(Rounding(options.precision)(p) == p);
  check_sound(result);
  CHECK(result.statistics.worst_error > 1e-6);
  CHECK(result.statistics.worst_error < 0.01);  // half a unit of the third digit, and its share of the distance
}

TEST_CASE("capture: what cannot be is refused", "[capture]") {
  const Polygons box = shapes::box({1, 1, 1}, 2, true);
  CHECK_THROWS_WITH(captured(box, -0.6, 0.05), Catch::StartsWith("iso-surface: expected a surface at distance -0.6"));
  CHECK_THROWS_AS(captured(box, 0, 0.05), InvalidInput);
  CHECK_THROWS_AS(captured(box, 0.1, -1), InvalidInput);
  CHECK_THROWS_AS(captured(box, 0.1, 0.05, 1.5), InvalidInput);
  IsoOptions options;
  options.distance = 0.1;
  options.max_memory = std::size_t{1} << 28;
  CHECK(plan_iso_surface(box.view(), options).plan.bytes <= options.max_memory);
  options.grid.voxel_size = 1e-4;
  CHECK_THROWS_AS(make_iso_surface(box.view(), options), OutOfBudget);
  CHECK_THROWS_AS(plan_iso_surface(box.view(), options), OutOfBudget);
  options.grid.voxel_size = 0.05;
  options.progress = [](Stage stage, double) { return stage != Stage::Capture; };
  CHECK_THROWS_AS(make_iso_surface(box.view(), options), Cancelled);
  options.progress = {};
  options.reserve = [&](std::size_t bytes) { return bytes != plan_iso_surface(box.view(), options).plan.bytes; };
  CHECK_THROWS_AS(make_iso_surface(box.view(), options), Cancelled);
}

TEST_CASE("capture: a voxel coarser than the distance tells the two sides apart", "[capture][no_races]") {
  const Polygons sphere = shapes::icosphere(1, 3);
  const double d = GENERATE(0.02, -0.02);
  const IsoResult result = captured(sphere, d, 0.1);
  check_sound(result);
  check_distances(sphere, result, d);
}

TEST_CASE("iso grid: phi is exact where an edge may cross, and has the right sign everywhere", "[capture]") {
  Surface surface = build_surface(shapes::box({1, 0.7, 0.5}, 2, true).view(), {});
  constexpr double kVoxel = 0.05;
  const double level = GENERATE(0.12, -0.12);
  to_local_frame(surface, kVoxel);
  const ClosestQuery query(surface);
  const Inside inside(surface);
  const Lattice lattice{kVoxel, GENERATE(Vec3d(0.0), Vec3d(-0.02, -0.01, -0.03))};
  const IsoGrid grid = rasterise_iso(query, inside, level, lattice, 1000);
  double worst = 0;
  std::size_t near_count = 0, wrong_signs = 0;
  for (int i = -8; i <= 32; ++i)
    for (int j = -8; j <= 26; ++j)
      for (int k = -8; k <= 22; ++k) {
        const Vec3d x = lattice.position(Vec3d(i, j, k)) + surface.origin;
        const double exact = box_distance({0.5, 0.35, 0.25}, x) - level, found = grid.phi->tree().getValue({i, j, k});
        if (std::abs(exact) > 1e-6) wrong_signs += (found < 0) != (exact < 0);
        if (std::abs(exact) > kVoxel) continue;
        worst = std::max(worst, std::abs(found - exact));
        ++near_count;
      }
  CHECK(near_count > 1000);
  CHECK(wrong_signs == 0);
  CHECK(worst < 1e-6);
  CHECK_THROWS_AS(rasterise_iso(query, inside, level, lattice, grid.leaf_nodes - 1), OutOfBudget);
}

TEST_CASE("inside: agrees with solid angles", "[capture]") {
  const Polygons box = shapes::box({1, 1, 1}, 2, true);
  Polygons mesh = box;
  add(mesh, box, {0.6, 0.3, 0.2});
  add(mesh, shapes::torus(1, 0.3, 24, 12), {0.1, 0.2, 0.3});
  const Surface surface = build_surface(mesh.view(), {});
  const Inside inside(surface);
  std::size_t count = 0, wrong = 0;
  for (double x = -1.45; x < 1.6; x += 0.1)
    for (double y = -1.45; y < 1.6; y += 0.1)
      for (double z = -0.55; z < 0.8; z += 0.1) {
        const bool expected = test::is_inside(mesh.view(), {x, y, z});
        wrong += inside({x, y, z}) != expected;
        count += expected;
      }
  CHECK(count > 1000);
  CHECK(wrong == 0);
}

TEST_CASE("mend: pierced spheres become whole, on the sphere", "[capture]") {
  Polygons mesh = shapes::icosphere(1, 3);
  // Each vertex beside the position of one a few edges away.
  for (const std::size_t v : {20u, 90u, 300u}) {
    const Vec3d away = mesh.positions[v] + Vec3d(0.25, -0.2, 0.15);
    mesh.positions[v] = away.unit();
  }
  REQUIRE(brute_force_crossings(mesh) > 0);
  Surface surface = build_surface(mesh.view(), {.enabled = false});
  const auto onto = [](const Vec3d& wish) { return std::optional(wish.unit()); };
  const MendStatistics statistics = mend(surface, onto);
  CHECK(statistics.before.crossings > 0);
  CHECK(statistics.left.total() == 0);
  CHECK(surface.vertices.size() == mesh.positions.size() + statistics.split_edges);
  Polygons mended;
  mended.positions = surface.vertices;
  for (const auto& [a, b, c] : surface.triangles) mended.add_face({a, b, c});
  CHECK(unsound(mended) == 0);
  CHECK(brute_force_crossings(mended) == 0);
  for (const Vec3d& p : mended.positions) CHECK(p.length() == Approx(1).epsilon(1e-12));
}

TEST_CASE("mend: splits that lead nowhere end, and leave nothing behind", "[capture]") {
  Polygons mesh = shapes::icosphere(1, 3);
  mesh.positions[90] = (mesh.positions[90] + Vec3d(0.25, -0.2, 0.15)).unit();
  Surface surface = build_surface(mesh.view(), {.enabled = false});
  // A surface with so few positions that every split makes needles.
  const Vec3d position = mesh.positions[90];
  const MendStatistics statistics = mend(surface, [&](const Vec3d&) { return std::optional(position); });
  CHECK(statistics.split_edges == 0);  // of the mesh that was kept
  CHECK(surface.vertices.size() == mesh.positions.size());
  CHECK(statistics.left.total() > 0);
  CHECK(statistics.left.total() <= statistics.before.total());
  CHECK(surface.triangles.size() == mesh.face_count());
  const std::vector<TrianglePair> crossings = CrossingFinder(surface, surface.vertices).all();
  CHECK(crossings.size() == statistics.left.crossings);
}
