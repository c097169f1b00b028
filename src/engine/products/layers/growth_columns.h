// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "motion/parts/constrained_surface.h"
#include "products/layers/column_cells.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The columns of cells that stand on the faces of a constrained surface's moving part, on its welded vertices.
///
/// A column's base runs as its face's triangles do in the surface, seen from where they face. Faces that the surface
/// leaves out, as repeated ones, and those without area carry none. A quad with a corner that is straight or turns
/// inwards carries two columns of prisms.
class GrowthColumns {
 public:
  /// \param mesh the one that the surface was built from
  /// \param source positions of the surface's vertices
  /// \param foot of each of the mesh's vertices: see LayersResult. Empty: no edge is opened
  GrowthColumns(PolygonView mesh, const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                CellRules rules = CellRules::AnySolver, std::span<const std::uint32_t> foot = {});

  std::size_t size() const { return begin_.size() - 1; }
  /// The vertices of a column's base, in a ring.
  std::span<const std::uint32_t> base(std::size_t column) const {
    return std::span(corners_).subspan(begin_[column], begin_[column + 1] - begin_[column]);
  }
  /// The input's faces that carry no column because they have no area, in rising order.
  std::span<const std::uint32_t> without_area() const { return without_area_; }
  /// A quad on which two columns stand, on the triangles on both sides of its diagonal from corner `from`, 0 or 1.
  struct SplitQuad {
    std::uint32_t face, from;
  };
  std::span<const SplitQuad> split_quads() const { return split_quads_; }
  /// Whether a vertex shares its point of the wall with others.
  bool is_opened(std::uint32_t vertex) const { return !opened_.empty() && opened_[vertex] != 0; }
  /// The columns that a vertex is a corner of.
  std::span<const std::uint32_t> around(std::uint32_t vertex) const {
    return std::span(incident_).subspan(incident_begin_[vertex], incident_begin_[vertex + 1] - incident_begin_[vertex]);
  }

  /// The normal of a column's base in one layer at its corner k: that of the two sides there, or of the whole base if
  /// it has five corners or more. Not normalised.
  Vec3d normal(std::size_t column, std::size_t k, const VertexStacks& stacks, std::size_t layer) const;

  /// Whether every cell of a column has a positive volume, and is inside out nowhere. At every corner that is not flat
  /// the edge up, to `side` (1 or -1) of the base, makes less than a right angle with the normals of the faces below
  /// and above, and the cell's scaled Jacobian is above 0 (cell_quality.h). Prisms must not be inside out between their
  /// corners, hexahedra not in their middle either, and quads with flat corners are judged as the triangles that they
  /// are split into, too.
  bool is_valid(std::size_t column, const VertexStacks& stacks, int side) const;
  /// is_valid() of two columns, in half the time where both are of prisms.
  std::array<bool, 2> are_valid(std::size_t column, std::size_t other, const VertexStacks& stacks, int side) const;

 private:
  bool rises_everywhere(std::size_t column, const VertexStacks& stacks, int side) const;
  bool has_valid_cells(std::size_t column, const VertexStacks& stacks, int side) const;
  void find_splits_of(std::size_t column, std::span<const std::uint32_t> ring, const VertexStacks& stacks, int side,
                      std::vector<SideSplit>& splits) const;
  bool is_of_prisms(std::size_t column, const VertexStacks& stacks) const;
  bool take_all(PolygonView mesh, const ConstrainedSurface& constrained, std::span<const Vec3d> source);
  void take_some(PolygonView mesh, const ConstrainedSurface& constrained, std::span<const Vec3d> source);
  void add(PolygonView mesh, const Surface& surface, std::uint32_t triangle, std::span<const Vec3d> source);

  std::vector<std::uint32_t> corners_, begin_{0}, without_area_;
  std::vector<std::uint32_t> incident_, incident_begin_;
  std::vector<SplitQuad> split_quads_;
  void find_fans(std::span<const std::uint32_t> foot);
  bool is_at_fan(std::size_t column) const { return !at_fan_.empty() && at_fan_[column] != 0; }

  CellRules rules_;
  std::vector<std::uint32_t> foot_;   // of each of the surface's vertices, a vertex of the mesh; empty without fans
  std::vector<std::uint8_t> opened_;  // of each of the surface's vertices; empty without fans
  std::vector<SideSplit> splits_;     // of each of corners_; empty if no side is split
  std::vector<std::uint8_t> at_fan_;  // of each column: corners share a point of the wall, or a side is split
  std::vector<std::uint32_t>
      first_vertex_;  // of each of the surface's vertices: the first of the mesh's at its position
};

}  // namespace vdb_offset
