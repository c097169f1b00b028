// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "ground/system/assert.h"
#include "motion/paths/obstacle_guard.h"
#include "motion/paths/propagate.h"
#include "motion/paths/ridge_path.h"
#include "motion/paths/straight_path.h"
#include "space/query/cut_at_distance.h"
#include "space/surface/start_direction.h"

/// How one vertex finds its path: of a Surface, by its ClosestQuery, and of a Polyline, by its CurveQuery, alike.
namespace vdb_offset {

/// A distance, above 0, that a vertex is to stop at, and the set of distances that asks for it.
struct StopDistance {
  double distance;
  std::size_t set;
};

/// How distances are measured on a march. Exact: by the exact query. Fast: from the triangles around the last answer
/// alone. That is right except where another part of the surface comes near, which shows in the exact distance of the
/// path's end: it is less than the fast one.
enum class March { Exact, Fast };

/// The end of a path.
struct Arrival {
  Vec3d position;
  std::uint32_t triangle;      ///< One that is close to the position.
  bool outside_field = false;  ///< The path has left the field.
};

template <class Query>
using ShapeOf = std::remove_cvref_t<decltype(std::declval<const Query&>().surface())>;

/// The march of one vertex along its path.
template <class Query>
class VertexMarch {
 public:
  /// Keeps references. `side` is 1 outward, -1 inward.
  VertexMarch(const Query& query, const DirectionField& field, DirectionSampler& sampler, int side,
              std::uint32_t vertex, March march, const Obstacles* obstacles = nullptr)
      : query_(query),
        sampler_(sampler),
        surface_(query.surface()),
        side_(side),
        h_(field.voxel_size),
        sided_(surface_.facts.closed() && surface_.facts.oriented()),
        vertex_(vertex),
        origin_(surface_.vertices[vertex]),
        hint_(surface_.triangles_around(vertex).front()),
        march_(march) {
    const StartDirection start = start_of(surface_, vertex);
    normal_ = start.direction * side_;
    slope_ = start.slope;
    if (obstacles) guard_.emplace(*obstacles, origin_, side);
    if constexpr (std::is_same_v<ShapeOf<Query>, Surface>) over_ = surface_.over_border_beside_plane(vertex_);
  }

  /// The end of the path on which the distance rises fastest, at the distance `target` or where it rises no further, if
  /// planes decide the distance all along, or faces that are off planes by no more than `roughness` (world units).
  std::optional<KnownEnd> go_along_ridges(double target, double roughness) {
    target_ = target;
    const double tolerance = std::clamp(roughness, kStopTolerance * target, kRoughest * target);
    const auto first = leave_along_ridge(tolerance);
    if (!first) return std::nullopt;
    const RidgePath path = RidgeFollower<Query>(query_, target, tolerance, kStopTolerance * target)(
        first->x, {first->phi, first->triangle, first->feature, false, first->x - first->away});
    if (!path.found) return std::nullopt;
    if (trace_) {
      trace_->push_back(first->x - origin_);
      for (std::size_t i = 0; i + 1 < path.count; ++i) trace_->push_back(path.corners[i] - origin_);
    }
    return KnownEnd{path.corners[path.count - 1], path.end.distance, path.end.triangle};
  }

  /// Follows the direction field, and calls report(stop, arrival) for each stop distance. \pre `stops` rise
  template <class Report>
  void march(std::span<const StopDistance> stops, Report&& report) {
    // Stops before the first step are on the way to it, unless that ends at an obstacle.
    VDB_OFFSET_ASSERT(!stops.empty() && std::is_sorted(stops.begin(), stops.end(), [](const auto& a, const auto& b) {
      return a.distance < b.distance;
    }));
    target_ = (guard_ ? stops.front() : stops.back()).distance;
    const auto first = leave_surface(first_step());
    target_ = stops.front().distance;
    if (!first || (guard_ && guard_->stop(origin_, first->x) != first->x)) {
      for (const StopDistance& stop : stops) report(stop, Arrival{origin_, hint_});
      return;
    }
    march_on(*first, stops, report);
  }

  /// From now on the path's corners are noted down, after these.
  void keep_trace(std::vector<Vec3d> so_far) { trace_ = std::move(so_far); }
  /// Displacements to the path's corners, up to the end that was found last. \pre keep_trace() has been called
  const std::vector<Vec3d>& trace() const {
    VDB_OFFSET_ASSERT(trace_.has_value());
    return *trace_;
  }

  /// Marches to one stop distance from a position on the path, if the distance still rises there, so that no ridge has
  /// been passed, and nothing lies between it and the vertex; else reports no end. `triangle` is the closest to the
  /// position.
  template <class Report>
  void march_from(const Vec3d& position, std::uint32_t triangle, const StopDistance& stop, Report&& report) {
    target_ = stop.distance;
    hint_ = triangle;
    outside_ = false;
    const Sample first = measure(position);
    const double length = (position - origin_).length();
    if (!(length > 0)) return;
    const Vec3d direction = (position - origin_) / length;
    const double slope = least_cosine(surface_, vertex_, direction * side_);
    if (!(first.away.dot(direction) > kStillRising * first.phi) || slope < kLeastStraightSlope ||
        !is_line_free(direction, slope, length - first.phi, first_step()))
      return;
    hint_ = triangle;
    march_on(first, {&stop, 1}, report);
  }

 private:
  // Longest step, in voxels; and in distances, where the path is straight (cosine between its ends) on a finer grid.
  // Not measured.
  static constexpr double kStepVoxels = 0.75, kStepShare = 0.125, kStraightCourse = 0.9995;
  // A path may run this far, in distances, without getting farther away before it counts as stopped. Not measured.
  static constexpr double kPatience = 0.5;
  // Steps of a path. Reasoned: more than any path needs that gets farther away.
  static constexpr int kMaxSteps = 400;
  // Longest fast step, in distances from the surface: it may cross other surface, which the end shows. With fast steps
  // propagation takes two thirds of the time.
  static constexpr double kFastShare = 3;
  // Shortest step, in voxels or distances, unless the surface is nearer. Not measured.
  static constexpr double kLeastStep = 0.1;
  // A path on which the distance grows by less than this share of a step gets no farther away. Not measured.
  static constexpr double kSlowest = 0.01;
  // How much the distance must rise, per length, at a position to march on from. Not measured.
  static constexpr double kStillRising = 0.5;
  // How far from planes faces may be to count as planes, in distances. Not measured.
  static constexpr double kRoughest = 1e-4;
  // Golden-section steps to a ridge. Reasoned: each narrows the interval by 0.62; this many leave a thousandth of it.
  static constexpr int kRidgeSteps = 14;
  // Length below which the interpolated gradient is the rest of opposite ones, and says nothing. Not measured.
  static constexpr double kLeastGradient = 1e-3;

  // Agreement of gradient and vertex normal near the surface (cosine-like), from which on some of the gradient is used,
  // and all of it. Reasoned: gradients leak across walls thinner than a voxel.
  static constexpr double kLeaked = 0.0, kTrusted = 0.2;
  // How near to the surface, in voxels, that agreement matters. Farther out the two may well differ, at a medial axis
  // for one.
  static constexpr double kLeakVoxels = 0.3;

  /// The largest distance on a path, the steps before and after it, and how the path has gone on since.
  struct PathMaximum {
    Sample before, at, after;
    std::size_t corners;      ///< Of the path up to there.
    double since_growth = 0;  ///< Length of the path since the distance last grew by more than kSlowest.

    /// Takes a step from `from` to `to` into account, to which the path has so many corners.
    void add_step(const Sample& from, const Sample& to, double length, std::size_t corners_before) {
      since_growth += length;
      if (at.x == from.x) after = to;
      if (!(to.phi > at.phi)) return;
      if (to.phi - at.phi > kSlowest * length) since_growth = 0;
      before = from;
      at = after = to;
      corners = corners_before;
    }
  };

  /// Steps along the direction field until all stops are met: where the distance is a stop's, at an obstacle, or, when
  /// the distance has not risen for kPatience, at its maximum on the path (climb()).
  template <class Report>
  void march_on(const Sample& first, std::span<const StopDistance> stops, Report&& report) {
    const double last = stops.back().distance;
    Sample before{origin_, 0, Vec3d(0.0), hint_, Feature::Face}, here = first;
    PathMaximum largest{before, here, here, corner_count()};
    for (int i = 0;; ++i) {
      while (!stops.empty() && (here.phi >= target_ || arrived(here.phi)))
        report_first_of(stops, arrived(here.phi) ? here : cut(before, here), report);
      if (stops.empty()) return;
      if (i == kMaxSteps || !(largest.since_growth < kPatience * last)) break;
      if (trace_) trace_->push_back(here.x - origin_);
      Step step = step_from(here, longest_step(here.phi, last));
      if (step.length > here.phi && is_behind(step.end)) step = step_from(here, kFreeShare * here.phi);
      report_stops_before(step.end.x, here, stops, report);
      if (stops.empty()) return;
      largest.add_step(here, step.end, step.length, corner_count());
      before = here;
      here = step.end;
      hint_ = here.triangle;
      if (step.blocked) return report_blocked(before, here, stops, report);
    }
    const Sample end = climb(largest);
    if (trace_) trace_->resize(largest.corners);
    for (const StopDistance& stop : stops) report_at(end, stop, report);
  }

  struct Step {
    double length;
    bool blocked;  // it ends at an obstacle
    Sample end;
  };
  /// A step along the direction field, of the length or, where the path bends, less.
  Step step_from(const Sample& here, double length) {
    const Vec3d ahead = runge_kutta(here, length), to = guard_ ? guard_->stop(here.x, ahead) : ahead;
    hint_ = here.triangle;
    const Sample end = measure(to);
    hint_ = here.triangle;
    return {length, to != ahead, end};
  }

  std::size_t corner_count() const { return trace_ ? trace_->size() : 0; }

  /// Of a step from where the distance is phi: not far beyond the last stop, where the last step is cut; not much less
  /// than a voxel, for a slow climb.
  double longest_step(double phi, double last) const {
    return std::min({(march_ == March::Fast ? kFastShare : kFreeShare) * phi,
                     std::max(kStepVoxels * h_, kStepShare * last),
                     std::max(last - phi, kLeastStep * std::min(h_, last))});
  }

  /// Reports the end at the first of the stops, and goes on to the next one, if there is any.
  template <class Report>
  void report_first_of(std::span<const StopDistance>& stops, const Sample& end, Report&& report) {
    report_at(end, stops.front(), report);
    stops = stops.subspan(1);
    if (!stops.empty()) target_ = stops.front().distance;
  }

  /// Reports each stop distance crossed by this step, using the closest triangles of its ends.
  template <class Report>
  void report_stops_before(const Vec3d& end, const Sample& from, std::span<const StopDistance>& stops,
                           Report&& report) {
    for (auto at = stop_before(end, from); at; at = stop_before(end, *at)) {
      report_first_of(stops, *at, report);
      if (stops.empty()) return;
    }
  }

  /// The point of a step at which the distance is the target, if the closest triangles show that there is one before
  /// the step's end. `at`, the step's start, is short of the target.
  std::optional<Sample> stop_before(const Vec3d& end, Sample at) {
    constexpr int kMostSteps = 4;
    for (int i = 0; i < kMostSteps; ++i) {
      const Vec3d rest = end - at.x;
      const auto share = share_to_distance(surface_, at, rest, target_);
      if (!share || !(*share < 1)) return std::nullopt;
      const Sample next = measure(at.x + rest * *share);
      if (arrived(next.phi)) return next;
      if (next.phi > target_) return cut(at, next);
      at = next;
    }
    return std::nullopt;
  }

  template <class Report>
  void report_at(const Sample& end, const StopDistance& stop, Report&& report) const {
    report(stop, Arrival{end.x, end.triangle, outside_});
  }

  /// Tells of a path that an obstacle ends at `end`; some stops may lie before that.
  template <class Report>
  void report_blocked(const Sample& before, const Sample& end, std::span<const StopDistance> stops, Report&& report) {
    for (const StopDistance& stop : stops) {
      target_ = stop.distance;
      report_at(end.phi > target_ ? cut(before, end) : end, stop, report);
    }
  }

  Sample measure(const Vec3d& x) {
    if (march_ == March::Exact) {
      const Closest closest = query_(x, hint_);
      hint_ = closest.triangle;
      return sample_at(x, closest);
    }
    const TrianglePoint nearest = query_.near(x, hint_);
    return sample_at(x, hint_, nearest);
  }
  double first_step() const { return 0.1 * std::min(target_, h_); }
  /// Whether the closest face turns its other side to a point: a step longer than the distance has crossed it.
  bool is_behind(const Sample& at) const {
    return surface_.facts.oriented() && side_ * surface_.pseudonormal(at.triangle, at.feature).dot(at.away) < 0;
  }
  bool arrived(double phi) const { return std::abs(phi - target_) <= kStopTolerance * target_; }

  /// Whether nothing lies on a line from the vertex, between the lengths `from` and `to` < `from`: covers it with balls
  /// that hold no surface, where phi is no less than the faces around the vertex make it, `slope` being the least
  /// cosine between the line and their normals. A line of length d that ends at phi = d needs no balls: it lies in the
  /// one around its end.
  bool is_line_free(const Vec3d& direction, double slope, double from, double to) {
    while (from > to) {
      const Closest closest = query_(origin_ + direction * from, hint_);
      const double phi = closest.distance;
      hint_ = closest.triangle;
      if (phi < kFreeShare * slope * from) return false;
      from -= phi * (1 - 1e-12);
    }
    return true;
  }

  /// The first point off the surface, on the side asked for, along the start direction.
  std::optional<Sample> leave_surface(double longest) {
    // Steps from the longest to a share of the distance, each a part of the one before; the least slope that a step is
    // judged by. Not measured.
    constexpr double kShortest = 1e-7, kPart = 0.25, kLeastSlope = 0.02;
    for (double step = longest; step > kShortest * target_; step *= kPart) {
      const Sample sample = measure(origin_ + normal_ * step);
      const bool free = sample.phi > kFreeShare * std::max(slope_, kLeastSlope) * step;
      const bool right = !sided_ || side_ * surface_.pseudonormal(sample.triangle, sample.feature).dot(sample.away) > 0;
      if (free && right) return sample;
    }
    return std::nullopt;
  }

  /// The first point off the surface where the distance rises fastest, if the faces around the vertex show that; else
  /// along the start direction.
  std::optional<Sample> leave_along_ridge(double tolerance) {
    // Steps in distances, and how many tolerances a step is at least. Not measured.
    constexpr double kStep = 1e-3, kShortStep = 1e-5, kClear = 30;
    std::optional<detail::Ridge> ridge;
    bool clear = true;
    for (const auto t : surface_.triangles_around(vertex_)) {
      const Vec3d away = surface_.triangle_normals[t] * side_;
      if (away.lengthSqr() == 0) continue;
      if (!ridge) ridge.emplace(away);
      else clear = clear && ridge->is_risen_by(away);
    }
    if (ridge && clear) {
      const double step = std::max(kStep * target_, kClear * tolerance / ridge->slope());
      const Sample sample = measure(origin_ + ridge->direction() * step);
      if (std::abs(sample.phi - ridge->slope() * step) <= tolerance) return sample;
    }
    return leave_surface(std::max(kShortStep * target_, kClear * tolerance));
  }

  /// Unit velocity at x, a point whose distance to the surface is about phi: the smooth gradient, or `fallback`
  /// where there is none or where it vanishes. Just off the surface, a gradient that does not agree with the
  /// vertex normal has leaked through a wall thinner than its stencil, and gives way to that normal.
  Vec3d velocity(const Vec3d& x, double phi, const Vec3d& fallback) {
    Vec3d gradient;
    if (!sampler_(x, side_, phi, gradient)) {
      outside_ = true;
      return fallback;
    }
    gradient *= side_;
    const double away = phi / (kLeakVoxels * h_);
    if (away < 1) {
      const double trust = std::clamp((gradient.dot(normal_) - kLeaked) / (kTrusted - kLeaked), 0.0, 1.0),
                   agreement = trust * trust * (3 - 2 * trust);
      gradient += normal_ * ((1 - agreement) * (1 - std::max(away, 0.0)));
    }
    return gradient.lengthSqr() > kLeastGradient * kLeastGradient ? gradient.unit() : fallback;
  }

  /// The velocity that a vertex follows. Beyond a border phi is the distance to that, and its gradient leans out: a
  /// vertex of a border stays in the plane across it, so that the offset's border is the source's; one at a corner,
  /// which a plane holds, across the border beside that plane as well.
  Vec3d course(const Vec3d& x, double phi, const Vec3d& fallback) {
    const Vec3d v = velocity(x, phi, fallback);
    if (surface_.conormals.empty()) return v;
    Vec3d along = surface_.along_border(vertex_, v);
    along -= over_ * over_.dot(along);
    return along.lengthSqr() > kLeastGradient * kLeastGradient ? along.unit() : normal_;
  }

  /// The end of a step by RK4. Shortens a step of more than a voxel on which the path bends.
  Vec3d runge_kutta(const Sample& from, double& step) {
    const Vec3d away = from.phi > 0 ? from.away / from.phi : normal_,
                fallback = surface_.is_held(vertex_) ? surface_.along_border(vertex_, away) : away;
    const Vec3d k1 = course(from.x, from.phi, fallback);
    while (true) {
      const auto bends = [&](const Vec3d& k) { return step > kStepVoxels * h_ && k1.dot(k) < kStraightCourse; };
      const Vec3d k2 = course(from.x + k1 * (step / 2), from.phi + step / 2, k1);
      if (!bends(k2)) {
        const Vec3d k3 = course(from.x + k2 * (step / 2), from.phi + step / 2, k2),
                    k4 = course(from.x + k3 * step, from.phi + step, k3);
        const Vec3d v = (k1 + k2 * 2.0 + k3 * 2.0 + k4) / 6.0;
        if (!bends(k4)) return from.x + (v.lengthSqr() > kLeastGradient * kLeastGradient ? v : fallback) * step;
      }
      step = std::max(step / 4, kStepVoxels * h_);
    }
  }

  Sample cut(const Sample& near, const Sample& far) {
    return cut_at_distance(
        surface_, near, far, target_, [&](const Vec3d& x) { return measure(x); },
        [&](const Sample& at) { return arrived(at.phi); });
  }

  /// The ridge between the steps around the largest distance seen, by golden section: near it the distance rises to
  /// one side and falls to the other. A point beyond the largest distance only if that is no nearer.
  Sample climb(const PathMaximum& largest) {
    const auto on_path = [&](double t) {  // -1 .. 0 .. 1 from before through at to after
      return t < 0 ? largest.at.x + (largest.before.x - largest.at.x) * -t
                   : largest.at.x + (largest.after.x - largest.at.x) * t;
    };
    constexpr double kGolden = 0.6180339887498949;
    double low = -1, high = 1, a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    Sample at_a = measure(on_path(a)), at_b = measure(on_path(b)), best = largest.at;
    for (int i = 0; i < kRidgeSteps; ++i) {
      if (at_a.phi > at_b.phi) {
        high = b;
        b = a;
        at_b = at_a;
        a = high - kGolden * (high - low);
        at_a = measure(on_path(a));
      } else {
        low = a;
        a = b;
        at_a = at_b;
        b = low + kGolden * (high - low);
        at_b = measure(on_path(b));
      }
      for (const Sample& sample : {at_a, at_b})
        if (sample.phi > best.phi && sample.phi <= target_ * (1 + kStopTolerance)) best = sample;
    }
    return best;
  }

  const Query& query_;
  DirectionSampler& sampler_;
  const ShapeOf<Query>& surface_;
  int side_;
  double target_ = 0, h_;
  bool sided_;
  std::uint32_t vertex_;
  Vec3d origin_, normal_;  // of the vertex: position and start direction, to the side asked for
  Vec3d over_{0.0};        // leads over the border beside the plane that holds the vertex; else 0
  double slope_;
  std::uint32_t hint_;
  March march_;
  bool outside_ = false;
  std::optional<ObstacleGuard> guard_;  // if there are obstacles
  std::optional<std::vector<Vec3d>> trace_;
};

}  // namespace vdb_offset
