// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "ground/system/assert.h"
#include "space/query/closest_query.h"

/// The path on which the distance rises fastest, without a field, of a Surface and of a Polyline alike. Between plane
/// faces it is straight above one of them, then along the ridge between two or three, and so known in a few segments of
/// any length.
namespace vdb_offset {

/// A path's corners, the last of which is its end, and what is closest there.
struct RidgePath {
  static constexpr std::size_t kMostCorners = 6;  ///< Not measured.
  bool found = false;
  std::array<Vec3d, kMostCorners> corners;
  std::size_t count = 0;
  Closest end;
};

namespace detail {

/// Directions away from the closest points, which are all as near, and the direction in which the distance from all of
/// them rises fastest.
class Ridge {
 public:
  /// What a further point that is as near makes of that. Onward: the distance rises in a new direction. Top: it rises
  /// no more. Unclear: the faces lie almost in a plane; on the many ridges of faces that stand for a curved surface,
  /// neighbours would lose their order. Same: the direction away from it was known.
  enum class Rise : std::uint8_t { Onward, Top, Unclear, Same };

  explicit Ridge(const Vec3d& away) : direction_(away), slope_(1) { away_[count_++] = away; }

  const Vec3d& direction() const { return direction_; }
  /// How much the distance rises per length.
  double slope() const { return slope_; }

  /// Adds a point that has come as near, by the direction away from it.
  Rise add(const Vec3d& away) {
    for (std::size_t i = 0; i < count_; ++i) {
      if ((away - away_[i]).lengthSqr() < kSame * kSame) return Rise::Same;
      if (away.dot(away_[i]) > kBlunt) return Rise::Unclear;
    }
    away_[count_++] = away;
    // Two of them leave the others behind, or three; else the distance rises in no direction.
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = i + 1; k < count_; ++k)
        if (rises_between(away_[i], away_[k])) return keep({away_[i], away_[k], {}, {}}, 2);
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = i + 1; k < count_; ++k)
        for (std::size_t l = k + 1; l < count_; ++l)
          if (rises_between(away_[i], away_[k], away_[l])) return keep({away_[i], away_[k], away_[l], {}}, 3);
    return Rise::Top;
  }

  /// Adds a point that is as near at the start of the path. False unless the distance rises onward.
  bool is_risen_by(const Vec3d& away) {
    const Rise rise = add(away);
    return rise == Rise::Onward || rise == Rise::Same;
  }

 private:
  // Slope below which fronts have all but met. Not measured.
  static constexpr double kLeastSlope = 0.01;
  // Cosine between the normals on both sides of a ridge from which on it is Unclear. Not measured.
  static constexpr double kBlunt = 0.9;
  // Length by which normals of one plane differ whose corners have seven digits. Reasoned.
  static constexpr double kSame = 1e-4;
  // Differences of slopes that are rounding. Reasoned.
  static constexpr double kAlike = 1e-9;

  Rise keep(const std::array<Vec3d, 4>& away, std::size_t count) {
    away_ = away;
    count_ = count;
    return Rise::Onward;
  }
  /// Whether the distance from all of them rises along a vector no less than that from one of them.
  bool rises(const Vec3d& along, const Vec3d& one) {
    const double length = along.length();
    if (!(length > kAlike)) return false;
    direction_ = along / length;
    slope_ = direction_.dot(one);
    return slope_ > kLeastSlope &&
           std::all_of(away_.begin(), away_.begin() + static_cast<std::ptrdiff_t>(count_),
                       [&](const Vec3d& other) { return direction_.dot(other) >= slope_ - kAlike; });
  }
  bool rises_between(const Vec3d& a, const Vec3d& b) { return rises(a + b, a); }
  /// Whether the plane through the ends of three directions is nearest within their triangle, and the distance from all
  /// rises along that.
  bool rises_between(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d across = (b - a).cross(c - a);
    for (const Vec3d& opposite : {b.cross(c), c.cross(a), a.cross(b)})
      if (across.dot(opposite) < -kAlike) return false;
    return rises(across.dot(a) < 0 ? -across : across, a);
  }

  std::array<Vec3d, 4> away_;
  std::size_t count_ = 0;
  Vec3d direction_;
  double slope_;
};

}  // namespace detail

/// Follows the steepest ascent of the distance from x to where it is `target`, or rises no further (Lieutier, Any open
/// bounded subset of R^n has the same homotopy type as its medial axis, 2004: away from the point in the hull of the
/// closest ones that is nearest), if planes decide the distance all along: else no path is found. The exact distance is
/// compared with that of the planes at the corners, and wherever that shows that nothing lies in between.
template <class Query>
class RidgeFollower {
 public:
  /// \param tolerance by which distances may differ from those of planes, world units
  /// \param end_tolerance by which the distance at the end may differ from the target, world units
  RidgeFollower(const Query& query, double target, double tolerance, double end_tolerance)
      : query_(query), target_(target), tolerance_(tolerance), end_tolerance_(end_tolerance) {}

  /// The path from x, whose closest point is known. \pre x is not on the surface
  RidgePath operator()(const Vec3d& x, const Closest& closest) const {
    using Rise = detail::Ridge::Rise;
    VDB_OFFSET_ASSERT(closest.distance > 0);
    RidgePath path;
    path.end = closest;
    Vec3d from = x;
    detail::Ridge ridge((x - closest.point) / closest.distance);
    for (int turn = 0; turn < kMostTurns && path.count < RidgePath::kMostCorners; ++turn) {
      RidgeSegment segment = next_segment(from, path.end, ridge);
      if (segment.ends == Ends::AtTarget) settle(from, ridge, segment);
      if (segment.ends == Ends::Nowhere) break;
      from += ridge.direction() * segment.length;
      path.end = segment.end;
      if (segment.ends == Ends::Midway) continue;
      const Rise rise = segment.ends == Ends::AtOther ? ridge.add(segment.away_from_other) : Rise::Top;
      if (rise == Rise::Same) continue;
      if (rise == Rise::Unclear) break;
      path.found = rise == Rise::Top;
      if (segment.length > tolerance_ || path.found) path.corners[path.count++] = from;
      if (path.found) break;
    }
    return path;
  }

 private:
  // Segments of a path, some of which have no length: where several faces come as near at once. Not measured.
  static constexpr int kMostTurns = 16;

  /// Where a segment ends: Nowhere, if none was found; Midway, where it can only go on in the same direction; AtOther,
  /// where another face is as near; AtTarget, where the distance is the target.
  enum class Ends : std::uint8_t { Nowhere, Midway, AtOther, AtTarget };
  struct RidgeSegment {
    Ends ends = Ends::Nowhere;
    double length = 0;
    Closest end;
    double other_at = 0;  // a length at which the other face is nearest
    Vec3d away_from_other;
  };

  RidgeSegment next_segment(const Vec3d& from, const Closest& here, const detail::Ridge& ridge) const {
    constexpr int kMostParts = 16;  // tries of a length; not measured
    RidgeSegment segment{Ends::AtTarget, (target_ - here.distance) / ridge.slope(), {}, 0, Vec3d(0.0)};
    for (int part = 0; part < kMostParts; ++part) {
      const Vec3d end = from + ridge.direction() * segment.length;
      segment.end = query_(end, here.triangle);
      const double short_by = here.distance + ridge.slope() * segment.length - segment.end.distance;
      if (!(segment.end.distance > 0)) return {};
      if (std::abs(short_by) <= tolerance_) {
        const bool found =
            is_free(from, here, ridge, segment) && (segment.ends != Ends::AtOther || is_plane(from, ridge, segment));
        return found ? segment : RidgeSegment{};
      }
      segment.other_at = segment.length;
      segment.away_from_other = (end - segment.end.point) / segment.end.distance;
      const double gain = ridge.slope() - segment.away_from_other.dot(ridge.direction());
      if (short_by > 0 && short_by < gain * (segment.length + tolerance_)) {
        // Back to where both are as near, if the other face is a plane.
        segment.length = std::max(segment.length - short_by / gain, 0.0);
        segment.ends = Ends::AtOther;
      } else {  // the other face has been passed altogether
        segment.length /= 2;
        segment.ends = Ends::Midway;
      }
    }
    return {};
  }

  /// Moves the end of a segment to the target itself, where planes are not quite planes; or to a face that is in the
  /// way just there.
  void settle(const Vec3d& from, const detail::Ridge& ridge, RidgeSegment& segment) const {
    constexpr int kMostSteps = 5;  // Newton's steps; not measured
    double left = target_ - segment.end.distance;
    for (int i = 0; i < kMostSteps && std::abs(left) > end_tolerance_; ++i) {
      segment.length += left / ridge.slope();
      const Vec3d end = from + ridge.direction() * segment.length;
      segment.end = query_(end, segment.end.triangle);
      segment.away_from_other = (end - segment.end.point) / segment.end.distance;
      const double before = std::exchange(left, target_ - segment.end.distance);
      if (std::abs(left) > std::abs(before) / 2) break;
    }
    if (std::abs(left) > end_tolerance_) segment.ends = Ends::AtOther;
  }

  /// Whether the other face is a plane, as far as the distance shows: whether it is as near as a plane would be just
  /// beyond the segment's end, where it is the nearest.
  bool is_plane(const Vec3d& from, const detail::Ridge& ridge, RidgeSegment& segment) const {
    // Share of the length to where the other face was nearest; and tolerances that the distance may be off by, as
    // several faces may be about as near there. Not measured.
    constexpr double kBeyond = 0.1, kRougher = 4;
    const double beyond = kBeyond * (segment.other_at - segment.length);
    const Vec3d x = from + ridge.direction() * (segment.length + beyond);
    const Closest other = query_(x, segment.end.triangle);
    const double expected = segment.end.distance + segment.away_from_other.dot(ridge.direction()) * beyond;
    if (!(other.distance > 0)) return false;
    segment.away_from_other = (x - other.point) / other.distance;
    return std::abs(other.distance - expected) <= kRougher * tolerance_;
  }

  /// Whether nothing lies on a segment: covers it, from its end, with balls that hold nothing.
  bool is_free(const Vec3d& from, const Closest& here, const detail::Ridge& ridge, const RidgeSegment& segment) const {
    double at = segment.length - segment.end.distance;
    while (at > here.distance) {
      const double distance = query_(from + ridge.direction() * at, here.triangle).distance;
      if (std::abs(here.distance + ridge.slope() * at - distance) > tolerance_) return false;
      at -= distance;
    }
    return true;
  }

  const Query& query_;
  double target_, tolerance_, end_tolerance_;
};

}  // namespace vdb_offset
