#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "vdb_offset/base/float_lanes.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The triangles that meet a ball, each behind a plane: no point is nearer to the triangle than to that. The plane that
/// faces a place in the triangle's closest point to it bounds the distance from below anywhere, as distances to what is
/// convex are convex, and tells most triangles that were not the closest at one place of a smooth way from the closest
/// at the next without looking at them.
///
/// Four planes at once, in floats, in a unit near the ball's radius; what they round inside the ball is made up for.
class NearTriangles {
 public:
  void begin(const Vec3d& centre, double unit) {
    centre_ = centre;
    scale_ = 1 / unit;
    size_ = 0;
  }
  /// `normal` is of unit length, or zero; the plane is `height` units away from the centre.
  void add(std::uint32_t triangle, const float (&normal)[3], float height) {
    if (size_ % kLanes == 0) {
      if (size_ / kLanes == fours_.size()) fours_.emplace_back();
      for (float& unused : fours_[size_ / kLanes].height) unused = kNowhere;
    }
    Four& four = fours_[size_ / kLanes];
    const std::size_t lane = size_++ % kLanes;
    four.triangle[lane] = triangle;
    for (std::size_t k = 0; k < 3; ++k) four.normal[k][lane] = normal[k];
    four.height[lane] = height;
  }

  /// Leaves those out of which that is true.
  template <class Predicate>
  void remove_if(Predicate&& leaves) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i)
      if (!leaves(triangle(i))) copy(i, kept++);
    size_ = kept;
    for (; kept % kLanes != 0; ++kept) fours_[kept / kLanes].height[kept % kLanes] = kNowhere;
  }

  std::size_t size() const { return size_; }
  std::uint32_t triangle(std::size_t i) const { return fours_[i / kLanes].triangle[i % kLanes]; }
  /// The one whose plane is the nearest to the centre. \pre size() > 0
  std::size_t foremost() const {
    std::size_t found = 0;
    for (std::size_t i = 1; i < size_; ++i)
      if (height(i) < height(found)) found = i;
    return found;
  }
  /// Calls look(i) for all that may be nearer to x than `distance`, which look() returns, lowered or not.
  template <class Look>
  void visit_nearer(const Vec3d& x, double distance, Look&& look) const {
    const Vec3d from_centre = (x - centre_) * scale_;
    const float at[3] = {static_cast<float>(from_centre[0]), static_cast<float>(from_centre[1]),
                         static_cast<float>(from_centre[2])};
    float limit = static_cast<float>(distance * scale_) + kSlack;
    for (std::size_t i = 0; i < size_; i += kLanes) {
      const Four& four = fours_[i / kLanes];
      Lanes above = load_lanes(four.height);
      for (std::size_t k = 0; k < 3; ++k) above += load_lanes(four.normal[k]) * at[k];
      for (unsigned near = lane_bits(above < limit + Lanes{}); near != 0; near &= near - 1)
        limit = static_cast<float>(look(i + static_cast<std::size_t>(std::countr_zero(near))) * scale_) + kSlack;
    }
  }

  /// Triangle i is `distance` from x, which `away` leads to from its closest point.
  void hold_back(std::size_t i, const Vec3d& x, const Vec3d& away, double distance) {
    if (!(distance > 0)) return;
    Four& four = fours_[i / kLanes];
    const std::size_t lane = i % kLanes;
    const Vec3d normal = away / distance;
    for (std::size_t k = 0; k < 3; ++k) four.normal[k][lane] = static_cast<float>(normal[static_cast<int>(k)]);
    four.height[lane] = static_cast<float>((distance - normal.dot(x - centre_)) * scale_);
  }

 private:
  // More than what planes of the size of the ball round, and far less than what tells triangles from each other.
  static constexpr float kSlack = 4e-6F, kNowhere = 1e18F;
  struct Four {
    float normal[3][kLanes]{}, height[kLanes];
    std::uint32_t triangle[kLanes];
  };
  float height(std::size_t i) const { return fours_[i / kLanes].height[i % kLanes]; }
  void copy(std::size_t i, std::size_t to) {
    const Four& from = fours_[i / kLanes];
    Four& four = fours_[to / kLanes];
    for (std::size_t k = 0; k < 3; ++k) four.normal[k][to % kLanes] = from.normal[k][i % kLanes];
    four.height[to % kLanes] = from.height[i % kLanes];
    four.triangle[to % kLanes] = from.triangle[i % kLanes];
  }

  Vec3d centre_{0.0};
  double scale_ = 1;
  std::size_t size_ = 0;
  std::vector<Four> fours_;
};

}  // namespace vdb_offset
