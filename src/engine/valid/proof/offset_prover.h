// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "space/query/closest_query.h"

namespace vdb_offset {

/// A triangle of an offset, whose points are to be at a distance that is linear over it. All corners are on one side of
/// the surface.
struct OffsetTriangle {
  std::array<Vec3d, 3> corners;     ///< In the frame of the surface.
  std::array<double, 3> asked;      ///< Distances at the corners, above 0, without their sign.
  std::array<double, 3> tolerance;  ///< How far off a corner may be, and linear in between.
  bool may_keep_to_plane = false;   ///< Points that are farther are right where they are over `plane`, as a miter is:
  std::array<double, 3> over_plane{};  ///< the distances of the corners from the plane of the triangle in the source.
};

enum class Certainty : std::uint8_t {
  Proven,  ///< Every point is within the tolerance of its distance.
  Off,     ///< Some point is not.
  Open,    ///< Neither could be shown with a bounded number of exact distances.
};

struct Proof {
  Certainty certainty;
  double error;  ///< Off: of the point that was found, beyond its distance without the tolerance; else 0.
};

/// Proves that triangles of an offset are at their distance at every point, not only at some.
///
/// The distance to one triangle of the surface is convex. So it is no less, anywhere on a triangle of the offset, than
/// a plane proves that no corner of the surface's triangle passes, or that touches its ball at one point; and it is no
/// more than linear between the corners. The first of all triangles of the surface that are near enough prove that no
/// point is too near; the second of one of them that none is too far. Where either fails, an exact distance at the
/// middle shows whether that point is off, and if it is not, both halves are looked at (Lipschitz's bound alone would
/// need the square of the number of pieces). The answer depends on nothing but the triangle and the surface. Safe from
/// any number of threads.
class OffsetProver {
 public:
  /// Keeps a reference.
  explicit OffsetProver(const ClosestQuery& query) : query_(query) {}

  Proof operator()(const OffsetTriangle& triangle) const;

 private:
  class Recursion;
  const ClosestQuery& query_;
};

}  // namespace vdb_offset
