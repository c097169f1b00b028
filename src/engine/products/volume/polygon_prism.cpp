// SPDX-License-Identifier: Apache-2.0
#include "products/volume/polygon_prism.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "ground/mesh/triangulate.h"
#include "ground/system/assert.h"

namespace vdb_offset {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
// Largest number of corners of a polygon whose best split is searched, which takes O(corners^3). A larger polygon is
// split in one way only. Not measured.
constexpr std::size_t kFewCorners = 32;

/// Twice the area vector of a polygon, in the direction from which it runs clockwise.
Vec3d area_from_below(const std::vector<Vec3d>& ring) {
  Vec3d sum(0.0);
  for (std::size_t k = ring.size() - 1; k > 1; --k) sum += (ring[k] - ring[0]).cross(ring[k - 1] - ring[0]);
  return sum;
}

/// A polygon's corner with its neighbours.
struct Corner {
  Corner(const std::vector<Vec3d>& ring, std::size_t k)
      : previous(ring[(k + ring.size() - 1) % ring.size()]), at(ring[k]), next(ring[(k + 1) % ring.size()]) {}

  bool turns_outwards(const Vec3d& from_below) const {
    // Least sine of the angle at a corner that counts: corners that are straight but for rounding say nothing about the
    // prism. Far above rounding, far below corners that are intended. Not measured.
    constexpr double kStraight = 1e-6;
    return unit_triple(at - next, previous - at, from_below) >= kStraight;
  }
  const Vec3d &previous, &at, &next;
};

/// The least triple product over the corners that turn outwards in base and top; infinite if none does.
double least_at_corners(const PolygonPrism& prism) {
  const Vec3d base = area_from_below(prism.below), top = area_from_below(prism.above);
  double least = kUnbounded;
  for (std::size_t k = 0; k < prism.size(); ++k) {
    const Corner below(prism.below, k), above(prism.above, k);
    if (prism.flat[k] != 0 || !below.turns_outwards(base) || !above.turns_outwards(top)) continue;
    least = std::min({least, unit_triple(below.next - below.at, below.previous - below.at, above.at - below.at),
                      unit_triple(above.previous - above.at, above.next - above.at, below.at - above.at)});
  }
  return least;
}

/// The least cosine between the edges upwards and the normals of base and top, of the prism over three corners.
/// Infinite if all three corners are flat.
double least_lean(const PolygonPrism& prism, const std::array<std::size_t, 3>& corners) {
  const auto normal = [&](const std::vector<Vec3d>& ring) {
    return (ring[corners[1]] - ring[corners[0]]).cross(ring[corners[2]] - ring[corners[0]]);
  };
  const Vec3d below = normal(prism.below), above = normal(prism.above);
  double least = kUnbounded;
  for (const std::size_t k : corners) {
    if (prism.flat[k] != 0) continue;
    const Vec3d up = prism.above[k] - prism.below[k];
    for (const Vec3d& n : {below, above}) {
      const double lengths = n.length() * up.length();
      least = std::min(least, lengths > 0 ? n.dot(up) / lengths : 0);
    }
  }
  return least;
}

/// The least lean in the best split of the base. best[i][j] is that of the polygon from corner i to corner j and back.
double best_split(const PolygonPrism& prism) {
  const std::size_t n = prism.size();
  std::vector<double> best(n * n, kUnbounded);
  for (std::size_t size = 2; size < n; ++size)
    for (std::size_t i = 0; i + size < n; ++i) {
      double& found = best[i * n + i + size];
      found = -kUnbounded;
      for (std::size_t k = i + 1; k < i + size; ++k) {
        const double parts = std::min(best[i * n + k], best[k * n + i + size]);
        if (parts > found) found = std::max(found, std::min(parts, least_lean(prism, {i, k, i + size})));
      }
    }
  return best[n - 1];
}

/// The least lean in the split of the base that triangulate() makes.
double base_split(const PolygonPrism& prism) {
  std::vector<std::uint32_t> ring(prism.size());
  std::iota(ring.begin(), ring.end(), 0);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangulate(prism.below, ring, triangles);
  double least = kUnbounded;
  for (const auto& [a, b, c] : triangles) least = std::min(least, least_lean(prism, {a, b, c}));
  return least;
}

}  // namespace

double scaled_jacobian(const PolygonPrism& prism) {
  VDB_OFFSET_ASSERT(prism.size() > 2 && prism.above.size() == prism.size() && prism.flat.size() == prism.size());
  const double corners = least_at_corners(prism);
  const double split = prism.size() > kFewCorners ? base_split(prism) : best_split(prism);
  if (!(split > 0)) return std::min(corners, split);
  if (corners > 0 && corners < kUnbounded) return corners;
  return split < kUnbounded ? split : 0;
}

}  // namespace vdb_offset
