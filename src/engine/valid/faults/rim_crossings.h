// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "motion/parts/constrained_surface.h"
#include "valid/faults/source_crossings.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/distances.h"

namespace vdb_offset {

/// Finds where the rim of a shell meets the skin that moves, the other skin, or itself, as the border's vertices are
/// moved about: elsewhere than in edges and corners that they share, and not where sheets of the source cross (see
/// source_crossings.h). The rim has the triangles that make_shell() gives it.
class RimCrossings {
 public:
  /// Keeps references to all.
  /// \param other_skin positions of the vertices in the skin that does not move
  /// \param positions of the vertices in the skin that moves
  /// \param distances of the vertices: the sign shows which skin is the outer one
  RimCrossings(const ConstrainedSurface& constrained, std::span<const Vec3d> other_skin,
               std::span<const Vec3d> positions, const Distances& distances);

  /// Finds anew what the rim meets around vertices that have moved. The finders are those of both skins.
  /// \param touched the triangles around the moved vertices; \pre both sorted, each once
  /// \pre `skin.update(touched)` was the last update of `skin`
  void find(std::span<const std::uint32_t> moved, std::span<const std::uint32_t> touched, const CrossingFinder& skin,
            const CrossingFinder& other_skin, const SourceCrossings& source_crossings);

  std::size_t count() const { return with_skin_.size() + with_other_.size() + with_rim_.size(); }

  /// Calls visit(vertex) for each vertex that may give way: the ends of the border's edges whose rim meets something,
  /// and the corners of the triangles that it meets and that move.
  template <class Visit>
  void for_each_corner(Visit&& visit) const;

 private:
  /// A border edge, in the direction in which its triangle runs.
  struct Edge {
    std::uint32_t from, to;
    std::uint32_t triangle;
  };
  using Pairs = std::vector<TrianglePair>;

  void find_edges();
  void list_vertices();
  void put(std::uint32_t border_vertex);
  std::uint32_t border_index(std::uint32_t vertex) const;
  std::vector<std::uint32_t> triangles_at(std::span<const std::uint32_t> moved) const;
  const Edge& edge(std::uint32_t rim_triangle) const { return edges_[rim_triangle / 2]; }
  std::array<Vec3d, 3> corners(std::uint32_t rim_triangle) const;

  const ConstrainedSurface& constrained_;
  const Surface& surface_;
  std::span<const Vec3d> other_skin_, positions_;
  const Distances& distances_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> vertices_;  // at the border; sorted
  std::vector<Vec3d> skins_;             // of each of these: its position on the outer skin, then on the inner one
  Surface rim_;                          // two triangles for each edge; only these, and the frame
  std::optional<CrossingFinder> finder_;
  // Pairs of a triangle of the rim, and one of the skin that moves, of the other skin, or of the rim.
  Pairs with_skin_, with_other_, with_rim_;
};

template <class Visit>
void RimCrossings::for_each_corner(Visit&& visit) const {
  const auto visit_edge = [&](std::uint32_t rim_triangle) {
    visit(edge(rim_triangle).from);
    visit(edge(rim_triangle).to);
  };
  for (const auto* pairs : {&with_skin_, &with_other_, &with_rim_})
    for (const auto& [rim_triangle, other] : *pairs) visit_edge(rim_triangle);
  for (const auto& [rim_triangle, other] : with_skin_)
    for (const auto v : surface_.triangles[other]) visit(v);
  for (const auto& [rim_triangle, other] : with_rim_) visit_edge(other);
}

}  // namespace vdb_offset
