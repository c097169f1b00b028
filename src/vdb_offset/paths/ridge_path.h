#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "vdb_offset/query/closest_query.h"

/// Where the distance rises fastest, of a Surface and of a Polyline alike, without a field: between plane faces that is
/// straight, on one of them, then along the ridge between two or three, and so known in a few steps of any length.
namespace vdb_offset {

/// A way's corners, the last where it ends, and what is closest there.
struct RidgePath {
  static constexpr std::size_t kMostCorners = 6;
  bool found = false;
  std::array<Vec3d, kMostCorners> corners;
  std::size_t count = 0;
  Closest end;
};

namespace detail {

/// Directions away from what is closest, all of them as near, and the way on which the distance rises fastest.
class Ridge {
 public:
  enum class Rise : std::uint8_t { Onward, Top, Unclear, Same };

  explicit Ridge(const Vec3d& away) : way_(away), slope_(1) { away_[count_++] = away; }

  const Vec3d& way() const { return way_; }
  /// How much the distance rises by length.
  double slope() const { return slope_; }

  /// Something else has come as near. Unclear between faces almost in a plane: on the many ridges of what stands for a
  /// curved surface, neighbours would lose their order.
  Rise add(const Vec3d& away) {
    for (std::size_t i = 0; i < count_; ++i) {
      if ((away - away_[i]).lengthSqr() < kSame * kSame) return Rise::Same;
      if (away.dot(away_[i]) > kBlunt) return Rise::Unclear;
    }
    away_[count_++] = away;
    // Two of them leave the others behind, or three; else there is no way up.
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = i + 1; k < count_; ++k)
        if (rises_between(away_[i], away_[k])) return keep({away_[i], away_[k], {}, {}}, 2);
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = i + 1; k < count_; ++k)
        for (std::size_t l = k + 1; l < count_; ++l)
          if (rises_between(away_[i], away_[k], away_[l])) return keep({away_[i], away_[k], away_[l], {}}, 3);
    return Rise::Top;
  }

  /// The same where all start. False unless the distance rises onward.
  bool is_risen_by(const Vec3d& away) {
    const Rise rise = add(away);
    return rise == Rise::Onward || rise == Rise::Same;
  }

 private:
  // Below this fronts have all but met.
  static constexpr double kLeastSlope = 0.01;
  // Cosine between the normals on both sides.
  static constexpr double kBlunt = 0.9;
  // By so little differ the normals of a plane whose corners have seven digits.
  static constexpr double kSame = 1e-4;
  static constexpr double kAlike = 1e-9;

  Rise keep(const std::array<Vec3d, 4>& away, std::size_t count) {
    away_ = away;
    count_ = count;
    return Rise::Onward;
  }
  /// Whether the distance from all rises that way no less than from one.
  bool rises(const Vec3d& way, const Vec3d& one) {
    const double length = way.length();
    if (!(length > kAlike)) return false;
    way_ = way / length;
    slope_ = way_.dot(one);
    return slope_ > kLeastSlope && std::all_of(away_.begin(), away_.begin() + static_cast<std::ptrdiff_t>(count_),
                                               [&](const Vec3d& other) { return way_.dot(other) >= slope_ - kAlike; });
  }
  bool rises_between(const Vec3d& a, const Vec3d& b) { return rises(a + b, a); }
  /// The plane through their ends is nearest within their triangle.
  bool rises_between(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d across = (b - a).cross(c - a);
    for (const Vec3d& opposite : {b.cross(c), c.cross(a), a.cross(b)})
      if (across.dot(opposite) < -kAlike) return false;
    return rises(across.dot(a) < 0 ? -across : across, a);
  }

  std::array<Vec3d, 4> away_;
  std::size_t count_ = 0;
  Vec3d way_;
  double slope_;
};

}  // namespace detail

/// The way of steepest ascent of the distance from x to where it is `target`, or rises no further (Lieutier, Any open
/// bounded subset of R^n has the same homotopy type as its medial axis, 2004: away from the point in the hull of the
/// closest ones that is nearest), if planes decide the distance all along: else none is found. The exact distance is as
/// predicted at the corners and wherever that shows that nothing lies in the way.
template <class Query>
class RidgeFollower {
 public:
  /// `tolerance` is what planes may be off by; the way ends at the target to `end_tolerance`.
  RidgeFollower(const Query& query, double target, double tolerance, double end_tolerance)
      : query_(query), target_(target), tolerance_(tolerance), end_tolerance_(end_tolerance) {}

  /// From x, what is closest to which is known, and not at x itself.
  RidgePath operator()(const Vec3d& x, const Closest& closest) const {
    using Rise = detail::Ridge::Rise;
    RidgePath way;
    way.end = closest;
    Vec3d from = x;
    detail::Ridge ridge((x - closest.point) / closest.distance);
    for (int turn = 0; turn < kMostTurns && way.count < RidgePath::kMostCorners; ++turn) {
      RidgeSegment leg = next_leg(from, way.end, ridge);
      if (leg.ends == Ends::AtTarget) settle(from, ridge, leg);
      if (leg.ends == Ends::Nowhere) break;
      from += ridge.way() * leg.length;
      way.end = leg.end;
      if (leg.ends == Ends::OnTheWay) continue;
      const Rise rise = leg.ends == Ends::AtOther ? ridge.add(leg.away_from_other) : Rise::Top;
      if (rise == Rise::Same) continue;
      if (rise == Rise::Unclear) break;
      way.found = rise == Rise::Top;
      if (leg.length > tolerance_ || way.found) way.corners[way.count++] = from;
      if (way.found) break;
    }
    return way;
  }

 private:
  // Where several things are as near at once, legs between have no length.
  static constexpr int kMostTurns = 16;

  /// AtOther: where something else is as near.
  enum class Ends : std::uint8_t { Nowhere, OnTheWay, AtOther, AtTarget };
  struct RidgeSegment {
    Ends ends = Ends::Nowhere;
    double length = 0;
    Closest end;
    double other_at = 0;  // a length where the other is nearest
    Vec3d away_from_other;
  };

  RidgeSegment next_leg(const Vec3d& from, const Closest& here, const detail::Ridge& ridge) const {
    constexpr int kMostParts = 16;
    RidgeSegment leg{Ends::AtTarget, (target_ - here.distance) / ridge.slope(), {}, 0, Vec3d(0.0)};
    for (int part = 0; part < kMostParts; ++part) {
      const Vec3d end = from + ridge.way() * leg.length;
      leg.end = query_(end, here.triangle);
      const double short_by = here.distance + ridge.slope() * leg.length - leg.end.distance;
      if (!(leg.end.distance > 0)) return {};
      if (std::abs(short_by) <= tolerance_) {
        const bool found = is_free(from, here, ridge, leg) && (leg.ends != Ends::AtOther || is_plane(from, ridge, leg));
        return found ? leg : RidgeSegment{};
      }
      leg.other_at = leg.length;
      leg.away_from_other = (end - leg.end.point) / leg.end.distance;
      const double gain = ridge.slope() - leg.away_from_other.dot(ridge.way());
      if (short_by > 0 && short_by < gain * (leg.length + tolerance_)) {
        // Back to where both are as near, were that other a plane.
        leg.length = std::max(leg.length - short_by / gain, 0.0);
        leg.ends = Ends::AtOther;
      } else {  // it has been passed altogether
        leg.length /= 2;
        leg.ends = Ends::OnTheWay;
      }
    }
    return {};
  }

  /// To the target itself, where planes are not quite what they should be; or to what is in the way just there.
  void settle(const Vec3d& from, const detail::Ridge& ridge, RidgeSegment& leg) const {
    constexpr int kMostSteps = 5;
    double left = target_ - leg.end.distance;
    for (int i = 0; i < kMostSteps && std::abs(left) > end_tolerance_; ++i) {
      leg.length += left / ridge.slope();
      const Vec3d end = from + ridge.way() * leg.length;
      leg.end = query_(end, leg.end.triangle);
      leg.away_from_other = (end - leg.end.point) / leg.end.distance;
      const double before = std::exchange(left, target_ - leg.end.distance);
      if (std::abs(left) > std::abs(before) / 2) break;
    }
    if (std::abs(left) > end_tolerance_) leg.ends = Ends::AtOther;
  }

  /// Whether the other is as near at the leg's end as it would be if it were a plane: just beyond, where it is nearest.
  bool is_plane(const Vec3d& from, const detail::Ridge& ridge, RidgeSegment& leg) const {
    constexpr double kBeyond = 0.1, kRougher = 4;  // where several others are about as near
    const double beyond = kBeyond * (leg.other_at - leg.length);
    const Vec3d x = from + ridge.way() * (leg.length + beyond);
    const Closest other = query_(x, leg.end.triangle);
    const double expected = leg.end.distance + leg.away_from_other.dot(ridge.way()) * beyond;
    if (!(other.distance > 0)) return false;
    leg.away_from_other = (x - other.point) / other.distance;
    return std::abs(other.distance - expected) <= kRougher * tolerance_;
  }

  /// Covers the leg, from its end, with balls that hold nothing.
  bool is_free(const Vec3d& from, const Closest& here, const detail::Ridge& ridge, const RidgeSegment& leg) const {
    double at = leg.length - leg.end.distance;
    while (at > here.distance) {
      const double distance = query_(from + ridge.way() * at, here.triangle).distance;
      if (std::abs(here.distance + ridge.slope() * at - distance) > tolerance_) return false;
      at -= distance;
    }
    return true;
  }

  const Query& query_;
  double target_, tolerance_, end_tolerance_;
};

}  // namespace vdb_offset
