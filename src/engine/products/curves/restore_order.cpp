// SPDX-License-Identifier: Apache-2.0
// Puts points of an offset of curves back in the order of their curve, by isotonic regression. The points that have
// arrived are sorted by where their closest points lie along the source, and around one corner by their direction: that
// is the front as a line of points. A closed curve is cut open at the point that has strayed least along it. Pooling
// adjacent violators finds the lengths along the front that keep the order and a least spacing, and move points least
// in the sense of least squares. Only points of blocks of several move, each by projection onto its exact distance; one
// that finds no position there stays. No fault is looked for here, and some may be left. Curves are handled one by one,
// and blocks of one curve share nothing, so that the result does not depend on the number of threads.
#include "products/curves/restore_order.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// The most steps of projecting a point onto the front. On straight parts of the source one is exact; steps that switch
// between two of its parts end there. Not measured.
constexpr int kProjections = 8;
// The error of a projected point, as a share of kReachedTolerance, at which projecting ends: far below what counts as
// reached, since rounding adds to it.
constexpr double kProjectionTolerance = 1e-3;
// The least spacing of points that are put in order, as a share of their spacing on the source. Larger shares leave the
// front without room for many points, smaller ones make slivers of cells. Not measured.
constexpr double kLeastSpacing = 0.2;

/// A range of segments that follow each other, from end to end or all around.
struct Chain {
  std::uint32_t first, count;
  bool closed;

  std::size_t points() const { return count + !closed; }
};

std::vector<Chain> chains_of(const Polyline& line) {
  std::vector<Chain> chains;
  for (std::uint32_t s = 0; s < line.segments.size(); ++s) {
    if (s > 0 && line.segments[s][0] == line.segments[s - 1][1] &&
        line.triangles_around(line.segments[s][0]).size() == 2)
      ++chains.back().count;
    else chains.push_back({s, 1, false});
  }
  for (Chain& chain : chains)
    chain.closed = line.segments[chain.first][0] == line.segments[chain.first + chain.count - 1][1] && chain.count > 2;
  return chains;
}

/// The points of one curve in their order. Lengths are measured along the source, or along the front.
class ChainOrder {
 public:
  ChainOrder(const PlaneCurves& curves, const Paths& paths, const Chain& chain, std::span<Vec2d> displacement,
             Spacing spacing)
      : curves_(curves),
        paths_(paths),
        chain_(chain),
        displacement_(displacement),
        spacing_(spacing),
        arrived_(chain.points()) {
    for (std::uint32_t i = 0; i < chain.points(); ++i)
      points_.push_back(i < chain.count ? segment(i)[0] : segment(chain.count - 1)[1]);
    along_.push_back(0);
    for (std::uint32_t i = 0; i < chain.count; ++i)
      along_.push_back(along_.back() + (curves.source[segment(i)[1]] - curves.source[segment(i)[0]]).length());
  }

  std::size_t run() {
    if (!one_sided()) return 0;
    for_each_index(
        points_.size(), [&](std::size_t i) { arrived_[i] = arrival_of(i); }, 64);
    if (chain_.closed && !cut()) return 0;
    sort_front();
    if (order_.empty() || (spacing_ == Spacing::AsItIs && std::is_sorted(order_.begin(), order_.end()))) return 0;
    space();
    find_goals(pool());
    if (spacing_ == Spacing::Graded) grade();
    std::atomic<std::size_t> moved = 0;
    for_each_index(
        points_.size(), [&](std::size_t i) { moved += put(i); }, 64);
    return moved;
  }

 private:
  /// Where a point has arrived, if it has.
  struct Arrived {
    bool on_front = false;
    double closest = 0;  // length along the source to its closest point
    double fan = 0;      // order among the points that are closest to one corner
    double front = 0;    // length along the front
  };
  /// Points that have arrived, from `first` on, with one best position but for their spacing.
  struct Block {
    std::size_t first;
    double sum, count;

    double mean() const { return sum / count; }
  };

  const Segment& segment(std::uint32_t i) const { return curves_.line().segments[chain_.first + i]; }
  Vec2d position(std::size_t i) const { return curves_.source[points_[i]] + displacement_[points_[i]]; }

  bool one_sided() const {
    return std::all_of(points_.begin(), points_.end(), [&](std::uint32_t p) {
      return curves_.distances[p] != 0 && curves_.side(p) == curves_.side(points_.front());
    });
  }

  Arrived arrival_of(std::size_t i) const {
    const std::uint32_t p = points_[i];
    if (paths_.state[p] != VertexState::Reached) return {};
    const Polyline& line = curves_.line();
    const Vec3d x = curves_.in_frame(position(i));
    const Closest closest = curves_.query(x, paths_.closest[p]);
    const Vec3d away = x - closest.point;
    if (closest.triangle < chain_.first || closest.triangle >= chain_.first + chain_.count ||
        !(line.pseudonormal(closest.triangle, closest.feature).dot(away) * curves_.side(p) > 0))
      return {};
    const std::uint32_t s = closest.triangle - chain_.first;
    const bool at_end = closest.feature == Feature::Vertex1;
    Arrived arrived{true, along_[s + at_end]};
    if (closest.feature == Feature::Face) arrived.closest += (closest.point - line.vertices[segment(s)[0]]).length();
    else arrived.fan = away.dot(around(s, at_end));
    if (!chain_.closed) return arrived;
    // Closed curves: the length nearest to the point's own, of all that are a whole turn apart.
    const double length = along_.back();
    arrived.closest -= std::round((arrived.closest - along_[i]) / length) * length;
    return arrived;
  }

  /// Halfway between the directions of the segments that meet at one end of segment s, not normalised.
  Vec3d around(std::uint32_t s, bool at_end) const {
    const std::uint32_t last = chain_.count - 1;
    const auto direction = [&](std::uint32_t t) {
      return (curves_.line().vertices[segment(t)[1]] - curves_.line().vertices[segment(t)[0]]).unit();
    };
    const std::uint32_t before = at_end ? s : s > 0 ? s - 1 : chain_.closed ? last : s;
    const std::uint32_t after = !at_end ? s : s < last ? s + 1 : chain_.closed ? 0 : s;
    return direction(before) + direction(after);
  }

  /// Rotates a closed curve to begin at the point whose closest point is nearest to its own source, so that no point
  /// has overtaken it. Returns false if no point has arrived.
  bool cut() {
    std::size_t first = points_.size();
    const auto ahead = [&](std::size_t i) { return std::abs(arrived_[i].closest - along_[i]); };
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (arrived_[i].on_front && (first == points_.size() || ahead(i) < ahead(first))) first = i;
    if (first == points_.size()) return false;
    const double from = along_[first], length = along_.back();
    along_.pop_back();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double before = i < first ? length : 0;
      along_[i] += before - from;
      arrived_[i].closest += before - from;
    }
    const auto rotate = [&](auto& values) {
      std::rotate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first), values.end());
    };
    rotate(points_), rotate(arrived_), rotate(along_);
    return true;
  }

  void sort_front() {
    for (std::uint32_t i = 0; i < points_.size(); ++i)
      if (arrived_[i].on_front) order_.push_back(i);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t i, std::uint32_t j) {
      const Arrived &a = arrived_[i], &b = arrived_[j];
      return std::tie(a.closest, a.fan, i) < std::tie(b.closest, b.fan, j);
    });
    for (const auto i : order_) {
      const double step = front_.empty() ? 0 : (position(i) - front_.back()).length();
      along_front_.push_back(front_.empty() ? 0 : along_front_.back() + step);
      front_.push_back(position(i));
      arrived_[i].front = along_front_.back();
    }
  }

  /// Finds the least spacing of points: a share of that on the source, for twice of which the front has room; for
  /// points in order no more than they have, unless spacing is to be even. Points that have not arrived take up no
  /// room.
  void space() {
    const double share = std::min(kLeastSpacing, 0.5 * along_front_.back() / along_.back());
    spaced_.push_back(0);
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const Arrived &before = arrived_[i - 1], &here = arrived_[i];
      double apart = before.on_front ? share * (along_[i] - along_[i - 1]) : 0;
      if (spacing_ == Spacing::AsItIs && before.on_front && here.on_front && here.front > before.front)
        apart = std::min(apart, here.front - before.front);
      spaced_.push_back(spaced_.back() + apart);
    }
  }

  Vec2d front_at(double length) const {
    const auto after = std::lower_bound(along_front_.begin(), along_front_.end(), length);
    if (after == along_front_.begin()) return front_.front();
    if (after == along_front_.end()) return front_.back();
    const auto k = static_cast<std::size_t>(after - along_front_.begin());
    const double share = (length - along_front_[k - 1]) / (along_front_[k] - along_front_[k - 1]);
    return front_[k - 1] + (front_[k] - front_[k - 1]) * share;
  }

  /// Where points are to be along the front: those of blocks of several move.
  void find_goals(const std::vector<Block>& blocks) {
    goal_.resize(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) goal_[i] = arrived_[i].front;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const std::size_t end = b + 1 < blocks.size() ? blocks[b + 1].first : points_.size();
      for (std::size_t i = blocks[b].first; i < end && blocks[b].count > 1; ++i)
        goal_[i] = blocks[b].mean() + spaced_[i];
    }
  }

  /// Spreads what is too far apart along the front over its neighbours (see Spacing::Graded).
  void grade() {
    constexpr double kMostRatio = 1.4;
    if (!std::all_of(arrived_.begin(), arrived_.end(), [](const Arrived& each) { return each.on_front; })) return;
    const std::size_t count = points_.size() - (chain_.closed ? 0 : 1);
    if (chain_.closed) {
      along_front_.push_back(along_front_.back() + (front_.front() - front_.back()).length());
      front_.push_back(front_.front());
    }
    const auto next = [&](std::size_t i) { return i + 1 < points_.size() ? i + 1 : 0; };
    std::vector<double> apart(count), on_source(count), most(count);
    for (std::size_t i = 0; i < count; ++i) {
      const bool wraps = i + 1 == points_.size();
      apart[i] = goal_[next(i)] - goal_[i] + (wraps ? along_front_.back() : 0);
      on_source[i] = (curves_.source[points_[next(i)]] - curves_.source[points_[i]]).length();
      most[i] = std::max(apart[i], on_source[i]);
    }
    sweep(most, [](double here, double before) { return std::min(here, before * kMostRatio); });
    std::vector<double> excess(count);
    for (std::size_t i = 0; i < count; ++i) {
      excess[i] = std::max(0.0, apart[i] - std::max(most[i], on_source[i]));
      apart[i] -= excess[i];
    }
    add_spread(excess, 1 / kMostRatio, apart);
    // What moves least keeps its place.
    const auto fixed = static_cast<std::size_t>(std::min_element(spread_.begin(), spread_.end()) - spread_.begin());
    std::size_t i = fixed;
    double at = goal_[fixed];
    for (std::size_t turn = 0; turn < count && i < count; ++turn, i = next(i)) {
      at += apart[i];
      if (next(i) != fixed) goal_[next(i)] = at;
    }
    at = goal_[fixed];
    for (std::size_t k = fixed; !chain_.closed && k-- > 0;) goal_[k] = at -= apart[k];
  }

  /// Calls value = of(value, the one before) for all values in their order, and in the order backwards; twice around
  /// closed curves.
  template <class Of>
  void sweep(std::vector<double>& values, Of&& of) const {
    const std::size_t count = values.size();
    for (int turn = 0; turn < (chain_.closed ? 2 : 1); ++turn) {
      for (std::size_t i = chain_.closed ? 0 : 1; i < count; ++i)
        values[i] = of(values[i], values[i > 0 ? i - 1 : count - 1]);
      for (std::size_t i = count - (chain_.closed ? 0 : 1); i-- > 0;)
        values[i] = of(values[i], values[i + 1 < count ? i + 1 : 0]);
    }
  }
  /// Adds each excess to its neighbours on both sides, each next one by `share` of the one before; what would go beyond
  /// the ends of a curve stays this side.
  void add_spread(const std::vector<double>& excess, double share, std::vector<double>& apart) {
    constexpr double kLeast = 1e-6;  // of an excess; reasoned: a part of it that nobody sees
    const auto count = static_cast<std::ptrdiff_t>(excess.size());
    const auto reach = std::min(count - 1, static_cast<std::ptrdiff_t>(std::ceil(std::log(kLeast) / std::log(share))));
    spread_.assign(excess.size(), 0);
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      if (excess[i] == 0) continue;
      std::vector<std::pair<std::size_t, double>> parts;
      double sum = 0;
      for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
        const std::ptrdiff_t to = i + k;
        if (!chain_.closed && (to < 0 || to >= count)) continue;
        parts.emplace_back(static_cast<std::size_t>((to + count) % count), std::pow(share, std::abs(k)));
        sum += parts.back().second;
      }
      for (const auto& [to, part] : parts) spread_[to] += excess[i] * part / sum;
    }
    for (std::size_t i = 0; i < apart.size(); ++i) apart[i] += spread_[i];
  }

  /// Puts a point to its place along the front, if it is another one. Returns whether there was a position.
  bool put(std::size_t i) {
    if (!arrived_[i].on_front || goal_[i] == arrived_[i].front) return false;
    const auto to = position_on_front(curves_, front_at(around_front(goal_[i])), points_[i]);
    if (to) displacement_[points_[i]] = *to - curves_.source[points_[i]];
    return to.has_value();
  }
  double around_front(double length) const {
    if (!chain_.closed || spacing_ != Spacing::Graded) return length;
    return length < 0                     ? length + along_front_.back()
           : length > along_front_.back() ? length - along_front_.back()
                                          : length;
  }

  /// Pools adjacent violators (see put_in_order()).
  std::vector<Block> pool() const {
    std::vector<Block> blocks;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!arrived_[i].on_front) continue;
      blocks.push_back({i, arrived_[i].front - spaced_[i], 1});
      while (blocks.size() > 1 && blocks[blocks.size() - 2].mean() > blocks.back().mean()) {
        const Block last = blocks.back();
        blocks.pop_back();
        blocks.back().sum += last.sum;
        blocks.back().count += last.count;
      }
    }
    return blocks;
  }

  const PlaneCurves& curves_;
  const Paths& paths_;
  Chain chain_;
  std::span<Vec2d> displacement_;
  Spacing spacing_;
  Indices points_;
  std::vector<double> along_;   // of each point: its length along the source
  std::vector<double> spaced_;  // of each point: its least length along the front from the first point
  std::vector<double> goal_;    // of each point: where it is to be along the front
  std::vector<double> spread_;  // of each two neighbours: what they take of others' excess
  std::vector<Arrived> arrived_;
  // The front: the numbers of the points that have arrived there, their positions, and the lengths along it.
  std::vector<std::uint32_t> order_;
  std::vector<Vec2d> front_;
  std::vector<double> along_front_;
};

}  // namespace

std::optional<Vec2d> position_on_front(const PlaneCurves& curves, Vec2d x, std::uint32_t point) {
  const double target = std::abs(curves.distances[point]);
  const Vec2d& source = curves.source[point];
  if (target == 0 || (x - source).length() > 2 * kFarthestSpread * target) return std::nullopt;
  std::uint32_t hint = curves.line().triangles_around(point).front();
  for (int i = 0; i < kProjections; ++i) {
    const Vec3d at = curves.in_frame(x);
    const Closest closest = curves.query(at, hint);
    hint = closest.triangle;
    const Vec3d away = at - closest.point;
    const double towards = curves.line().pseudonormal(closest.triangle, closest.feature).dot(away);
    if (!(towards * curves.side(point) > 0)) return std::nullopt;
    if (std::abs(closest.distance - target) <= kProjectionTolerance * kReachedTolerance * target)
      return (x - source).length() <= kFarthestSpread * target ? std::optional(x) : std::nullopt;
    x += Vec2d(away[0], away[1]) * (target / closest.distance - 1);
  }
  return std::nullopt;
}

std::size_t put_in_order(const PlaneCurves& curves, const Paths& paths, std::span<Vec2d> displacement,
                         Spacing spacing) {
  VDB_OFFSET_ASSERT(displacement.size() == curves.source.size() && paths.state.size() == curves.source.size());
  std::size_t moved = 0;
  for (const Chain& chain : chains_of(curves.line()))
    moved += ChainOrder(curves, paths, chain, displacement, spacing).run();
  return moved;
}

}  // namespace vdb_offset
