#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/layers/layers.h"
#include "vdb_offset/surface/weld.h"
#include "vdb_offset/volume/patch_names.h"

namespace vdb_offset {

/// What became of a face of the mesh.
enum class FaceRole : std::uint8_t {
  Bare,        ///< Asked to carry nothing.
  Full,        ///< One cell in each layer, or two prisms on a split quad; none of its corners is flat.
  Transition,  ///< Some of its corners keep no height: its cells are those of other types that close the layers there.
  Flat,        ///< None of its corners keeps any height: left out.
  Degenerate,  ///< Left out: fewer than three places, or one that it comes by twice.
  Repeated,    ///< Left out: over the corners of an earlier one, either way round.
};
inline constexpr std::size_t kFaceRoleCount = 6;
const char* name(FaceRole role);

/// What making cells found.
struct LayerCellFacts {
  std::vector<FaceRole> role;        ///< Of each face of the input.
  std::vector<std::uint8_t> cells;   ///< Of each face of the input: how many in each layer.
  std::size_t turned_faces = 0;      ///< Whose cells lie on the side that the heights' sign does not say.
  std::size_t border_sides = 0;      ///< In each layer, on edges of one face that carries cells.
  std::size_t unpaired_sides = 0;    ///< On other edges: no cell of opposite direction is left for them.
  std::size_t split_points = 0;      ///< Of the wall: added so that unpaired sides have points of their own.
  std::size_t coincident_sides = 0;  ///< Unpaired ones that have the points of other sides nevertheless.
};

/// The faces that carry cells, which run so that their normals point into the layers.
struct LayerColumns {
  std::vector<std::uint32_t> corners;  ///< Points of the wall.
  std::vector<std::uint32_t> begin{0};
  std::vector<std::uint32_t> face;      ///< Of the input.
  std::vector<std::uint8_t> open;       ///< Of each corner: 1 if the side from it to the next one is on the boundary.
  std::vector<std::uint32_t> cells{0};  ///< Of a layer, before each column; one more than columns.
  std::vector<std::uint64_t> size;      ///< The same of the cells' corners.

  std::size_t count() const { return face.size(); }
  std::span<const std::uint32_t> ring(std::size_t c) const {
    return std::span(corners).subspan(begin[c], begin[c + 1] - begin[c]);
  }
  std::uint32_t next(std::size_t c, std::uint32_t corner) const {
    return corner + 1 < begin[c + 1] ? corner + 1 : begin[c];
  }
};

/// The points: 0 .. wall() - 1 on the wall, and risen() in each layer above it.
struct LayerPoints {
  std::vector<std::uint32_t> vertex;  ///< Of the mesh, of each point of the wall.
  /// Of each point of the wall: its number among those that rise; kNone for flat ones.
  std::vector<std::uint32_t> in_layer;
  std::vector<std::uint32_t> rising;  ///< The points of the wall that rise.

  std::uint32_t wall() const { return static_cast<std::uint32_t>(vertex.size()); }
  std::uint32_t risen() const { return static_cast<std::uint32_t>(rising.size()); }
  bool flat(std::uint32_t point) const { return in_layer[point] == kNone; }
  std::uint32_t at(std::uint32_t point, std::size_t layer) const {
    return layer == 0 || flat(point) ? point
                                     : wall() + static_cast<std::uint32_t>(layer - 1) * risen() + in_layer[point];
  }
};

/// The cells over the faces of a mesh, numbered: each follows from its column and its layer.
struct LayerCells {
  std::size_t layers = 0;
  LayerColumns columns;
  LayerPoints points;
  LayerCellFacts facts;

  std::size_t in_layer() const { return columns.cells.back(); }
  std::size_t count() const { return in_layer() * layers; }
  std::size_t point_count() const { return points.wall() + std::size_t{points.risen()} * layers; }
  /// Whether a column has prisms alone, one in each layer.
  bool is_of_prisms(std::size_t column) const;
};

/// \throw InvalidInput for polygons that are none, and layers that cannot be this mesh's, by their counts and places.
void require_layers_of(PolygonView mesh, const LayersResult& layers);

/// Finds the cells that stand on a mesh's faces, in an order that does not depend on the number of threads: see
/// make_cells(). \throw InvalidInput as require_layers_of(), and for more than 2^32 points or cells.
LayerCells number_cells(PolygonView mesh, const LayersResult& layers);

}  // namespace vdb_offset
