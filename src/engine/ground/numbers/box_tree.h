// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "ground/numbers/float_lanes.h"
#include "ground/system/assert.h"

namespace vdb_offset {

/// A box of floats; empty, as it is by default, if a lower bound is above its upper one.
struct FloatBox {
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, 3> lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};

  void include(const FloatBox& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], other.lower[k]);
      upper[k] = std::max(upper[k], other.upper[k]);
    }
  }
};

/// An implicit tree over boxes that come in an order in which neighbours are near each other: eight in a row make one
/// box of the level above, and so on. There are no pointers; node n of level l has the children 8 n .. 8 n + 7 of
/// level l - 1, those of level 0 being the boxes given.
class BoxTree {
 public:
  static constexpr int kWidth = 8;  ///< Children of a box: two rows of lanes.

  /// Eight siblings' boxes, coordinate by coordinate. Boxes beyond the last are empty.
  struct Siblings {
    float lower[3][kWidth], upper[3][kWidth];
  };

  /// Builds the tree over box_of(0 .. count - 1), which is called in parallel. \pre count > 0
  void build(std::size_t count, const std::function<FloatBox(std::size_t)>& box_of);

  /// Takes the boxes of some children of level 0 anew, and those above them. \pre `changed` is sorted, no two the same
  void refit(std::span<const std::uint32_t> changed, const std::function<FloatBox(std::size_t)>& box_of);

  /// Level 0 holds the boxes given, back() a single block.
  const std::vector<std::vector<Siblings>>& levels() const { return levels_; }

  /// Calls visit(i) for every box of a level (0: every box given) that meets `box`; touching counts. Box i of level
  /// l > 0 is around the block levels()[l - 1][i]. \pre `box` is bounded along one axis: else it meets empty boxes, too
  template <class Visit>
  void for_each_overlap(const FloatBox& box, Visit&& visit, std::size_t of_level = 0) const;
  /// Calls is_it(i) for boxes of a level that meet `box`, until it returns true. Returns whether it did.
  template <class IsIt>
  bool any_overlap(const FloatBox& box, IsIt&& is_it, std::size_t of_level = 0) const;
  /// Calls is_it(i) for the boxes given, other than begin .. end - 1, that meet `box`, until it returns true. Returns
  /// whether it did.
  template <class IsIt>
  bool any_overlap_beside(std::size_t begin, std::size_t end, const FloatBox& box, IsIt&& is_it) const;

  /// Calls is_it(i) for boxes of a level that meet `box` until it returns true, but not for what is in children for
  /// which `counts(level, child)` does not hold. Returns whether it did.
  template <class Counts, class IsIt>
  bool any_overlap_of(const FloatBox& box, std::size_t of_level, Counts&& counts, IsIt&& is_it) const;

  /// Which of eight siblings meet a box, as bits.
  static unsigned overlaps(const Siblings& siblings, const FloatBox& box);
  static FloatBox box(const Siblings& siblings, int i);
  static FloatBox around(const Siblings& siblings);

 private:
  std::vector<std::vector<Siblings>> levels_;
};

inline unsigned BoxTree::overlaps(const Siblings& siblings, const FloatBox& box) {
  unsigned meets = 0;
  for (int i = 0; i < kWidth; i += kLanes) {
    IntLanes lanes = IntLanes{} - 1;
    for (std::size_t k = 0; k < 3; ++k)
      lanes &= (load_lanes(siblings.lower[k] + i) <= box.upper[k] + Lanes{}) &
               (load_lanes(siblings.upper[k] + i) >= box.lower[k] + Lanes{});
    meets |= lane_bits(lanes) << i;
  }
  return meets;
}

inline FloatBox BoxTree::box(const Siblings& siblings, int i) {
  const auto& [lower, upper] = siblings;
  return {{lower[0][i], lower[1][i], lower[2][i]}, {upper[0][i], upper[1][i], upper[2][i]}};
}

template <class Visit>
void BoxTree::for_each_overlap(const FloatBox& box, Visit&& visit, std::size_t of_level) const {
  any_overlap(
      box,
      [&](std::size_t i) {
        visit(i);
        return false;
      },
      of_level);
}

template <class IsIt>
bool BoxTree::any_overlap(const FloatBox& box, IsIt&& is_it, std::size_t of_level) const {
  return any_overlap_of(
      box, of_level, [](std::size_t, std::size_t) { return true; }, is_it);
}

template <class IsIt>
bool BoxTree::any_overlap_beside(std::size_t begin, std::size_t end, const FloatBox& box, IsIt&& is_it) const {
  // A child at a level holds 8^level of the boxes given, in a row.
  const auto counts = [&](std::size_t level, std::size_t child) {
    return child << 3 * level < begin || (child + 1) << 3 * level > end;
  };
  return any_overlap_of(box, 0, counts, is_it);
}

template <class Counts, class IsIt>
bool BoxTree::any_overlap_of(const FloatBox& box, std::size_t of_level, Counts&& counts, IsIt&& is_it) const {
  struct Node {
    std::uint32_t level, node;
  };
  VDB_OFFSET_ASSERT(of_level < levels_.size());
  std::array<Node, kWidth * 12> stack;  // enough: 8^12 boxes are more than 32 bits can number
  std::size_t depth = 0;
  stack[depth++] = {static_cast<std::uint32_t>(levels_.size() - 1), 0};
  while (depth > 0) {
    const auto [level, node] = stack[--depth];
    for (unsigned meets = overlaps(levels_[level][node], box); meets != 0; meets &= meets - 1) {
      const std::uint32_t child = node * kWidth + static_cast<std::uint32_t>(std::countr_zero(meets));
      if (!counts(level, child)) continue;
      if (level != of_level) stack[depth++] = {level - 1, child};
      else if (is_it(std::size_t{child})) return true;
    }
  }
  return false;
}

}  // namespace vdb_offset
