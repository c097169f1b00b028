#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "vdb_offset/parallel.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The side of a face along an edge: from its corner `corner` to the next one.
struct EdgeSide {
  std::uint32_t larger_end;  ///< Of the edge's two places.
  std::uint32_t corner;      ///< As an index into PolygonView::corners.
};

/// Calls visit(corner, from, to) for the sides of the faces that have an extent, in order: not for those between
/// corners at one place, nor for faces that are no more than a line. `place` is of each vertex.
template <class Visit>
void for_each_side(PolygonView mesh, std::span<const std::uint32_t> place, Visit&& visit) {
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    const auto from = [&](std::size_t k) { return place[face[k]]; };
    const auto to = [&](std::size_t k) { return place[face[k + 1 < face.size() ? k + 1 : 0]]; };
    std::size_t sides = 0;
    for (std::size_t k = 0; k < face.size(); ++k) sides += from(k) != to(k);
    for (std::size_t k = 0; sides > 2 && k < face.size(); ++k)
      if (from(k) != to(k)) visit(mesh.face_begin[f] + static_cast<std::uint32_t>(k), from(k), to(k));
  }
}

/// Calls visit(smaller end, sides) for every edge, by place; its sides are in the order of the corners.
template <class Visit>
void visit_edges(PolygonView mesh, std::span<const std::uint32_t> place, Visit&& visit) {
  std::vector<std::uint32_t> begin(place.size() + 2, 0);
  for_each_side(mesh, place, [&](auto, std::uint32_t from, std::uint32_t to) { ++begin[std::min(from, to) + 2]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<EdgeSide> sides(begin.back());
  for_each_side(mesh, place, [&](std::uint32_t corner, std::uint32_t from, std::uint32_t to) {
    sides[begin[std::min(from, to) + 1]++] = {std::max(from, to), corner};
  });
  const auto around = [&](std::size_t v) { return std::span(sides).subspan(begin[v], begin[v + 1] - begin[v]); };
  for_each_index(place.size(), [&](std::size_t v) {
    std::sort(around(v).begin(), around(v).end(), [](const EdgeSide& a, const EdgeSide& b) {
      return std::pair(a.larger_end, a.corner) < std::pair(b.larger_end, b.corner);
    });
  });
  for (std::size_t v = 0; v < place.size(); ++v)
    for (auto rest = around(v); !rest.empty();) {
      std::size_t size = 1;
      while (size < rest.size() && rest[size].larger_end == rest[0].larger_end) ++size;
      visit(static_cast<std::uint32_t>(v), std::span<const EdgeSide>(rest.first(size)));
      rest = rest.subspan(size);
    }
}

}  // namespace vdb_offset
