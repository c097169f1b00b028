// SPDX-License-Identifier: Apache-2.0
// Arcs whose faces are split as well, arcs at borders, and what is held back beside them.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

RefinedOffset opened_and_split(const Polygons& mesh, double distance, const Tolerance& tolerance, int threads = 0) {
  OffsetOptions options;
  options.distance = distance;
  options.corners = Corners::Arc;
  options.threads = threads;
  options.precision = tolerance.precision;
  return offset_to_tolerance(mesh.view(), options, tolerance);
}

double certified_share(const RefinedOffset& made) { return made.result.statistics.certified.value().certified; }

struct Prism {
  bool has_lids = true;
  std::uint32_t stacks = 1;  // of faces along its walls
  double slope = 0;          // along x, of its ends
};
/// A prism of height 1 over an outline.
Polygons prism_over(const std::vector<std::pair<double, double>>& outline, const Prism& prism) {
  const auto count = static_cast<std::uint32_t>(outline.size());
  Polygons mesh;
  for (std::uint32_t k = 0; k <= prism.stacks; ++k)
    for (const auto& [x, y] : outline)
      mesh.positions.emplace_back(x, y, static_cast<double>(k) / prism.stacks + prism.slope * x);
  for (std::uint32_t k = 0; k < prism.stacks; ++k)
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t a = k * count + i, b = k * count + (i + 1) % count;
      mesh.add_face({a, b, b + count, a + count});
    }
  if (!prism.has_lids) return mesh;
  for (std::uint32_t i = count; i-- > 0;) mesh.corners.push_back(i);
  mesh.close_face();
  for (std::uint32_t i = 0; i < count; ++i) mesh.corners.push_back(prism.stacks * count + i);
  mesh.close_face();
  return mesh;
}

/// How many added vertices do not stand where their shares of a face's corners say.
std::size_t misplaced_origins(const Polygons& mesh, const Refinement& refinement) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < refinement.added.size(); ++i) {
    const VertexOrigin& origin = refinement.added[i];
    const std::array<double, 3>& share = origin.share;
    const auto corners = mesh.view().face(origin.face);
    const auto is_corner = [&](std::size_t k) {
      return share[k] == 0 || std::find(corners.begin(), corners.end(), origin.vertex[k]) != corners.end();
    };
    Vec3d position(0.0);
    for (std::size_t k = 0; k < 3; ++k) position += mesh.positions[origin.vertex[k]] * share[k];
    const Vec3d off = refinement.polygons.positions[mesh.positions.size() + i] - position;
    const bool is_there = off.length() < 1e-15 && share[0] + share[1] + share[2] == 1;
    count += is_there && is_corner(0) && is_corner(1) && is_corner(2) ? 0 : 1;
  }
  return count;
}

/// The most area that a face over a ridge has in the source, twice.
double area_over_ridges(const Refinement& refinement) {
  const std::vector<Vec3d>& x = refinement.polygons.positions;
  double most = 0;
  for (std::size_t f = refinement.faces_in_place(); f < refinement.parent.size(); ++f) {
    const auto face = refinement.polygons.view().face(f);
    most = std::max(most, (x[face[1]] - x[face[0]]).cross(x[face[2]] - x[face[0]]).length());
  }
  return most;
}

/// That the refinement is one of the mesh: faces in their order, and added vertices where their shares say.
void require_refinement_of(const Polygons& mesh, const Refinement& refinement) {
  const std::size_t in_place = refinement.faces_in_place(), strips = refinement.parent.size() - refinement.over_corners;
  REQUIRE(in_place < refinement.parent.size());
  const auto at = [&](std::size_t face) { return refinement.parent.begin() + static_cast<std::ptrdiff_t>(face); };
  const bool in_order = std::is_sorted(at(0), at(in_place)) && std::is_sorted(at(in_place), at(strips)) &&
                        std::is_sorted(at(strips), refinement.parent.end());
  CHECK(in_order);
  CHECK(*(at(in_place) - 1) + 1 == mesh.face_count());
  REQUIRE(refinement.source_vertices() == mesh.positions.size());
  CHECK(misplaced_origins(mesh, refinement) == 0);
  CHECK(area_over_ridges(refinement) < 1e-15);
}

}  // namespace

TEST_CASE("split arcs: a half ball's rim is opened, and its round side is split") {
  const Polygons mesh = shapes::hemisphere(1, 16, 4);
  const double d = 0.1;
  const RefinedOffset ridges = opened_and_split(mesh, d, {.share = 0.002, .ridges_only = true}),
                      all = opened_and_split(mesh, d, {.share = 0.002});
  CHECK(ridges.refinement.faces_in_place() == mesh.face_count());
  CHECK(certified_share(ridges) < 0.9999);
  CHECK(certified_share(all) == Approx(1).epsilon(1e-6));
  CHECK(all.refinement.faces_in_place() > mesh.face_count());
  require_refinement_of(mesh, all.refinement);
  CheckOptions options;
  options.distance = d;
  options.corners = Corners::Arc;
  options.tolerance_share = 0.002;
  const CheckResult found = check_offset(all.refinement.polygons.view(), all.result.positions, options);
  CHECK(found.valid());
  CHECK(found.certified->certified == Approx(1).epsilon(1e-6));
}

TEST_CASE("split arcs: ridges take fewer faces than splitting does") {
  const Polygons mesh = shapes::cylinder(0.5, 1, 48, 1, 1);
  OffsetOptions options;
  options.distance = 0.1;
  options.corners = Corners::Round;
  const Tolerance tolerance{.share = 0.002};
  const RefinedOffset split = offset_to_tolerance(mesh.view(), options, tolerance),
                      arcs = opened_and_split(mesh, 0.1, tolerance);
  CHECK(certified_share(arcs) >= certified_share(split));
  CHECK(3 * arcs.refinement.parent.size() < split.refinement.parent.size());
}

TEST_CASE("split arcs: what a file keeps of coordinates does not matter") {
  const Polygons mesh = shapes::hemisphere(1, 12, 3);
  Tolerance tolerance{.share = 0.005};
  tolerance.precision.kind = Precision::Kind::Digits;
  tolerance.precision.digits = 6;
  const RefinedOffset made = opened_and_split(mesh, 0.1, tolerance);
  CHECK(made.refinement.faces_in_place() > mesh.face_count());
  CHECK(certified_share(made) == Approx(1).epsilon(1e-6));
  CHECK(made.result.statistics.limit.source_crossings == 0);
}

TEST_CASE("split arcs: the result does not depend on the number of threads") {
  const Polygons mesh = shapes::hemisphere(1, 12, 3);
  const RefinedOffset one = opened_and_split(mesh, 0.2, {.share = 0.002}, 1),
                      four = opened_and_split(mesh, 0.2, {.share = 0.002}, 4);
  CHECK(one.refinement.polygons.corners == four.refinement.polygons.corners);
  CHECK(one.refinement.polygons.positions == four.refinement.polygons.positions);
  CHECK(one.result.positions == four.result.positions);
}

TEST_CASE("split arcs: a ridge that ends on a border is opened along the border's plane") {
  const double slope = GENERATE(0.0, 0.4);
  const Polygons mesh =
      prism_over({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, {.has_lids = false, .slope = slope});
  const double d = 0.1;
  const RefinedOffset made = opened_and_split(mesh, d, {.share = 0.01, .ridges_only = true});
  CHECK(made.refinement.over_ridges == 5 * 7);
  if (slope == 0) CHECK(certified_share(made) == Approx(1).epsilon(1e-9));
  // What begins on one of the two planes ends there, at the distance.
  for (std::size_t v = 0; v < made.result.positions.size(); ++v) {
    const Vec3d &from = made.refinement.polygons.positions[v], &to = made.result.positions[v];
    CHECK(to[2] - from[2] == Approx(slope * (to[0] - from[0])).margin(1e-12));
    if (made.result.states[v] == VertexState::Reached) CHECK(made.result.achieved[v] == Approx(d));
  }
  CHECK(certified_share(opened_and_split(mesh, d, {.share = 0.01})) > 0.9995);
}

TEST_CASE("split arcs: beside a slot without room, faces over ridges return to the distance") {
  // A U whose slot is as wide as the distance, with walls of many faces.
  std::vector<std::pair<double, double>> outline{{0, 0}, {1.1, 0}, {1.1, 1}};
  for (int i = 7; i >= 0; --i) outline.emplace_back(0.6, 0.3 + 0.1 * i);
  for (int i = 0; i <= 7; ++i) outline.emplace_back(0.5, 0.3 + 0.1 * i);
  outline.emplace_back(0, 1);
  const RefinedOffset made =
      opened_and_split(prism_over(outline, {.stacks = 5}), 0.1, {.share = 0.01, .ridges_only = true});
  const OffsetStatistics& statistics = made.result.statistics;
  CHECK(statistics.vertices_by_state[static_cast<std::size_t>(VertexState::Collision)] > 0);
  CHECK(statistics.limit.left.total() == 0);
  CHECK(certified_share(made) > 0.61);  // 0.59 if those that are held back stay beside them
}
