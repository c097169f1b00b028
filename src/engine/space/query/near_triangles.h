// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "ground/numbers/float_lanes.h"
#include "ground/system/assert.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The triangles that meet a ball, each behind a plane: no point is nearer to the triangle than to its plane. The plane
/// through the triangle's closest point to a position, at right angles to the direction there, bounds the distance from
/// below anywhere, as distances to what is convex are convex, and drops most triangles that were not the closest at one
/// position of a smooth path from the closest at the next without looking at them.
///
/// Four planes at once, in floats, in a unit near the ball's radius; their rounding inside the ball is allowed for.
class NearTriangles {
 public:
  void begin(const Vec3d& centre, double unit) {
    VDB_OFFSET_ASSERT(unit > 0);
    centre_ = centre;
    scale_ = 1 / unit;
    size_ = 0;
  }
  /// `normal` is of unit length, or zero; the plane is `height` units away from the centre.
  void add(std::uint32_t triangle, const float (&normal)[3], float height) {
    if (size_ % kLanes == 0) {
      if (size_ / kLanes == planes_.size()) planes_.emplace_back();
      for (float& unused : planes_[size_ / kLanes].height) unused = kNowhere;
    }
    PlaneLanes& planes = planes_[size_ / kLanes];
    const std::size_t lane = size_++ % kLanes;
    planes.triangle[lane] = triangle;
    for (std::size_t k = 0; k < 3; ++k) planes.normal[k][lane] = normal[k];
    planes.height[lane] = height;
  }

  /// Removes the triangles for which leaves(triangle) is true.
  template <class Predicate>
  void remove_if(Predicate&& leaves) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i)
      if (!leaves(triangle(i))) copy(i, kept++);
    size_ = kept;
    for (; kept % kLanes != 0; ++kept) planes_[kept / kLanes].height[kept % kLanes] = kNowhere;
  }

  std::size_t size() const { return size_; }
  std::uint32_t triangle(std::size_t i) const { return planes_[i / kLanes].triangle[i % kLanes]; }
  /// The number of the triangle that has the plane nearest to the centre. \pre size() > 0
  std::size_t foremost() const {
    VDB_OFFSET_ASSERT(size_ > 0);
    std::size_t found = 0;
    for (std::size_t i = 1; i < size_; ++i)
      if (height(i) < height(found)) found = i;
    return found;
  }
  /// Calls look(i) for all triangles that may be nearer to x than `distance`. look() returns the distance that counts
  /// from then on, which may be less.
  template <class Look>
  void visit_nearer(const Vec3d& x, double distance, Look&& look) const {
    const Vec3d from_centre = (x - centre_) * scale_;
    const float at[3] = {static_cast<float>(from_centre[0]), static_cast<float>(from_centre[1]),
                         static_cast<float>(from_centre[2])};
    float limit = static_cast<float>(distance * scale_) + kSlack;
    for (std::size_t i = 0; i < size_; i += kLanes) {
      const PlaneLanes& planes = planes_[i / kLanes];
      Lanes above = load_lanes(planes.height);
      for (std::size_t k = 0; k < 3; ++k) above += load_lanes(planes.normal[k]) * at[k];
      for (unsigned near = lane_bits(above < limit + Lanes{}); near != 0; near &= near - 1)
        limit = static_cast<float>(look(i + static_cast<std::size_t>(std::countr_zero(near))) * scale_) + kSlack;
    }
  }

  /// Triangle i is `distance` from x, which `away` leads to from its closest point.
  void hold_back(std::size_t i, const Vec3d& x, const Vec3d& away, double distance) {
    VDB_OFFSET_ASSERT(i < size_);
    if (!(distance > 0)) return;
    PlaneLanes& planes = planes_[i / kLanes];
    const std::size_t lane = i % kLanes;
    const Vec3d normal = away / distance;
    for (std::size_t k = 0; k < 3; ++k) planes.normal[k][lane] = static_cast<float>(normal[static_cast<int>(k)]);
    planes.height[lane] = static_cast<float>((distance - normal.dot(x - centre_)) * scale_);
  }

 private:
  // kSlack, in units of the ball: more than the rounding of planes in it, and far less than the distances between
  // triangles that matter; not measured. kNowhere: the height of unused lanes, above any limit.
  static constexpr float kSlack = 4e-6F, kNowhere = 1e18F;
  struct PlaneLanes {
    float normal[3][kLanes]{}, height[kLanes];
    std::uint32_t triangle[kLanes];
  };
  float height(std::size_t i) const { return planes_[i / kLanes].height[i % kLanes]; }
  void copy(std::size_t i, std::size_t to) {
    const PlaneLanes& from = planes_[i / kLanes];
    PlaneLanes& planes = planes_[to / kLanes];
    for (std::size_t k = 0; k < 3; ++k) planes.normal[k][to % kLanes] = from.normal[k][i % kLanes];
    planes.height[to % kLanes] = from.height[i % kLanes];
    planes.triangle[to % kLanes] = from.triangle[i % kLanes];
  }

  Vec3d centre_{0.0};
  double scale_ = 1;
  std::size_t size_ = 0;
  std::vector<PlaneLanes> planes_;
};

}  // namespace vdb_offset
