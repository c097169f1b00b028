// SPDX-License-Identifier: Apache-2.0
#include "space/surface/border_loops.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace vdb_offset {
namespace {

/// The edges with one face, and for each vertex which of them end there.
class BorderEdges {
 public:
  explicit BorderEdges(const Surface& surface) {
    for (std::uint32_t edge = 0; edge < surface.next_around_edge.size(); ++edge) {
      if (surface.next_around_edge[edge] != edge) continue;
      for (const auto v : {surface.from(edge), surface.to(edge)})
        at_vertex_.emplace_back(v, static_cast<std::uint32_t>(edges_.size()));
      edges_.push_back({surface.from(edge), surface.to(edge)});
    }
    std::sort(at_vertex_.begin(), at_vertex_.end());
    walked_.assign(edges_.size(), 0);
  }

  std::size_t count() const { return edges_.size(); }
  bool is_walked(std::uint32_t edge) const { return walked_[edge]; }
  bool has_branch(std::uint32_t vertex) const { return around(vertex).size() != 2; }
  std::array<std::uint32_t, 2> ends(std::uint32_t edge) const { return edges_[edge]; }

  /// Follows a border along an edge, from one end of it, until the border branches or closes.
  BorderLoop walk(std::uint32_t edge, std::uint32_t from) {
    BorderLoop loop{{from}, false};
    for (std::uint32_t at = from;;) {
      walked_[edge] = 1;
      at = edges_[edge][0] == at ? edges_[edge][1] : edges_[edge][0];
      loop.closed = at == from && !has_branch(at);
      if (loop.closed) return loop;
      loop.vertices.push_back(at);
      if (has_branch(at)) return loop;
      const auto both = around(at);
      edge = both[0].second == edge ? both[1].second : both[0].second;
    }
  }

 private:
  std::span<const std::pair<std::uint32_t, std::uint32_t>> around(std::uint32_t vertex) const {
    const auto first = std::lower_bound(at_vertex_.begin(), at_vertex_.end(), std::pair(vertex, 0u));
    auto last = first;
    while (last != at_vertex_.end() && last->first == vertex) ++last;
    return {first, last};
  }

  std::vector<std::array<std::uint32_t, 2>> edges_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> at_vertex_;
  std::vector<std::uint8_t> walked_;
};

}  // namespace

std::vector<BorderLoop> border_loops(const Surface& surface) {
  BorderEdges edges(surface);
  std::vector<BorderLoop> loops;
  for (std::uint32_t edge = 0; edge < edges.count(); ++edge)
    for (const auto v : edges.ends(edge))
      if (!edges.is_walked(edge) && edges.has_branch(v)) loops.push_back(edges.walk(edge, v));
  for (std::uint32_t edge = 0; edge < edges.count(); ++edge)
    if (!edges.is_walked(edge)) loops.push_back(edges.walk(edge, edges.ends(edge)[0]));
  return loops;
}

}  // namespace vdb_offset
