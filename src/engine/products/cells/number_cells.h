// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "products/layers/layer_points.h"
#include "space/surface/weld.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/layers.h"

namespace vdb_offset {

/// The columns of cells, on faces that run so that their normals point into the layers.
struct NumberedColumns {
  std::vector<std::uint32_t> corners;  ///< Of all columns: points of the wall.
  std::vector<std::uint32_t> begin{0};
  std::vector<std::uint32_t> face;      ///< Of each column: the input's face that it is on.
  std::vector<std::uint8_t> open;       ///< Of each corner: 1 if the side from it to the next one is on the boundary.
  std::vector<std::uint32_t> cells{0};  ///< Number of a layer's cells before each column; one more than columns.
  std::vector<std::uint64_t> size;      ///< Number of corners of those cells; one more than columns.

  std::size_t count() const { return face.size(); }
  std::span<const std::uint32_t> ring(std::size_t c) const {
    return std::span(corners).subspan(begin[c], begin[c + 1] - begin[c]);
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

  std::size_t in_layer() const { return columns.cells.back(); }
  std::size_t count() const { return in_layer() * layers; }
  std::size_t point_count() const { return points.wall() + std::size_t{points.risen()} * layers; }
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
