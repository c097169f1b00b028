// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "motion/paths/propagate.h"
#include "space/surface/start_direction.h"

/// Paths along a vertex's normal, which need no field.
namespace vdb_offset {

// Share of the distance to which the end of a path is solved. Reasoned: far below the promised 1e-6, so that rounding
// to a file does not use that up.
inline constexpr double kStopTolerance = 1e-9;
// Least cosine between a vertex's start direction and its faces' normals with which a straight path is tried: below,
// the faces turn away so far that they say little. Not measured.
inline constexpr double kLeastStraightSlope = 0.2;

/// The end of a path that is known without the field: position, exact distance, and the closest triangle.
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
/// faces around the vertex decides phi up to there: then that line is a characteristic, or runs along the ridge that
/// those faces make. All are answered together, in rounds. Of a Surface, by its ClosestQuery, and of a Polyline, by its
/// CurveQuery, alike.
template <class Query>
class StraightPaths {
 public:
  /// Keeps references. Fastest for tries of vertices near each other, with those of one vertex and side next to each
  /// other. The bits of the ends depend on all of the tries together, as each answer is where the next search starts.
  StraightPaths(const Query& query, std::span<const StraightTry> tries) : query_(query), tries_(tries) {
    const auto& surface = query.surface();
    for (const StraightTry& one : tries) {
      const StartDirection start = start_of(surface, one.vertex);
      lines_.push_back({surface.vertices[one.vertex], start.direction * one.side, start.slope});
      hints_.push_back(surface.triangles_around(one.vertex).front());
    }
  }

  /// False if one of the tries has no end, as far as the faces around a vertex, and those next to them, show: most
  /// tries that have none show that soon.
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
  // Share by which a straight path may be longer than the faces around a vertex alone ask for. All 2,562 vertices of
  // scenes/bumpy_sphere.json at 2 % go straight with it.
  static constexpr double kStraightTolerance = 1e-3;
  // Rest of a straight path, in distances, when it has been followed back to the vertex. Reasoned: rounding.
  static constexpr double kNothingLeft = 1e-9;
  // Secant steps. Not measured.
  static constexpr int kMostRounds = 8;

  struct Line {
    Vec3d origin, normal;
    double slope;
  };
  /// A point on the line of a try, at the length t.
  struct LinePoint {
    std::size_t at;
    double t;
  };

  /// Whether phi is less than what the faces around the vertex alone would have at t.
  static bool is_too_near(double phi, double slope, double t) { return phi < slope * t * (1 - kStraightTolerance); }

  Vec3d point_of(const LinePoint& point) const { return lines_[point.at].origin + lines_[point.at].normal * point.t; }

  bool on_one_line(const LinePoint& a, const LinePoint& b) const {
    return tries_[a.at].vertex == tries_[b.at].vertex && tries_[a.at].side == tries_[b.at].side;
  }

  /// The closest triangles of some points; those of points on one line, next to each other, are found together.
  std::span<const Closest> ask(std::span<const LinePoint> points) {
    points_.clear();
    asked_hints_.clear();
    begin_.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      points_.push_back(point_of(points[i]));
      asked_hints_.push_back(hints_[points[i].at]);
      if (i == 0 || !on_one_line(points[i - 1], points[i])) begin_.push_back(i);
    }
    closest_.resize(points.size());
    const bool one_each = begin_.size() == points.size();
    begin_.push_back(points.size());
    if (one_each) query_.answer_together(points_, asked_hints_, closest_);
    else query_.answer_along_paths(points_, begin_, asked_hints_, closest_);
    for (std::size_t i = 0; i < points.size(); ++i) hints_[points[i].at] = closest_[i].triangle;
    return closest_;
  }

  /// Secants on phi along the lines, for as long as it rises as the faces around the vertex ask for.
  void find_ends(std::vector<std::optional<KnownEnd>>& ends) {
    std::vector<LinePoint> open, next;
    std::vector<std::pair<double, double>> before(tries_.size(), {0, 0});  // the last point, and phi there
    for (std::size_t i = 0; i < tries_.size(); ++i)
      if (lines_[i].slope >= kLeastStraightSlope) open.push_back({i, tries_[i].distance});
    for (int round = 0; round < kMostRounds && !open.empty(); ++round) {
      const std::span<const Closest> closest = ask(open);
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

  /// Takes back the ends of lines that something lies on: covers the lines, back to the vertices, with balls that hold
  /// no surface, where phi is what the faces around the vertex make it. A line of length d that ends at phi = d needs
  /// no balls: it lies in the one around its end.
  void leave_blocked_out(std::vector<std::optional<KnownEnd>>& ends) {
    std::vector<LinePoint> open, next;
    std::sort(reached_.begin(), reached_.end(), [](const LinePoint& a, const LinePoint& b) { return a.at < b.at; });
    for (auto [i, t] : reached_)
      if (t - tries_[i].distance > kNothingLeft * tries_[i].distance) open.push_back({i, t - tries_[i].distance});
    while (!open.empty()) {
      const std::span<const Closest> closest = ask(open);
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
  std::vector<LinePoint> reached_;    // where phi is the distance that was asked for
  // The points of a round, where to begin their searches, and the answers.
  std::vector<Vec3d> points_;
  std::vector<std::uint32_t> asked_hints_;
  std::vector<std::size_t> begin_;  // of each line
  std::vector<Closest> closest_;
};

}  // namespace vdb_offset
