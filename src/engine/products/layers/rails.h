// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "ground/mesh/point_triangle.h"
#include "vdb_offset/polygons.h"

/// The curves that layers stand on, over surfaces and over curves.
namespace vdb_offset {

// The least cosine between the way up from a vertex and the normal of each face around it, at the wall: no cell starts
// flatter than 0.6 degrees. Not measured.
inline constexpr double kLeastSlope = 1e-2;
// The least sine of the angle between the way up from one layer to the next and a face of the cell below or above it:
// cells that are flatter are valid by rounding alone. Not measured.
inline constexpr double kLeastLean = 1e-3;

/// The curve that a vertex's layers stand on: x(eta) = whole eta + bend eta (1 - eta)^2, from eta = 0 at the surface to
/// 1 at the end of the vertex's path.
struct Rail {
  Vec3d whole, bend;
  Vec3d operator()(double eta) const { return whole * eta + bend * (eta * (1 - eta) * (1 - eta)); }
  /// The derivative by eta.
  Vec3d along(double eta) const { return whole + bend * ((1 - eta) * (1 - 3 * eta)); }
};

/// The distance of a point, and the vector to it from the closest point of the surface.
struct Phi {
  double value;
  Vec3d away;
};
inline Phi phi_of(const TrianglePoint& nearest, const Vec3d& x) {
  return {std::sqrt(nearest.squared_distance), x - nearest.point};
}
inline Phi phi_of(const Vec3d& away) { return {away.length(), away}; }

/// Distances along a vertex's rail by the exact query, of points in the moving part's frame. The triangle that is
/// closest to one point is likely to be closest to the next: find() searches for it; at() takes the distance of the
/// last one found, which is never too small.
template <class Query>
class QueryDistance {
 public:
  QueryDistance(const Query& query, std::uint32_t hint) : query_(query), triangle_(hint) {}

  Phi at(const Vec3d& x) const { return phi_of(query_.surface().closest_on(triangle_, x), x); }
  Phi find(const Vec3d& x) {
    const auto found = query_(x, triangle_);
    triangle_ = found.triangle;
    return {found.distance, x - found.point};
  }

 private:
  const Query& query_;
  std::uint32_t triangle_;
};

/// A point on a rail, and its distance.
struct RailPoint {
  double eta;
  Phi phi;
};

/// The point of the rail, between its start and `above`, whose distance is `target`, to far less than the promised
/// 1e-6. Newton's method on the distance to one triangle, kept between parameters that are known to be below and above;
/// where its step leaves these, or has come close, the closest triangle is searched for. It is the innermost loop of
/// growing: called instead of inlined, growing takes a fifteenth longer.
template <class Distance>
[[gnu::always_inline]] inline RailPoint point_on(const Rail& rail, const Vec3d& origin, const RailPoint& above,
                                                 double target, Distance&& distance) {
  // Relative error of the distance at which a point is taken: a tenth of the promised 1e-6.
  constexpr double kTolerance = 1e-7;
  // Relative error from which one more of Newton's steps gets below kTolerance, as its error is squared: 4e-8.
  constexpr double kNearlyThere = 2e-4;
  // The most steps. Halving alone needs 24 for kTolerance; not measured beyond that.
  constexpr int kMost = 60;
  double low = 0, high = above.eta, believed_high = high;
  RailPoint here = above;
  for (int i = 0; i < kMost; ++i) {
    const double slope = here.phi.away.dot(rail.along(here.eta)) / here.phi.value;
    const double next = here.eta - (here.phi.value - target) / slope;
    const bool leads_on = slope > 0 && next > low && next < believed_high;
    const bool leads_there = leads_on && i > 0 && std::abs(here.phi.value - target) <= kNearlyThere * target;
    here.eta = leads_on ? next : (low + high) / 2;
    const Vec3d x = origin + rail(here.eta);
    if (leads_on && !leads_there) {
      here.phi = distance.at(x);
      if (here.phi.value < target) low = here.eta;
      else believed_high = here.eta;
      continue;
    }
    here.phi = distance.find(x);
    if (std::abs(here.phi.value - target) <= kTolerance * target) break;
    (here.phi.value < target ? low : high) = here.eta;
    believed_high = high;
  }
  return here;
}

}  // namespace vdb_offset
