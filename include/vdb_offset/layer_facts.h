#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vdb_offset/volume_mesh.h"

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

/// What is measured of the cells over layers.
struct LayerQuality {
  std::vector<CellType> types;  ///< Of a layer's cells.
  /// Of all cells, layer by layer: see cell_quality.h.
  std::vector<float> scaled_jacobian, aspect_ratio;
  std::vector<float> wall_angle;  ///< Degrees, of a layer's cells, in whose column it is: see cell_quality.h.
  double volume = 0;              ///< Of all cells, world units^3; of those in a plane their area, ^2.
  std::size_t points = 0;
  bool plane = false;
  /// On curves: the shortest segment of any layer, as a share of the one that it stands on.
  double least_segment = 1;
};

}  // namespace vdb_offset
