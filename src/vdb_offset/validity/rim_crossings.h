#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/parts/constrained_surface.h"
#include "vdb_offset/validity/source_crossings.h"
#include "vdb_offset/validity/triangle_crossings.h"

namespace vdb_offset {

/// Where the rim of a shell meets what it must not, as the border's vertices are moved about: the skin that moves, the
/// other one, and the rim itself, elsewhere than in edges and corners that they share, but where sheets of the source
/// cross (see source_crossings.h). The rim has the triangles that make_shell() gives it.
class RimCrossings {
 public:
  /// `places` are where the body's vertices stand, `other_skin` where the rim leads, `distances` theirs: the sign tells
  /// which skin is the outer one. Keeps references to all.
  RimCrossings(const ConstrainedSurface& constrained, std::span<const Vec3d> other_skin, std::span<const Vec3d> places,
               const Distances& distances);

  /// Judges anew what has moved: vertices, and the triangles around them; sorted, no two the same. The finders are of
  /// both skins, and up to date.
  void find(std::span<const std::uint32_t> moved, std::span<const std::uint32_t> touched, const CrossingFinder& skin,
            const CrossingFinder& other_skin, const SourceCrossings& source_crossings);

  std::size_t count() const { return with_skin_.size() + with_other_.size() + with_rim_.size(); }

  /// Calls visit(vertex) for each vertex that may give way: the corners of the border's edges there, and of the
  /// triangles in their way that have moved.
  template <class Visit>
  void for_each_corner(Visit&& visit) const;

 private:
  /// An edge with one face, in the direction of that.
  struct Edge {
    std::uint32_t from, to;  ///< The body's vertices.
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
  std::span<const Vec3d> other_skin_, places_;
  const Distances& distances_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> vertices_;  // of the body, at the border; sorted
  std::vector<Vec3d> skins_;             // where each of these is on the outer skin, and on the inner one
  Surface rim_;                          // two triangles for each edge; only those, and the frame
  std::optional<CrossingFinder> finder_;
  // A triangle of the rim first, then one of the skin that moves, of the other one, or of the rim again.
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
