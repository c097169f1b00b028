// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "products/layers/column_cells.h"
#include "products/layers/layer_points.h"
#include "space/surface/weld.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/layers.h"

namespace vdb_offset {

/// The numbers of a layer's cells.
struct CellNumbers {
  std::vector<std::uint32_t> cells{0};  ///< Number of the layer's cells before each column; one more than columns.
  std::vector<std::uint64_t> size;      ///< Number of corners of those cells; one more than columns.
};

/// The columns of cells, on faces that run so that their normals point into the layers.
struct NumberedColumns {
  std::vector<std::uint32_t> corners;  ///< Of all columns: stacks.
  std::vector<std::uint32_t> begin{0};
  std::vector<std::uint32_t> face;    ///< Of each column: the input's face that it is on.
  std::vector<std::uint8_t> open;     ///< Of each corner: 1 if the side from it to the next one is on the boundary.
  std::vector<SideSplit> splits;      ///< Of each corner: of that side, in the first layer. Empty if none is.
  std::vector<std::uint32_t> middle;  ///< Of each column: the point in the middle of its first cell, or kNone.
  CellNumbers first, upper;           ///< Of the first layer, and of any other. `first` is not set if they are alike.

  std::size_t count() const { return face.size(); }
  std::span<const std::uint32_t> ring(std::size_t c) const {
    return std::span(corners).subspan(begin[c], begin[c + 1] - begin[c]);
  }
  bool is_first_alike() const { return first.size.empty(); }
  const CellNumbers& in(std::size_t layer) const { return layer == 0 && !is_first_alike() ? first : upper; }
  /// The cells of column c in a layer.
  ColumnCells column(const LayerPoints& points, std::size_t c, std::size_t layer) const {
    if (splits.empty()) return {points, ring(c), layer};
    return {points, ring(c), layer, {std::span(splits).subspan(begin[c], begin[c + 1] - begin[c]), middle[c]}};
  }
  /// The corner of column c that follows a corner, both as indices into `corners`.
  std::uint32_t next(std::size_t c, std::uint32_t corner) const {
    return corner + 1 < begin[c + 1] ? corner + 1 : begin[c];
  }
};

/// The numbers of the cells over the faces of a mesh: a cell's number follows from its column and its layer.
struct LayerCells {
  std::size_t layers = 0;
  NumberedColumns columns;
  LayerPoints points;
  LayerCellFacts facts;

  std::uint32_t middles = 0;  ///< Points in the middle of cells of the first layer. They come last.

  std::size_t in_layer(std::size_t layer) const { return columns.in(layer).cells.back(); }
  std::size_t count() const { return first_in(layers); }
  /// The number of the first cell in a layer.
  std::size_t first_in(std::size_t layer) const {
    return layer == 0 ? 0 : in_layer(0) + (layer - 1) * std::size_t{columns.upper.cells.back()};
  }
  /// The number of a column's first cell in a layer.
  std::size_t cell(std::size_t layer, std::size_t column) const {
    return first_in(layer) + columns.in(layer).cells[column];
  }
  std::size_t risen_points() const { return points.wall() + std::size_t{points.risen()} * layers; }
  std::size_t point_count() const { return risen_points() + middles; }
  /// Whether a column has prisms alone, one in each layer.
  bool is_of_prisms(std::size_t column) const;
};

/// \throw InvalidInput for faces that are no polygons, and for layers that cannot be this mesh's, by their counts and
/// positions.
void require_layers_of(PolygonView mesh, const LayersResult& layers);

/// Numbers the cells that stand on a mesh's faces (see make_cells()), in an order that does not depend on the number of
/// threads. \throw InvalidInput as require_layers_of(), and for more than 2^32 points or cells.
LayerCells number_cells(PolygonView mesh, const LayersResult& layers);

}  // namespace vdb_offset
