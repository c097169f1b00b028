#pragma once

#include <algorithm>
#include <cstdint>

#include "vdb_offset/query/obstacles.h"

namespace vdb_offset {

/// Keeps one vertex off obstacles on its way. It comes no nearer than the clearance, or than it stands already.
class ObstacleGuard {
 public:
  /// Of a vertex at `start`, in the obstacles' frame, on its way outward (`side` 1) or inward (-1). Keeps a reference.
  ObstacleGuard(const Obstacles& obstacles, const Vec3d& start, int side)
      : obstacles_(obstacles), start_(start), side_(side), bound_(std::min(obstacles.clearance, gap_at(start))) {}

  /// The first point from `from` to `to` beyond which an obstacle would be nearer than it may be: balls that hold none,
  /// one after the other. `to`, if there is none.
  Vec3d stop(const Vec3d& from, const Vec3d& to) {
    constexpr int kMostBalls = 1000;
    const double length = (to - from).length(), touching = kTouches * length;
    if (!(length > 0)) return to;
    // What shrinks may slide along what it touches, as where a part rests on it: the gap stays what it was.
    if (side_ < 0 && bound_ <= touching && gap_at(to) <= touching) return to;
    const Vec3d way = (to - from) / length;
    double gone = 0;
    for (int i = 0; i < kMostBalls && gone < length; ++i) {
      const Vec3d here = from + way * gone;
      const double gap = gap_at(here), room = gap - bound_;
      if (room > touching) {
        gone += room;
        continue;
      }
      if (gap <= touching && !(here == start_ && may_leave(way, kLeast * length))) return here;
      const double step = std::min(length - gone, std::max(kShare * gap, kLeast * length)),
                   next = gap_at(here + way * step);
      if (next < gap || next <= touching) return here;
      gone += step;
    }
    return gone < length ? from + way * gone : to;
  }

 private:
  // What is as near as this, as a share of a way, touches; a way that leaves an obstacle, or goes along it as near as
  // may be, is looked at in steps of such shares: of the gap, and of itself.
  static constexpr double kTouches = 1e-9, kShare = 0.5, kLeast = 1e-3;

  double gap_at(const Vec3d& x) {
    const Closest closest = obstacles_.query(x, hint_);
    hint_ = closest.triangle;
    return closest.distance;
  }

  /// What the surface touches is in front of it, and so in the way outward, unless it is nearer to what is behind; to
  /// shrink takes the surface away from it.
  bool may_leave(const Vec3d& way, double step) {
    constexpr double kAlike = 1e-3;
    const double ahead = gap_at(start_ + way * step), behind = gap_at(start_ - way * step);
    return side_ > 0 ? ahead > behind * (1 + kAlike) : ahead > behind * (1 - kAlike);
  }

  const Obstacles& obstacles_;
  Vec3d start_;
  int side_;
  std::uint32_t hint_ = 0;
  double bound_;
};

}  // namespace vdb_offset
