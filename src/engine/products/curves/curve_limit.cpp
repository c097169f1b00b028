// SPDX-License-Identifier: Apache-2.0
// Makes an offset of curves valid: paths of its points go in, and come back with positions, distances and states.
// Points are first put in order along the front, and corners that this leaves alone go to the ends of their miters, but
// for those with a fault there. Runs of faulty and short points are then spread over the front, with windows twice as
// wide after each failure; a spread is undone if it has a fault. Whatever is still faulty goes back towards the source
// by a share in each round, in the end altogether. Pulled points come out again one after the other, by bisection, and
// none ends where it has a fault. Faults are judged on the very displacements that are handed back, rounded. No fault
// is left that pulling back can remove; what crosses in the source itself is not mended.
#include "products/curves/curve_limit.h"

#include "ground/system/progress_count.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/curves/restore_order.h"

namespace vdb_offset {
namespace {

// The most points to either side, as a multiple of a run of faulty points, that are spread along with it. Larger
// windows find room for more runs, and take as much longer. Not measured.
constexpr std::size_t kWidest = 16;
// The share of its displacement that a faulty point keeps in a round of pulling back. Not measured.
constexpr double kPull = 0.85;
// The number of rounds after which faulty points go all the way back: by then they have 0.15 % of their displacement
// left.
constexpr int kMostPulls = 40;
// The rounds of letting out, each of which halves what a point lacks: it ends within 0.1 % of its displacement of the
// farthest valid position between. Not measured.
constexpr int kCurveLetOuts = 10;
// The numbers of good points that are taken into a run between bad ones, tried one after the other: small windows
// first, then runs that block each other together. Not measured.
constexpr int kBridges[] = {0, 2, 8};

class CurveLimiter {
 public:
  CurveLimiter(const PlaneCurves& curves, Paths& paths, const ProgressCallback& callback, Spacing spacing)
      : curves_(curves),
        paths_(paths),
        spacing_(spacing),
        faults_(curves),
        displacement_(curves.source.size(), Vec2d(0.0)),
        share_(curves.source.size(), 1.0),
        progress_(callback, Stage::Limit, 4 * curves.source.size()) {
    points_.resize(curves.source.size());
    std::iota(points_.begin(), points_.end(), 0u);
    for (const auto p : points_) displacement_[p] = {paths.displacement[p][0], paths.displacement[p][1]};
  }

  LimitStatistics run() {
    statistics_.untanglings += put_in_order(curves_, paths_, displacement_, spacing_) > 0;
    move(points_);
    miter();
    statistics_.before = faults_.count();
    statistics_.source_crossings = faults_.source_crossings();
    statistics_.more_source_crossings = faults_.more_in_source();
    spread();
    pull();
    let_out();
    hand_back();
    statistics_.left = faults_.count();
    statistics_.crossings_near_source = faults_.crossings_near_source();
    return statistics_;
  }

 private:
  /// Moves points to where their displacements and shares lead.
  void move(const Indices& points) {
    std::vector<Vec2d> positions;
    positions.reserve(points.size());
    for (const auto p : points) {
      const Vec3d displacement = rounded_displacement(p);
      positions.push_back(curves_.source[p] + Vec2d(displacement[0], displacement[1]));
    }
    faults_.move(points, positions);
  }

  /// Moves the points at corners that have been left where their paths led to the ends of their miters, and those of
  /// them back that are at faults there.
  void miter() {
    std::vector<std::pair<std::uint32_t, Vec2d>> before;
    Indices moved;
    for (const Miter& miter : curves_.miters) {
      const std::uint32_t p = miter.vertex;
      const Vec3d& path = paths_.displacement[p];
      if (displacement_[p] != Vec2d(path[0], path[1])) continue;
      before.emplace_back(p, displacement_[p]);
      displacement_[p] = {miter.displacement[0], miter.displacement[1]};
      moved.push_back(p);
    }
    while (!moved.empty()) {
      move(moved);
      moved.clear();
      std::erase_if(before, [&](const auto& old) {
        if (!faults_.any_around({old.first})) return false;
        moved.push_back(old.first);
        displacement_[old.first] = old.second;
        return true;
      });
    }
  }

  /// Whether a point stands at the end of its miter.
  bool is_mitered(std::uint32_t p) const {
    const Miter* const miter = curves_.miter_of(p);
    return miter && share_[p] == 1 && displacement_[p] == Vec2d(miter->displacement[0], miter->displacement[1]);
  }

  /// Gives a point at the end of its miter the path that it had before: at a share of a miter that is longer than the
  /// distance it would be beyond that, and not mitered. Returns false if it is at the end of none.
  bool give_up_miter(std::uint32_t p) {
    const Vec3d& path = paths_.displacement[p];
    if (!is_mitered(p) || displacement_[p] == Vec2d(path[0], path[1])) return false;
    displacement_[p] = {path[0], path[1]};
    return true;
  }

  /// The displacement that a point will be handed back with. Faults are looked for at exactly that: where two curves
  /// share a part of the front, the last bit decides whether their segments meet.
  Vec3d rounded_displacement(std::uint32_t p) const {
    const double target = std::abs(curves_.distances[p]);
    const Vec2d displacement = displacement_[p] * share_[p];
    return target == 0 ? Vec3d(0.0) : round_displacement(Vec3d(displacement[0], displacement[1], 0), target);
  }

  /// The next point along the curve, or the one before; kNone at an end, and where curves branch.
  std::uint32_t step(std::uint32_t point, bool forward) const {
    const auto around = faults_.around(point);
    if (around.size() > 2) return kNone;
    for (const auto s : around)
      if (curves_.line().segments[s][!forward] == point) return curves_.line().segments[s][forward];
    return kNone;
  }

  /// Faulty and short points, in runs along the curves, with at most `bridge` other points in a row in between.
  std::vector<std::vector<std::uint32_t>> bad_runs(int bridge) const {
    std::vector<std::uint8_t> bad(points_.size(), 0), taken(points_.size(), 0);
    for (const auto p : faults_.faulty_points()) bad[p] = 1;
    for (const auto p : points_) bad[p] = bad[p] || faults_.is_short(p);
    std::vector<std::vector<std::uint32_t>> runs;
    for (const auto p : points_) {
      if (!bad[p] || taken[p]) continue;
      const std::uint32_t first = end_of_run(p, false, bridge, bad, p);
      const std::uint32_t last = end_of_run(first, true, bridge, bad, step(first, false));
      std::vector<std::uint32_t>& run = runs.emplace_back();
      for (std::uint32_t at = first;; at = step(at, true)) {
        run.push_back(at);
        taken[at] = 1;
        if (at == last) break;
      }
    }
    return runs;
  }
  /// The last bad point of a run, coming from one of its points, and ending before `stop`.
  std::uint32_t end_of_run(std::uint32_t from, bool forward, int bridge, const std::vector<std::uint8_t>& bad,
                           std::uint32_t stop) const {
    std::uint32_t last = from;
    int good = 0;
    for (std::uint32_t at = step(from, forward); at != kNone && at != stop && at != from && good <= bridge;
         at = step(at, forward)) {
      good = bad[at] ? 0 : good + 1;
      if (bad[at]) last = at;
    }
    return last;
  }

  /// A run with `more` points added on either side, or as many as there are.
  std::vector<std::uint32_t> widened(const std::vector<std::uint32_t>& run, std::size_t more) const {
    std::vector<std::uint32_t> before, points;
    for (std::uint32_t at = step(run.front(), false); at != kNone && at != run.back() && before.size() < more;
         at = step(at, false))
      before.push_back(at);
    points.assign(before.rbegin(), before.rend());
    points.insert(points.end(), run.begin(), run.end());
    const std::uint32_t stop = points.front();
    for (std::uint32_t at = step(run.back(), true);
         at != kNone && at != stop && points.size() < before.size() + run.size() + more; at = step(at, true))
      points.push_back(at);
    return points;
  }

  void spread() {
    for (const int bridge : kBridges) {
      if (!faults_.any() && bridge > 0) return;
      for (const auto& run : bad_runs(bridge)) {
        progress_.advance(run.size());
        // Spreading another run may have mended this one as well.
        if (std::none_of(run.begin(), run.end(),
                         [&](auto p) { return faults_.is_short(p) || faults_.any_around({p}); }))
          continue;
        for (std::size_t more = 1;; more *= 2) {
          const std::vector<std::uint32_t> points = widened(run, more);
          ++statistics_.untanglings;
          if (spread(points) || points.size() < run.size() + more) break;
          if (more > kWidest * run.size()) break;
        }
      }
    }
  }

  /// Puts the points between the first and the last on the front, with the spacing that they have on the source. Takes
  /// them back if they have a fault there, and returns false.
  bool spread(const std::vector<std::uint32_t>& window) {
    if (window.size() < 3) return false;
    std::vector<double> along{0.0};
    for (std::size_t i = 1; i < window.size(); ++i)
      along.push_back(along.back() + (curves_.source[window[i]] - curves_.source[window[i - 1]]).length());
    const Vec2d from = faults_.position(window.front()), to = faults_.position(window.back());
    const std::size_t count = window.size() - 2;
    std::vector<std::pair<std::uint32_t, Vec2d>> moves(count);
    std::atomic<bool> all = true;
    for_each_index(
        count,
        [&](std::size_t i) {
          if (!all) return;
          const std::uint32_t p = window[i + 1];
          const auto position = position_on_front(curves_, from + (to - from) * (along[i + 1] / along.back()), p);
          if (!position) all = false;
          else moves[i] = {p, *position - curves_.source[p]};
        },
        64);
    if (!all) return false;
    std::sort(moves.begin(), moves.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    Indices moved;
    for (auto& [p, displacement] : moves) {
      moved.push_back(p);
      std::swap(displacement_[p], displacement);
    }
    move(moved);
    if (!faults_.any_around(moved)) return true;
    for (const auto& [p, displacement] : moves) displacement_[p] = displacement;
    move(moved);
    return false;
  }

  void pull() {
    for (int round = 0; faults_.any() && round < kMostPulls; ++round) {
      progress_.advance(0);
      ++statistics_.rounds;
      const bool all_the_way = round + 1 == kMostPulls;
      const Indices faulty = faults_.faulty_points();
      for (const auto p : faulty) {
        if (all_the_way) share_[p] = 0;
        else if (!give_up_miter(p)) share_[p] *= kPull;
      }
      move(faulty);
    }
    // The faults that are left are between pulled points and others: those follow.
    while (faults_.any()) {
      Indices faulty = faults_.faulty_points();
      std::erase_if(faulty, [&](std::uint32_t p) { return share_[p] == 0; });
      if (faulty.empty()) return;
      for (const auto p : faulty) share_[p] = 0;
      move(faulty);
    }
  }

  /// Lets pulled points out again, one after the other, as far as they get no fault.
  void let_out() {
    if (faults_.any()) return;
    std::vector<double> most(share_.size(), 1.0);
    for (int i = 0; i < kCurveLetOuts; ++i) {
      bool any = false;
      progress_.advance(0);
      for (const auto p : points_) {
        if (!(share_[p] < most[p])) continue;
        const double before = share_[p];
        share_[p] = i == 0 ? most[p] : (before + most[p]) / 2;
        move({p});
        any = true;
        if (!faults_.any_around({p})) continue;
        most[p] = share_[p];
        share_[p] = before;
        move({p});
      }
      if (!any) return;
      ++statistics_.rounds;
    }
  }

  void hand_back() {
    double lost = 0;
    for (const auto p : points_) {
      const double target = std::abs(curves_.distances[p]), before = paths_.achieved[p];
      const bool pulled = share_[p] < 1;
      paths_.displacement[p] = rounded_displacement(p);
      paths_.achieved[p] = faults_.distance_of(p);
      if (target == 0) continue;
      const double error = std::abs(paths_.achieved[p] - target);
      if (is_mitered(p)) paths_.state[p] = curves_.miter_of(p)->state;
      else if (error <= kReachedTolerance * target + faults_.rounding(p)) paths_.state[p] = VertexState::Reached;
      else if (pulled || paths_.state[p] == VertexState::Reached) paths_.state[p] = VertexState::Limited;
      statistics_.limited_vertices += paths_.state[p] == VertexState::Limited;
      lost += std::max(0.0, before - paths_.achieved[p]) / target;
    }
    statistics_.thickness_lost = lost / static_cast<double>(std::max<std::size_t>(points_.size(), 1));
  }

  const PlaneCurves& curves_;
  Paths& paths_;
  Spacing spacing_;
  CurveFaults faults_;
  Indices points_;
  std::vector<Vec2d> displacement_;  // of each point, from its source
  std::vector<double> share_;        // of each point: the share of its displacement that it keeps
  LimitStatistics statistics_;
  Progress progress_;
};

}  // namespace

LimitStatistics limit_curves(const PlaneCurves& curves, Paths& paths, const ProgressCallback& progress,
                             Spacing spacing) {
  VDB_OFFSET_ASSERT(paths.displacement.size() == curves.source.size() && paths.state.size() == curves.source.size());
  return CurveLimiter(curves, paths, progress, spacing).run();
}

}  // namespace vdb_offset
