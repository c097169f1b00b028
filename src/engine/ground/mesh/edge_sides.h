// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "ground/numbers/bucket_sort.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The side of a face along an edge: from its corner `corner` to the next one.
struct EdgeSide {
  std::uint32_t larger_end;  ///< The larger of the edge's two positions, by number.
  std::uint32_t corner;      ///< Index into PolygonView::corners.
};

/// Calls visit(corner, from, to) for the sides of a face that has an extent: not for sides between corners at one
/// position, nor for a face that is no more than a line. `position` has the number of each vertex's position.
template <class Visit>
void visit_sides(PolygonView mesh, std::span<const std::uint32_t> position, std::size_t f, Visit&& visit) {
  const auto face = mesh.face(f);
  const std::uint32_t first = mesh.face_begin[f];
  if (face.size() == 3) {
    const std::uint32_t a = position[face[0]], b = position[face[1]], c = position[face[2]];
    if (a == b || b == c || c == a) return;
    visit(first, a, b), visit(first + 1, b, c), visit(first + 2, c, a);
    return;
  }
  const auto from = [&](std::size_t k) { return position[face[k]]; };
  const auto to = [&](std::size_t k) { return position[face[k + 1 < face.size() ? k + 1 : 0]]; };
  std::size_t sides = 0;
  for (std::size_t k = 0; k < face.size(); ++k) sides += from(k) != to(k);
  for (std::size_t k = 0; sides > 2 && k < face.size(); ++k)
    if (from(k) != to(k)) visit(first + static_cast<std::uint32_t>(k), from(k), to(k));
}

/// Calls visit(corner, from, to) as visit_sides() does for all faces, in parallel.
template <class Visit>
void for_each_side(PolygonView mesh, std::span<const std::uint32_t> position, Visit&& visit) {
  for_each_index(mesh.face_count(), [&](std::size_t f) { visit_sides(mesh, position, f, visit); });
}

/// The sides of all faces, by the edges that they run along.
class EdgeSides {
 public:
  EdgeSides(PolygonView mesh, std::span<const std::uint32_t> position) {
    Buckets buckets(position.size());
    for_each_side(mesh, position,
                  [&](auto, std::uint32_t from, std::uint32_t to) { buckets.count(std::min(from, to)); });
    sides_.resize(buckets.close());
    for_each_side(mesh, position, [&](std::uint32_t corner, std::uint32_t from, std::uint32_t to) {
      sides_[buckets.next(std::min(from, to))] = {std::max(from, to), corner};
    });
    begin_ = buckets.take();
    for_each_index(position.size(), [&](std::size_t v) {
      const auto around = std::span(sides_).subspan(begin_[v], begin_[v + 1] - begin_[v]);
      std::sort(around.begin(), around.end(), [](const EdgeSide& a, const EdgeSide& b) {
        return std::pair(a.larger_end, a.corner) < std::pair(b.larger_end, b.corner);
      });
    });
  }

  std::size_t positions() const { return begin_.size() - 1; }
  /// Calls visit(v, sides) for the edges from position v to larger ones; their sides are in the order of the corners.
  template <class Visit>
  void visit_from(std::size_t v, Visit&& visit) const {
    VDB_OFFSET_ASSERT(v < positions());
    for (auto rest = std::span(sides_).subspan(begin_[v], begin_[v + 1] - begin_[v]); !rest.empty();) {
      std::size_t size = 1;
      while (size < rest.size() && rest[size].larger_end == rest[0].larger_end) ++size;
      visit(static_cast<std::uint32_t>(v), std::span<const EdgeSide>(rest.first(size)));
      rest = rest.subspan(size);
    }
  }

 private:
  std::vector<std::uint32_t> begin_;
  std::vector<EdgeSide> sides_;
};

/// Calls visit(smaller end, sides) for every edge, by position; its sides are in the order of the corners.
template <class Visit>
void visit_edges(PolygonView mesh, std::span<const std::uint32_t> position, Visit&& visit) {
  const EdgeSides edges(mesh, position);
  for (std::size_t v = 0; v < edges.positions(); ++v) edges.visit_from(v, visit);
}

}  // namespace vdb_offset
