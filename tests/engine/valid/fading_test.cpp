// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/fading.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "space/surface/creases.h"
#include "space/surface/surface.h"
#include "support/oracles.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

OffsetResult tapered(const Polygons& mesh, double distance, double taper, Corners corners = Corners::Round) {
  OffsetOptions options;
  options.distance = distance;
  options.corners = corners;
  options.taper = taper;
  return offset(mesh.view(), options);
}

/// Whether each vertex of a mesh is on a crease.
std::vector<bool> vertices_that_stay(const Polygons& mesh) {
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, 0.1);
  const std::vector<std::uint8_t> on_crease = vertices_on_creases(surface);
  std::vector<bool> result;
  for (const auto w : surface.welded) result.push_back(w != kNone && on_crease[w] != 0);
  return result;
}

/// Edges of the source along which thickness rises by more than their length to a vertex that is on no crease.
std::size_t steep_edges(const Polygons& mesh, const OffsetResult& result, double distance) {
  const std::vector<bool> on_crease = vertices_that_stay(mesh);
  std::set<std::pair<std::uint32_t, std::uint32_t>> steep;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      std::uint32_t low = face[k], high = face[(k + 1) % face.size()];
      if (result.achieved[low] > result.achieved[high]) std::swap(low, high);
      if (on_crease[high]) continue;
      const double rise = result.achieved[high] - result.achieved[low];
      if (rise > (mesh.positions[low] - mesh.positions[high]).length() + 0.01 * std::abs(distance))
        steep.insert({low, high});
    }
  }
  return steep.size();
}

}  // namespace

TEST_CASE("fading: thickness rises from what falls short no more steeply than the taper says, as far as that is valid",
          "[limit][fading][no_races]") {
  // Fronts meet all over. Of the edges that stay steep each has a vertex that folds faces wherever it is nearer.
  const Polygons mesh = shapes::bumpy_sphere(1, 0.5, 4, 5, 5);
  constexpr double kDistance = -0.15;
  const OffsetResult abrupt = tapered(mesh, kDistance, 0), faded = tapered(mesh, kDistance, 1);
  const std::size_t before = steep_edges(mesh, abrupt, kDistance);
  REQUIRE(before > 500);
  CHECK(steep_edges(mesh, faded, kDistance) < before * 2 / 5);
  CHECK(abrupt.statistics.limit.faded_vertices == 0);
  CHECK(faded.statistics.limit.faded_vertices > 0);
  CHECK(check_offset(mesh.view(), faded.positions, {.distance = kDistance, .corners = Corners::Round}).valid());
}

TEST_CASE("fading: what is on a crease stays where it is", "[limit][fading]") {
  const Polygons mesh = shapes::naca_wing("2412", 1, 1, 80, 40);
  const std::vector<bool> on_crease = vertices_that_stay(mesh);
  const OffsetResult abrupt = tapered(mesh, -0.0425828, 0), faded = tapered(mesh, -0.0425828, 1);
  std::size_t on_creases = 0, moved = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const bool stays = faded.positions[v] == abrupt.positions[v];
    on_creases += on_crease[v];
    moved += !stays;
    if (on_crease[v]) CHECK(stays);
  }
  CHECK(on_creases > 50);
  CHECK(moved > 50);
}

TEST_CASE("fading: a shape that nothing holds back is as without", "[limit][fading]") {
  const Polygons mesh = shapes::torus(1, 0.4, 48, 24);
  CHECK(tapered(mesh, 0.1, 1).positions == tapered(mesh, 0.1, 0).positions);
}

TEST_CASE("fading: the taper is a number of 0 or more", "[limit][fading]") {
  const Polygons mesh = shapes::torus(1, 0.4, 12, 6);
  for (const double taper : {-1.0, std::nan("")}) CHECK_THROWS_AS(tapered(mesh, 0.1, taper), InvalidInput);
}
