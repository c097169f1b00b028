// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "ground/mesh/edge_sides.h"
#include "ground/numbers/disjoint_sets.h"
#include "ground/system/parallel.h"
#include "products/cells/number_cells.h"

namespace vdb_offset {

/// Two sides of an edge with opposite directions, by the corners at which they start.
struct SidePair {
  std::uint32_t forwards, backwards;
};

/// Calls pair(SidePair) for the sides of an edge, the first forwards with the first backwards and so on, and
/// left(corner) for the sides that are left. `sides` are sorted by corner.
template <class Pair, class Left>
void pair_sides(std::span<const EdgeSide> sides, std::span<const std::uint32_t> corners, std::uint32_t smaller,
                Pair&& pair, Left&& left) {
  const auto seek = [&](std::size_t from, bool forwards) {
    while (from < sides.size() && (corners[sides[from].corner] == smaller) != forwards) ++from;
    return from;
  };
  std::size_t f = seek(0, true), b = seek(0, false);
  for (; f < sides.size() && b < sides.size(); f = seek(f + 1, true), b = seek(b + 1, false))
    pair(SidePair{sides[f].corner, sides[b].corner});
  for (; f < sides.size(); f = seek(f + 1, true)) left(sides[f].corner);
  for (; b < sides.size(); b = seek(b + 1, false)) left(sides[b].corner);
}

/// Finds the sides on the boundary, and the positions at which a side is left without a partner.
class SideMatch {
 public:
  SideMatch(std::size_t vertices, std::span<const std::uint8_t> flat, NumberedColumns& columns, LayerCellFacts& facts)
      : columns_(columns),
        flat_(flat),
        edges_({{}, columns.corners, columns.begin}, numbers_below(vertices)),
        crowded_(vertices, 0) {
    std::atomic<std::size_t> border_sides = 0, unpaired_sides = 0;
    for_each_index(edges_.positions(), [&](std::size_t v) {
      visit_risen_from(v, [&](std::uint32_t a, std::uint32_t b, std::span<const EdgeSide> sides) {
        pair_sides(
            sides, columns_.corners, a, [](SidePair) {},
            [&](std::uint32_t corner) {
              columns_.open[corner] = 1;
              ++(sides.size() == 1 ? border_sides : unpaired_sides);
              if (sides.size() == 1) return;
              for (const std::uint32_t end : {a, b}) std::atomic_ref(crowded_[end]).store(1, std::memory_order_relaxed);
            });
      });
    });
    facts.border_sides = border_sides;
    facts.unpaired_sides = unpaired_sides;
    has_unpaired_ = unpaired_sides > 0;
  }
  /// Whether any side that is no border is left without a partner.
  bool has_unpaired() const { return has_unpaired_; }
  bool crowded(std::uint32_t vertex) const { return crowded_[vertex] != 0; }

  /// Joins corners that share a point of the wall, where a position has several points: over paired sides.
  DisjointSets join_fans() const {
    DisjointSets sets(columns_.corners.size());
    for_edges([&](std::uint32_t a, std::uint32_t b, std::span<const EdgeSide> sides) {
      if (!crowded(a) && !crowded(b)) return;
      pair_sides(
          sides, columns_.corners, a,
          [&](SidePair pair) {
            sets.join(pair.forwards, next(pair.backwards));
            sets.join(next(pair.forwards), pair.backwards);
          },
          [](std::uint32_t) {});
    });
    return sets;
  }

  /// Counts the unpaired sides that have the points of other sides. \pre no unpaired side is a border
  std::size_t count_coincident(DisjointSets& sets) const {
    std::size_t count = 0;
    for_edges([&](std::uint32_t a, std::uint32_t, std::span<const EdgeSide> sides) {
      const auto ends = [&](std::uint32_t corner) {
        std::pair at(sets.first(corner), sets.first(next(corner)));
        return columns_.corners[corner] == a ? at : std::pair(at.second, at.first);
      };
      for (const EdgeSide& side : sides)
        if (columns_.open[side.corner] != 0 && sides.size() > 1)
          count += std::count_if(sides.begin(), sides.end(),
                                 [&](const EdgeSide& other) { return ends(other.corner) == ends(side.corner); }) > 1;
    });
    return count;
  }

 private:
  static std::vector<std::uint32_t> numbers_below(std::size_t count) {
    std::vector<std::uint32_t> numbers(count);
    for_each_index(count, [&](std::size_t i) { numbers[i] = static_cast<std::uint32_t>(i); });
    return numbers;
  }
  template <class Visit>
  void visit_risen_from(std::size_t vertex, Visit&& visit) const {
    edges_.visit_from(vertex, [&](std::uint32_t smaller, std::span<const EdgeSide> sides) {
      const std::uint32_t larger = sides[0].larger_end;
      if (flat_[smaller] == 0 || flat_[larger] == 0) visit(smaller, larger, sides);
    });
  }
  template <class Visit>
  void for_edges(Visit&& visit) const {
    for (std::size_t v = 0; v < edges_.positions(); ++v) visit_risen_from(v, visit);
  }
  std::uint32_t next(std::uint32_t corner) const {
    const auto column = std::upper_bound(columns_.begin.begin(), columns_.begin.end(), corner) - 1;
    return columns_.next(static_cast<std::size_t>(column - columns_.begin.begin()), corner);
  }

  NumberedColumns& columns_;
  std::span<const std::uint8_t> flat_;
  EdgeSides edges_;
  std::vector<std::uint8_t> crowded_;  // of each vertex: 1 if a side there is left without a partner
  bool has_unpaired_ = false;
};

}  // namespace vdb_offset
