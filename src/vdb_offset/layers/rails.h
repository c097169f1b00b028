#pragma once

#include <cmath>
#include <cstdint>

#include "vdb_offset/mesh/point_triangle.h"
#include "vdb_offset/polygons.h"

/// What layers over surfaces and over curves have in common.
namespace vdb_offset {

// What the way up must have at least of each face's normal at the wall.
inline constexpr double kLeastSlope = 1e-2;
// The way up leans towards the sides of a cell by no less than this sine.
inline constexpr double kLeastLean = 1e-3;

/// The curve that a vertex's layers stand on: x(eta) = whole eta + bend eta (1 - eta)^2, from 0 at the surface to 1.
struct Rail {
  Vec3d whole, bend;
  Vec3d operator()(double eta) const { return whole * eta + bend * (eta * (1 - eta) * (1 - eta)); }
  Vec3d along(double eta) const { return whole + bend * ((1 - eta) * (1 - 3 * eta)); }
};

/// The distance of a point, and the way there from the surface.
struct Phi {
  double value;
  Vec3d away;
};
inline Phi phi_of(const TrianglePoint& nearest, const Vec3d& x) {
  return {std::sqrt(nearest.squared_distance), x - nearest.point};
}
inline Phi phi_of(const Vec3d& away) { return {away.length(), away}; }

/// Distances along a vertex's rail, of points in the front's frame. The closest triangle to one point is likely to be
/// that of the next: find() looks for it, at() believes it and is never too small.
template <class Query>
class QueryDistance {
 public:
  QueryDistance(const Query& front, std::uint32_t hint) : front_(front), triangle_(hint) {}

  Phi at(const Vec3d& x) const { return phi_of(front_.surface().closest_on(triangle_, x), x); }
  Phi find(const Vec3d& x) {
    const auto found = front_(x, triangle_);
    triangle_ = found.triangle;
    return {found.distance, x - found.point};
  }

 private:
  const Query& front_;
  std::uint32_t triangle_;
};

/// A place on a rail, and its distance.
struct RailPlace {
  double eta;
  Phi phi;
};

/// Where on the rail, between its start and the place `above`, the distance is `target`, far below the promised 1e-6:
/// Newton's method on the distance of one triangle, kept between what is known to be below and above; where that does
/// not lead on, or has led there, on the closest one's. It is the innermost loop: called, it takes a fifteenth longer.
template <class Field>
[[gnu::always_inline]] inline RailPlace place_on(const Rail& rail, const Vec3d& origin, const RailPlace& above,
                                                 double target, Field&& field) {
  constexpr double kTolerance = 1e-7, kNearlyThere = 2e-4;
  constexpr int kMost = 60;
  double low = 0, high = above.eta, believed_high = high;
  RailPlace here = above;
  for (int i = 0; i < kMost; ++i) {
    const double slope = here.phi.away.dot(rail.along(here.eta)) / here.phi.value;
    const double next = here.eta - (here.phi.value - target) / slope;
    const bool leads_on = slope > 0 && next > low && next < believed_high;
    // Newton's error shrinks to the square of what it was.
    const bool leads_there = leads_on && i > 0 && std::abs(here.phi.value - target) <= kNearlyThere * target;
    here.eta = leads_on ? next : (low + high) / 2;
    const Vec3d x = origin + rail(here.eta);
    if (leads_on && !leads_there) {
      here.phi = field.at(x);
      if (here.phi.value < target) low = here.eta;
      else believed_high = here.eta;
      continue;
    }
    here.phi = field.find(x);
    if (std::abs(here.phi.value - target) <= kTolerance * target) break;
    (here.phi.value < target ? low : high) = here.eta;
    believed_high = high;
  }
  return here;
}

}  // namespace vdb_offset
