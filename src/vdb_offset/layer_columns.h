#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/layer_cells.h"

namespace vdb_offset {

/// The faces that carry cells, which run so that their normals point into the layers.
struct LayerColumns {
  std::vector<std::uint32_t> corners;  // places, by a vertex that stands there; later points of the wall
  std::vector<std::uint32_t> begin{0};
  std::vector<std::uint32_t> face;   // of the input
  std::vector<std::uint8_t> open;    // of each corner: 1 if the side from it to the next one is on the boundary
  std::vector<std::uint32_t> cells;  // of a layer, before each column; one more than columns
  std::vector<std::uint64_t> size;   // the same of the cells' corners

  std::size_t count() const { return face.size(); }
  std::span<const std::uint32_t> ring(std::size_t c) const {
    return std::span(corners).subspan(begin[c], begin[c + 1] - begin[c]);
  }
  std::uint32_t next(std::size_t c, std::uint32_t corner) const {
    return corner + 1 < begin[c + 1] ? corner + 1 : begin[c];
  }
};

/// The points: 0 .. wall() - 1 on the wall, and `risen` in each layer above it.
struct LayerPoints {
  std::vector<std::uint32_t> vertex;  // of the mesh, of each point of the wall
  std::vector<std::uint32_t>
      in_layer;  // of each point of the wall: its number among those that rise; kNone for flat ones
  std::uint32_t risen = 0;

  std::uint32_t wall() const { return static_cast<std::uint32_t>(vertex.size()); }
  bool flat(std::uint32_t point) const { return in_layer[point] == kNone; }
  std::uint32_t at(std::uint32_t point, std::size_t layer) const {
    return layer == 0 || flat(point) ? point : wall() + static_cast<std::uint32_t>(layer - 1) * risen + in_layer[point];
  }
};

/// The faces over which layers rise, on the side where they do; facts know what became of the others. `place` is the
/// first vertex at each vertex's place, `flat` tells of each vertex whether it rises in no layer.
LayerColumns find_columns(PolygonView mesh, const LayersResult& layers, std::span<const std::uint32_t> place,
                          std::span<const std::uint8_t> flat, LayerCellFacts& facts);

/// Numbers the points, and replaces the columns' places by those of the wall, where sides that have no partner get
/// points of their own. Tells the columns which of their sides are open.
LayerPoints number_points(std::span<const std::uint8_t> flat, LayerColumns& columns, LayerCellFacts& facts);

}  // namespace vdb_offset
