// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "space/query/obstacles.h"

namespace vdb_offset {

/// Keeps one vertex off obstacles on its path: it comes no nearer than the clearance, or than it stands already.
class ObstacleGuard {
 public:
  /// For a vertex at `start`, in the obstacles' frame, that goes outward (`side` 1) or inward (-1). Keeps a reference.
  ObstacleGuard(const Obstacles& obstacles, const Vec3d& start, int side)
      : obstacles_(obstacles), start_(start), side_(side), bound_(std::min(obstacles.clearance, gap_at(start))) {}

  /// The first point from `from` to `to` beyond which an obstacle would be nearer than it may be; `to`, if there is
  /// none. The line is covered with balls that hold no obstacle, one after the other.
  Vec3d stop(const Vec3d& from, const Vec3d& to) {
    constexpr int kMostBalls = 1000;  // not measured
    const double length = (to - from).length(), touching = kTouches * length;
    if (!(length > 0)) return to;
    // A vertex that goes inward may slide along an obstacle that it touches, as where a part rests on it: the gap stays
    // what it was.
    if (side_ < 0 && bound_ <= touching && gap_at(to) <= touching) return to;
    const Vec3d direction = (to - from) / length;
    double gone = 0;
    for (int i = 0; i < kMostBalls && gone < length; ++i) {
      const Vec3d here = from + direction * gone;
      const double gap = gap_at(here), room = gap - bound_;
      if (room > touching) {
        gone += room;
        continue;
      }
      if (gap <= touching && !(here == start_ && may_leave(direction, kLeast * length))) return here;
      const double step = std::min(length - gone, std::max(kShare * gap, kLeast * length)),
                   next = gap_at(here + direction * step);
      if (next < gap || next <= touching) return here;
      gone += step;
    }
    return gone < length ? from + direction * gone : to;
  }

 private:
  // Shares of the line's length: an obstacle that is as near as kTouches is touched; a line that leaves an obstacle, or
  // goes along it as near as it may be, is judged in steps of kShare of the gap, and of kLeast of the line at least.
  // Not measured.
  static constexpr double kTouches = 1e-9, kShare = 0.5, kLeast = 1e-3;

  double gap_at(const Vec3d& x) {
    const Closest closest = obstacles_.query(x, hint_);
    hint_ = closest.triangle;
    return closest.distance;
  }

  /// Whether a vertex that touches an obstacle may leave it in a direction. An obstacle that the surface touches is in
  /// front of it, and so blocks outward directions, unless it is nearer behind; inward the surface leaves it.
  bool may_leave(const Vec3d& direction, double step) {
    constexpr double kAlike = 1e-3;  // share by which gaps ahead and behind differ by rounding alone; not measured
    const double ahead = gap_at(start_ + direction * step), behind = gap_at(start_ - direction * step);
    return side_ > 0 ? ahead > behind * (1 + kAlike) : ahead > behind * (1 - kAlike);
  }

  const Obstacles& obstacles_;
  Vec3d start_;
  int side_;
  std::uint32_t hint_ = 0;
  double bound_;
};

}  // namespace vdb_offset
