#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/surface/start_direction.h"

/// Ways along a vertex's normal, which need no field.
namespace vdb_offset {

// A stop is solved far below the promised 1e-6, so that rounding on the way to a file does not use it up.
inline constexpr double kStopTolerance = 1e-9;
// Below this the faces around a vertex turn away from its normal so far that a straight path says little.
inline constexpr double kLeastStraightSlope = 0.2;

/// Where a way ends that is known without the field: place, exact distance, and the closest triangle.
struct KnownEnd {
  Vec3d position;
  double distance;
  std::uint32_t triangle;
};

/// A vertex that may go straight to a distance, above 0, on one side: 1 outward, -1 inward.
struct StraightTry {
  std::uint32_t vertex;
  int side;
  double distance;
};

/// Finds for each of some tries the point at its distance on the line along the vertex's normal, if nothing but the
/// faces around the vertex decides phi on the way there: then that line is a characteristic, or runs along the ridge
/// that those faces make. All are answered together, in rounds. Of a Surface, by its ClosestQuery, and of a Polyline,
/// by its CurveQuery, alike.
template <class Query>
class StraightPaths {
 public:
  /// Tries are best of vertices near each other, with those of one vertex and side next to each other. The ends depend
  /// only on the tries together.
  StraightPaths(const Query& query, std::span<const StraightTry> tries) : query_(query), tries_(tries) {
    const auto& surface = query.surface();
    for (const StraightTry& one : tries) {
      const StartDirection start = start_of(surface, one.vertex);
      lines_.push_back({surface.vertices[one.vertex], start.direction * one.side, start.slope});
      hints_.push_back(surface.triangles_around(one.vertex).front());
    }
  }

  /// False if one of the tries has no end, for what the faces next to one another tell of the distance there: most of
  /// those that have none show that soon.
  bool may_all_end() const {
    for (std::size_t i = 0; i < tries_.size(); ++i) {
      const double t = tries_[i].distance, slope = lines_[i].slope;
      std::uint32_t triangle = hints_[i];
      if (slope < kLeastStraightSlope ||
          is_too_near(std::sqrt(query_.near(point_of({i, t}), triangle).squared_distance), slope, t))
        return false;
    }
    return true;
  }

  /// The ends, in the order of the tries.
  std::vector<std::optional<KnownEnd>> operator()() {
    std::vector<std::optional<KnownEnd>> ends(tries_.size());
    find_ends(ends);
    leave_blocked_out(ends);
    return ends;
  }

 private:
  // How much longer than the faces around a vertex alone ask for a straight path may be.
  static constexpr double kStraightTolerance = 1e-3;
  // What remains of a straight way, in distances, when it has been followed back to the vertex.
  static constexpr double kNothingLeft = 1e-9;
  static constexpr int kMostRounds = 8;

  struct Line {
    Vec3d origin, normal;
    double slope;
  };
  /// A place on the line of a try.
  struct Place {
    std::size_t at;
    double t;
  };

  /// Whether phi is less than what the faces around the vertex alone would have at t.
  static bool is_too_near(double phi, double slope, double t) { return phi < slope * t * (1 - kStraightTolerance); }

  Vec3d point_of(const Place& place) const { return lines_[place.at].origin + lines_[place.at].normal * place.t; }

  bool on_one_line(const Place& a, const Place& b) const {
    return tries_[a.at].vertex == tries_[b.at].vertex && tries_[a.at].side == tries_[b.at].side;
  }

  /// What is closest to some places; those on one line that stand next to each other are looked for together.
  std::span<const Closest> look(std::span<const Place> places) {
    points_.clear();
    asked_hints_.clear();
    begin_.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
      points_.push_back(point_of(places[i]));
      asked_hints_.push_back(hints_[places[i].at]);
      if (i == 0 || !on_one_line(places[i - 1], places[i])) begin_.push_back(i);
    }
    closest_.resize(places.size());
    const bool one_each = begin_.size() == places.size();
    begin_.push_back(places.size());
    if (one_each) query_.answer_together(points_, asked_hints_, closest_);
    else query_.answer_along_ways(points_, begin_, asked_hints_, closest_);
    for (std::size_t i = 0; i < places.size(); ++i) hints_[places[i].at] = closest_[i].triangle;
    return closest_;
  }

  /// Secants on phi along the lines, for as long as it rises as the faces around the vertex ask for.
  void find_ends(std::vector<std::optional<KnownEnd>>& ends) {
    std::vector<Place> open, next;
    std::vector<std::pair<double, double>> before(tries_.size(), {0, 0});  // the last place, and phi there
    for (std::size_t i = 0; i < tries_.size(); ++i)
      if (lines_[i].slope >= kLeastStraightSlope) open.push_back({i, tries_[i].distance});
    for (int round = 0; round < kMostRounds && !open.empty(); ++round) {
      const std::span<const Closest> closest = look(open);
      next.clear();
      for (std::size_t k = 0; k < open.size(); ++k) {
        const auto [i, t] = open[k];
        const double phi = closest[k].distance, target = tries_[i].distance, slope = lines_[i].slope;
        if (std::abs(phi - target) <= kStopTolerance * target) {
          ends[i] = KnownEnd{point_of(open[k]), phi, closest[k].triangle};
          reached_.push_back(open[k]);
          continue;
        }
        auto& [last, last_phi] = before[i];
        if (is_too_near(phi, slope, t) || phi <= last_phi) continue;
        const double further = t + (target - phi) * (t - last) / (phi - last_phi);
        if (!(further > last) || further > target / slope * (1 + kStraightTolerance)) continue;
        last = t;
        last_phi = phi;
        next.push_back({i, further});
      }
      open.swap(next);
    }
  }

  /// Covers the lines back to the vertices with balls that hold no surface, where phi is what the faces around the
  /// vertex give it. A line of length d that ends at phi = d needs none: it lies in the ball around its end.
  void leave_blocked_out(std::vector<std::optional<KnownEnd>>& ends) {
    std::vector<Place> open, next;
    std::sort(reached_.begin(), reached_.end(), [](const Place& a, const Place& b) { return a.at < b.at; });
    for (auto [i, t] : reached_)
      if (t - tries_[i].distance > kNothingLeft * tries_[i].distance) open.push_back({i, t - tries_[i].distance});
    while (!open.empty()) {
      const std::span<const Closest> closest = look(open);
      next.clear();
      for (std::size_t k = 0; k < open.size(); ++k) {
        auto [i, t] = open[k];
        const double phi = closest[k].distance;
        if (phi < kFreeShare * lines_[i].slope * t) {
          ends[i].reset();
          continue;
        }
        t -= phi * (1 - 1e-12);
        if (t > kNothingLeft * tries_[i].distance) next.push_back({i, t});
      }
      open.swap(next);
    }
  }

  const Query& query_;
  std::span<const StraightTry> tries_;
  std::vector<Line> lines_;           // of each try
  std::vector<std::uint32_t> hints_;  // likewise, triangles that were closest last
  std::vector<Place> reached_;        // where phi is the distance that was asked for
  // What is asked in a round.
  std::vector<Vec3d> points_;
  std::vector<std::uint32_t> asked_hints_;
  std::vector<std::size_t> begin_;  // of each line
  std::vector<Closest> closest_;
};

}  // namespace vdb_offset
