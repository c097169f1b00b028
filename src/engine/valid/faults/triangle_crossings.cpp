// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/triangle_crossings.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "ground/mesh/exact_predicates.h"
#include "ground/system/assert.h"
#include "ground/system/memory.h"
#include "ground/system/parallel.h"
#include "valid/faults/find_pairs.h"

namespace vdb_offset {
namespace {

/// True if the corners of a surface's triangle t that triangle s does not have lie clearly on one side of the plane of
/// s.
bool on_one_side(const TrianglePlane& plane, const Surface& surface, std::span<const Vec3d> positions, std::uint32_t s,
                 std::uint32_t t) {
  const auto& [a, b, c] = surface.triangles[s];
  int sum = 0, corners = 0;
  for (const auto v : surface.triangles[t]) {
    if (v == a || v == b || v == c) continue;
    sum += plane.side(positions[v]);
    ++corners;
  }
  return corners > 0 && std::abs(sum) == corners;
}

/// Whether two triangles meet elsewhere than in the corners that they share. Most pairs are clearly apart; no more than
/// rounding is left to the exact predicates.
bool meet(const TestedPair& pair) {
  if (pair.shared == 3) return false;  // the same triangle twice, or a sheet's two sides
  const TrianglePlane plane_of_a(pair.a), plane_of_b(pair.b);
  if (on_one_side(plane_of_a, pair.b, pair.shared) || on_one_side(plane_of_b, pair.a, pair.shared)) return false;
  if (pair.shared == 1 && on_either_side(pair.a, pair.b)) return false;
  if (pair.shared == 0 && (EdgePlanes(pair.a).miss(pair.b) || EdgePlanes(pair.b).miss(pair.a))) return false;
  const std::array<Vec3d, 3>&a = pair.a, &b = pair.b;
  if (!plane_of_a.is_clear() && has_no_area(a)) return false;
  if (!plane_of_b.is_clear() && has_no_area(b)) return false;
  if (pair.shared == 0) return triangles_meet(a, b);
  if (pair.shared == 1) return segment_meets_triangle(a[1], a[2], b) || segment_meets_triangle(b[1], b[2], a);
  return lie_on_each_other(a, b);
}

/// Whether a triangle has corners strictly on both sides of another's plane.
bool has_both_sides(const std::array<Vec3d, 3>& triangle, const std::array<Vec3d, 3>& other) {
  int least = 0, most = 0;
  for (const Vec3d& corner : triangle) {
    const int side = side_of_plane(other, corner);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least < 0 && most > 0;
}

bool meet(const Surface& surface, std::span<const Vec3d> positions, std::uint32_t s, std::uint32_t t) {
  return meet(TestedPair(surface, positions, s, positions, t));
}

}  // namespace

CrossingFinder::CrossingFinder(const Surface& surface, std::span<const Vec3d> positions)
    : surface_(surface), positions_(positions), is_updated_(surface.triangles.size(), 0) {
  VDB_OFFSET_ASSERT(surface.vertices.empty() || positions.size() == surface.vertices.size());
  build();
}

void CrossingFinder::build() {
  tree_.build(surface_.triangles.size(), [&](std::size_t t) { return box_of(corners(t, positions_)); });
  fans_.build(surface_, positions_, tree_.levels().size());
  planes_.clear();
  if (fans_.empty()) return;
  planes_.resize(surface_.triangles.size());
  for_each_index(
      planes_.size(), [&](std::size_t t) { planes_[t] = TrianglePlane(corners(t, positions_)); }, 256);
}

void CrossingFinder::update(std::span<const std::uint32_t> triangles) {
  VDB_OFFSET_ASSERT(std::adjacent_find(triangles.begin(), triangles.end(), std::greater_equal<>()) == triangles.end());
  for (const auto t : updated_) is_updated_[t] = 0;
  updated_.assign(triangles.begin(), triangles.end());
  for (const auto t : updated_) is_updated_[t] = 1;
  if (triangles.size() == surface_.triangles.size()) build();
  else {
    tree_.refit(triangles, [&](std::size_t t) { return box_of(corners(t, positions_)); });
    fans_.refit(triangles);
    if (!planes_.empty())
      for (const auto t : triangles) planes_[t] = TrianglePlane(corners(t, positions_));
  }
}

std::array<Vec3d, 3> CrossingFinder::corners(std::size_t t, std::span<const Vec3d> positions) const {
  const auto& [a, b, c] = surface_.triangles[t];
  return {positions[a], positions[b], positions[c]};
}

/// Rounded outwards, relative to the surface's own frame.
FloatBox CrossingFinder::box_of(const std::array<Vec3d, 3>& corners) const {
  FloatBox box;
  for (const Vec3d& corner : corners)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto x = static_cast<float>(corner[static_cast<int>(k)] - surface_.origin[static_cast<int>(k)]);
      const float rounding = std::abs(x) * 0x1p-23f + std::numeric_limits<float>::denorm_min();
      box.lower[k] = std::min(box.lower[k], x - rounding);
      box.upper[k] = std::max(box.upper[k], x + rounding);
    }
  return box;
}

bool CrossingFinder::misses(std::uint32_t t, const FloatBox& box) const {
  return planes_[t].misses(box, surface_.origin) || EdgePlanes(corners(t, positions_)).miss(box, surface_.origin);
}

FloatBox CrossingFinder::box_of_child(std::size_t level, std::size_t child) const {
  return BoxTree::box(tree_.levels()[level][child / BoxTree::kWidth], static_cast<int>(child % BoxTree::kWidth));
}

/// What a search of some triangles need not look at, where fans are large: what is apart in direction, and once it has
/// looked at much, as long triangles whose boxes meet many others, what is on one side of their planes.
class CrossingFinder::Sieve {
 public:
  /// \param triangles of one block; referred to \param all around them
  Sieve(const CrossingFinder& finder, std::span<const std::uint32_t> triangles, const FloatBox& all)
      : finder_(finder),
        triangles_(triangles),
        all_(all),
        fan_(triangles.empty() ? nullptr : finder.fans_.of_block(triangles.front() / BoxTree::kWidth)) {}

  bool lets_through(std::size_t level, std::size_t child) {
    if (finder_.planes_.empty()) return true;
    if (fan_ && finder_.fans_.are_apart(*fan_, level, child)) return false;
    if (++visited_ <= kFew) return true;
    if (own_.empty())
      for (const auto t : triangles_)
        own_.emplace_back(finder_.planes_[t], EdgePlanes(finder_.corners(t, finder_.positions_)));
    const FloatBox box = finder_.box_of_child(level, child);
    return std::any_of(own_.begin(), own_.end(), [&](const auto& each) {
      return !each.first.misses(box, finder_.surface_.origin) && !each.second.miss(box, finder_.surface_.origin);
    });
  }

  /// Which triangles of a block may meet those of the search, as bits.
  unsigned may_meet(std::size_t block) const {
    unsigned may = (1u << BoxTree::kWidth) - 1;
    if (visited_ <= kFew) return may;
    for (std::size_t t = block * BoxTree::kWidth; t < std::min(finder_.planes_.size(), (block + 1) * BoxTree::kWidth);
         ++t)
      if (finder_.misses(static_cast<std::uint32_t>(t), all_)) may &= ~(1u << t % BoxTree::kWidth);
    return may;
  }

 private:
  // Boxes that a search looks at without more ado: planes cost more than most have to look at. Not measured.
  static constexpr std::size_t kFew = 64;

  const CrossingFinder& finder_;
  std::span<const std::uint32_t> triangles_;
  const FloatBox& all_;
  const FanBoxes::Node* fan_;
  std::size_t visited_ = 0;
  std::vector<std::pair<TrianglePlane, EdgePlanes>> own_;
};

/// Calls visit(s, t), which says whether that is enough, for the pairs that meet of a block's triangles and those that
/// follow. Few of a block's triangles come near the box around another.
template <class Takes, class Visit>
void CrossingFinder::for_each_pair_of(std::size_t block, Takes&& takes, Visit&& visit) const {
  const auto& blocks = tree_.levels().front();
  constexpr std::uint32_t kWidth = BoxTree::kWidth;
  const FloatBox all = BoxTree::around(blocks[block]);
  std::vector<std::uint32_t> own;
  for (std::size_t t = block * kWidth; t < std::min(planes_.size(), (block + 1) * kWidth); ++t)
    own.push_back(static_cast<std::uint32_t>(t));
  Sieve sieve(*this, own, all);
  const auto compare = [&](std::size_t other, unsigned near) {
    const unsigned may = sieve.may_meet(other);
    for (; near != 0; near &= near - 1) {
      const int i = std::countr_zero(near);
      const auto s = static_cast<std::uint32_t>(block) * kWidth + static_cast<std::uint32_t>(i);
      unsigned meets = BoxTree::overlaps(blocks[other], BoxTree::box(blocks[block], i));
      if (block == other) meets &= ~0u << (i + 1);
      meets &= may;
      if (meets == 0 || !takes(s)) continue;
      const TrianglePlane plane(corners(s, positions_));
      for (; meets != 0; meets &= meets - 1) {
        const auto t = static_cast<std::uint32_t>(other) * kWidth + static_cast<std::uint32_t>(std::countr_zero(meets));
        if (!on_one_side(plane, surface_, positions_, s, t) && takes(t) && meet(surface_, positions_, s, t) &&
            visit(s, t))
          return true;
      }
    }
    return false;
  };
  constexpr unsigned kAll = (1u << kWidth) - 1;
  if (tree_.levels().size() == 1) {
    compare(block, kAll);
    return;
  }
  tree_.any_overlap_of(
      all, 1, [&](std::size_t level, std::size_t child) { return sieve.lets_through(level, child); },
      [&](std::size_t other) {
        if (other < block) return false;
        const FloatBox box = BoxTree::box(tree_.levels()[1][other / kWidth], static_cast<int>(other % kWidth));
        return compare(other, other == block ? kAll : BoxTree::overlaps(blocks[block], box));
      });
}

std::vector<TrianglePair> CrossingFinder::all(const std::function<bool(std::uint32_t)>& matters) const {
  return find_in_parallel(tree_.levels().front().size(), 64, [&](std::size_t block, std::vector<TrianglePair>& found) {
    for_each_pair_of(
        block, [&](std::uint32_t t) { return !matters || matters(t); },
        [&](std::uint32_t s, std::uint32_t t) {
          append_within_limit(found, {s, t}, kCrossings);
          return false;
        });
  });
}

SelfCrossings CrossingFinder::listed() const {
  std::atomic<std::size_t> count = 0;
  SelfCrossings crossings;
  crossings.pairs =
      find_in_parallel(tree_.levels().front().size(), 64, [&](std::size_t block, std::vector<TrianglePair>& found) {
        if (count.load(std::memory_order_relaxed) > kMostListedPairs) return;
        const std::size_t before = found.size();
        for_each_pair_of(
            block, [](std::uint32_t) { return true; },
            [&](std::uint32_t s, std::uint32_t t) {
              append_within_limit(found, TrianglePair(s, t), "crossings");
              return found.size() - before > kMostListedPairs;
            });
        count += found.size() - before;
      });
  crossings.more = crossings.pairs.size() > kMostListedPairs;
  if (!crossings.more) return crossings;
  crossings.pairs = {};
  crossings.crossed.assign(surface_.triangles.size(), 0);
  for_each_index(
      surface_.triangles.size(),
      [&](std::size_t t) { crossings.crossed[t] = meets_any(static_cast<std::uint32_t>(t)); }, 64);
  return crossings;
}

bool CrossingFinder::meets_any(std::uint32_t t) const {
  const std::array<Vec3d, 3> here = corners(t, positions_);
  const TrianglePlane plane(here);
  const std::array<std::uint32_t, 1> only{t};
  const FloatBox box = box_of(here);
  Sieve sieve(*this, only, box);
  const auto counts = [&](std::size_t level, std::size_t child) { return sieve.lets_through(level, child); };
  return tree_.any_overlap_of(box, 0, counts, [&](std::size_t child) {
    const auto other = static_cast<std::uint32_t>(child);
    if (other == t || on_one_side(plane, surface_, positions_, t, other)) return false;
    const TrianglePair pair = std::minmax(t, other);
    return meet(surface_, positions_, pair.first, pair.second);
  });
}

/// Runs of the last update's triangles that are in one block, by where they begin; then where the last one ends.
std::vector<std::uint32_t> CrossingFinder::updated_runs() const {
  std::vector<std::uint32_t> runs;
  for (std::uint32_t i = 0; i < updated_.size(); ++i)
    if (i == 0 || updated_[i] / BoxTree::kWidth != updated_[i - 1] / BoxTree::kWidth) runs.push_back(i);
  runs.push_back(static_cast<std::uint32_t>(updated_.size()));
  return runs;
}

/// Calls is_it(t, other, plane) for each triangle t of a run that `takes` is true of, and each other triangle whose box
/// meets that of t; `plane` is that of t. No more for a t for which is_it() was true once.
template <class Takes, class IsIt>
void CrossingFinder::any_near(std::span<const std::uint32_t> run, Takes&& takes, IsIt&& is_it) const {
  struct Open {
    std::uint32_t triangle;
    FloatBox box;
    TrianglePlane plane;
  };
  std::array<std::optional<Open>, BoxTree::kWidth> open;
  std::size_t count = 0;
  FloatBox all;
  for (const auto t : run) {
    if (!takes(t)) continue;
    const std::array<Vec3d, 3> here = corners(t, positions_);
    open[count].emplace(Open{t, box_of(here), TrianglePlane(here)});
    all.include(open[count++]->box);
  }
  Sieve sieve(*this, run, all);
  const auto search = [&](std::size_t block) {
    const unsigned may = sieve.may_meet(block);
    for (std::size_t i = 0; i < count;) {
      const auto& [t, box, plane] = *open[i];
      bool found = false;
      for (unsigned near = BoxTree::overlaps(tree_.levels().front()[block], box) & may; near != 0 && !found;
           near &= near - 1) {
        const auto other =
            static_cast<std::uint32_t>(block) * BoxTree::kWidth + static_cast<std::uint32_t>(std::countr_zero(near));
        found = other != t && is_it(t, other, plane);
      }
      if (found) open[i] = open[--count];
      else ++i;
    }
    return count == 0;
  };
  if (count == 0) return;
  if (tree_.levels().size() == 1) search(0);
  else
    tree_.any_overlap_of(
        all, 1, [&](std::size_t level, std::size_t child) { return sieve.lets_through(level, child); }, search);
}

std::vector<TrianglePair> CrossingFinder::of_updated(const std::function<bool(std::uint32_t)>& matters) const {
  const std::vector<std::uint32_t> runs = updated_runs();
  const auto may_take = [&](std::uint32_t t) { return !matters || matters(t); };
  return find_in_parallel(runs.size() - 1, 4, [&](std::size_t r, std::vector<TrianglePair>& found) {
    any_near(std::span(updated_).subspan(runs[r], runs[r + 1] - runs[r]), may_take,
             [&](std::uint32_t t, std::uint32_t other, const TrianglePlane& plane) {
               if (other < t && is_updated_[other]) return false;
               if (on_one_side(plane, surface_, positions_, t, other) || !may_take(other)) return false;
               const TrianglePair pair = std::minmax(t, other);
               if (meet(surface_, positions_, pair.first, pair.second)) append_within_limit(found, pair, kCrossings);
               return false;
             });
  });
}

/// First each triangle searches those that do not search it. Then a triangle that is in no pair yet searches those that
/// were to search it, and had stopped before.
std::vector<TrianglePair> CrossingFinder::one_of_each_updated(
    const std::function<bool(std::uint32_t)>& matters, const std::function<bool(const TrianglePair&)>& counts) const {
  const std::vector<std::uint32_t> runs = updated_runs();
  const auto may_take = [&](std::uint32_t t) { return !matters || matters(t); };
  const auto find_one_of_each = [&](auto&& takes, auto&& may_meet) {
    return find_in_parallel(runs.size() - 1, 4, [&](std::size_t r, std::vector<TrianglePair>& found) {
      any_near(std::span(updated_).subspan(runs[r], runs[r + 1] - runs[r]), takes,
               [&](std::uint32_t t, std::uint32_t other, const TrianglePlane& plane) {
                 if (!may_meet(t, other) || on_one_side(plane, surface_, positions_, t, other) || !may_take(other))
                   return false;
                 const TrianglePair pair = std::minmax(t, other);
                 if (!meet(surface_, positions_, pair.first, pair.second) || !counts(pair)) return false;
                 found.push_back(pair);
                 return true;
               });
    });
  };
  std::vector<TrianglePair> pairs = find_one_of_each(
      may_take, [&](std::uint32_t t, std::uint32_t other) { return other > t || !is_updated_[other]; });
  if (pairs.empty()) return pairs;
  std::vector<std::uint8_t> meets(is_updated_.size(), 0);
  for (const auto& [s, t] : pairs) meets[s] = meets[t] = 1;
  const std::vector<TrianglePair> more = find_one_of_each(
      [&](std::uint32_t t) { return !meets[t] && may_take(t); },
      [&](std::uint32_t t, std::uint32_t other) { return other < t && is_updated_[other] && meets[other]; });
  pairs.insert(pairs.end(), more.begin(), more.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

bool CrossingFinder::go_through(const TrianglePair& pair) const {
  const TestedPair tested(surface_, positions_, pair.first, positions_, pair.second);
  return has_both_sides(tested.a, tested.b) && has_both_sides(tested.b, tested.a) && meet(tested);
}

std::vector<std::uint32_t> CrossingFinder::met_by(std::uint32_t triangle, std::span<const Vec3d> positions) const {
  std::vector<std::uint32_t> met;
  const TrianglePlane plane(corners(triangle, positions));
  const FloatBox box = box_of(corners(triangle, positions));
  const auto counts = [&](std::size_t level, std::size_t child) {
    return planes_.empty() || !plane.misses(box_of_child(level, child), surface_.origin);
  };
  tree_.any_overlap_of(box, 0, counts, [&](std::size_t child) {
    const auto other = static_cast<std::uint32_t>(child);
    if (!planes_.empty() && misses(other, box)) return false;
    if (!vdb_offset::misses(plane, corners(other, positions_)) &&
        meet(TestedPair(surface_, positions, triangle, positions_, other)))
      met.push_back(other);
    return false;
  });
  return met;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> CrossingFinder::met_by(
    std::span<const std::uint32_t> others, const std::function<std::array<Vec3d, 3>(std::uint32_t)>& corners_of) const {
  return find_in_parallel(others.size(), 64, [&](std::size_t i, std::vector<TrianglePair>& found) {
    const std::array<Vec3d, 3> other = corners_of(others[i]);
    const TrianglePlane plane(other);
    tree_.for_each_overlap(box_of(other), [&](std::size_t child) {
      const auto t = static_cast<std::uint32_t>(child);
      const std::array<Vec3d, 3> here = corners(t, positions_);
      if (!vdb_offset::misses(plane, here) && meet(TestedPair(other, here))) found.emplace_back(others[i], t);
    });
  });
}

}  // namespace vdb_offset
