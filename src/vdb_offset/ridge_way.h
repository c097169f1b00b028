#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "vdb_offset/closest.h"

/// Where the distance rises fastest, of a Surface and of a Polyline alike, without a field: between plane faces that is
/// straight, on one of them, then along the ridge between two or three, and so known in a few steps of any length.
namespace vdb_offset {

/// The corners of a way, the last at the distance asked for, and what is closest there.
struct RidgeWay {
  static constexpr std::size_t kMostLegs = 4;
  std::array<Vec3d, kMostLegs> corners;
  std::size_t count = 0;
  Closest end;
};

namespace detail {

/// Directions away from what is closest, all of them on one ridge, and the way along it.
class Ridge {
 public:
  explicit Ridge(const Vec3d& away) : way_(away), slope_(1) { away_[count_++] = away; }

  const Vec3d& way() const { return way_; }
  /// How much the distance rises by length.
  double slope() const { return slope_; }

  /// Something else has come as near. False if the distance rises no further, or along no line; and between faces
  /// almost in a plane: on the many ridges of what stands for a curved surface, neighbours would lose their order.
  bool add(const Vec3d& away) {
    if (count_ == away_.size()) return false;
    for (std::size_t i = 0; i < count_; ++i)
      if (away.dot(away_[i]) > kBlunt) return false;
    away_[count_++] = away;
    // Two leave the others behind, or all three rise alike.
    for (std::size_t i = 0; i < count_; ++i)
      for (std::size_t k = i + 1; k < count_; ++k)
        if (rises_between(away_[i], away_[k])) {
          away_ = {away_[i], away_[k], {}};
          count_ = 2;
          return true;
        }
    return count_ == 3 && rises_between_all();
  }

 private:
  // Below this fronts all but meet.
  static constexpr double kLeastSlope = 0.05;
  // Cosine between the normals on both sides.
  static constexpr double kBlunt = 0.9;
  static constexpr double kAlike = 1e-9;

  bool set_way(const Vec3d& way, const Vec3d& away) {
    const double length = way.length();
    if (!(length > kAlike)) return false;
    way_ = way / length;
    slope_ = way_.dot(away);
    return slope_ > kLeastSlope;
  }
  bool rises_between(const Vec3d& a, const Vec3d& b) {
    if (!set_way(a + b, a)) return false;
    return std::all_of(away_.begin(), away_.begin() + static_cast<std::ptrdiff_t>(count_),
                       [&](const Vec3d& c) { return way_.dot(c) >= slope_ - kAlike; });
  }
  bool rises_between_all() {
    const auto& [a, b, c] = away_;
    const Vec3d across = (b - a).cross(c - a);
    return set_way(across.dot(a) < 0 ? -across : across, a);
  }

  std::array<Vec3d, 3> away_;
  std::size_t count_ = 0;
  Vec3d way_;
  double slope_;
};

}  // namespace detail

/// The way of steepest ascent of the distance from x to where it is `target` (Lieutier, Any open bounded subset of R^n
/// has the same homotopy type as its medial axis, 2004: away from the point in the hull of the closest ones that is
/// nearest), if planes decide the distance all along: else there are no corners. The exact distance is as predicted at
/// the corners and wherever that shows that nothing lies in the way.
template <class Query>
class RidgeFollower {
 public:
  RidgeFollower(const Query& query, double target, double tolerance)
      : query_(query), target_(target), tolerance_(tolerance) {}

  /// From x, what is closest to which is known, and not at x itself.
  RidgeWay operator()(const Vec3d& x, Closest here) const {
    RidgeWay way;
    Vec3d from = x;
    detail::Ridge ridge((x - here.point) / here.distance);
    for (int turn = 0; turn < kMostTurns && way.count < RidgeWay::kMostLegs; ++turn) {
      const Leg leg = next_leg(from, here, ridge);
      if (leg.ends == Ends::Nowhere) return {};
      from += ridge.way() * leg.length;
      way.end = here = leg.end;
      if (leg.ends == Ends::OnTheWay) continue;
      if (leg.length > tolerance_) way.corners[way.count++] = from;
      if (leg.ends == Ends::AtTarget) return way;
      if (!ridge.add(leg.away_from_other)) return {};
    }
    return {};
  }

 private:
  // Where several things are as near at once, legs between have no length.
  static constexpr int kMostTurns = 16;

  /// AtOther: where something else is as near.
  enum class Ends : std::uint8_t { Nowhere, OnTheWay, AtOther, AtTarget };
  struct Leg {
    Ends ends = Ends::Nowhere;
    double length = 0;
    Closest end;
    Vec3d away_from_other;
  };

  Leg next_leg(const Vec3d& from, const Closest& here, const detail::Ridge& ridge) const {
    constexpr int kMostParts = 16;
    Leg leg{Ends::AtTarget, (target_ - here.distance) / ridge.slope(), {}, Vec3d(0.0)};
    for (int part = 0; part < kMostParts; ++part) {
      const Vec3d end = from + ridge.way() * leg.length;
      leg.end = query_(end, here.triangle);
      const double short_by = here.distance + ridge.slope() * leg.length - leg.end.distance;
      if (!(leg.end.distance > 0)) return {};
      if (std::abs(short_by) <= tolerance_) return is_free(from, here, ridge, leg) ? leg : Leg{};
      leg.away_from_other = (end - leg.end.point) / leg.end.distance;
      const double rise = leg.away_from_other.dot(ridge.way()), back = short_by / (ridge.slope() - rise);
      if (short_by > 0 && rise < ridge.slope() && back < leg.length + tolerance_) {
        // As far as both are as near, were that other a plane.
        leg.length = std::max(leg.length - back, 0.0);
        leg.ends = Ends::AtOther;
      } else {  // it has been passed altogether
        leg.length /= 2;
        leg.ends = Ends::OnTheWay;
      }
    }
    return {};
  }

  /// Covers the leg, from its end, with balls that hold nothing.
  bool is_free(const Vec3d& from, const Closest& here, const detail::Ridge& ridge, const Leg& leg) const {
    double at = leg.length - leg.end.distance;
    while (at > here.distance) {
      const double distance = query_(from + ridge.way() * at, here.triangle).distance;
      if (std::abs(here.distance + ridge.slope() * at - distance) > tolerance_) return false;
      at -= distance;
    }
    return true;
  }

  const Query& query_;
  double target_, tolerance_;
};

}  // namespace vdb_offset
