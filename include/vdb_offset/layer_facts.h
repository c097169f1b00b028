// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/volume_mesh.h"

namespace vdb_offset {

/// What became of a face of the mesh.
enum class FaceRole : std::uint8_t {
  Bare,        ///< It was not asked to carry layers.
  Full,        ///< It carries one cell in each layer, or two prisms on a split quad; none of its corners is flat.
  Transition,  ///< Some of its corners keep no height: it carries cells of other types, which close the layers there.
  Flat,        ///< None of its corners keeps any height: it is left out.
  Degenerate,  ///< It has fewer than three positions, or one of them twice: it is left out.
  Repeated,    ///< It lies over the corners of an earlier face, either way round: it is left out.
};

inline constexpr std::size_t kFaceRoleCount = 6;

/// The role's name in reports.
VDB_OFFSET_API const char* name(FaceRole role);

/// What making cells found.
struct LayerCellFacts {
  std::vector<FaceRole> role;        ///< Of each face of the input.
  std::vector<std::uint8_t> cells;   ///< Of each face of the input: the number of cells in each layer.
  std::size_t turned_faces = 0;      ///< Faces whose cells lie on the side opposite to the sign of the heights.
  std::size_t border_sides = 0;      ///< Sides of a layer's cells on edges of one face that carries cells.
  std::size_t unpaired_sides = 0;    ///< Sides of a layer's cells on other edges, without a cell of opposite direction.
  std::size_t split_points = 0;      ///< Points of the wall that were added for unpaired sides.
  std::size_t coincident_sides = 0;  ///< Unpaired sides that have the points of other sides nevertheless.
};

/// Measures of the cells over layers.
struct LayerQuality {
  std::vector<CellType> types;  ///< Of the cells of one layer: all layers have the same.
  /// Of all cells, layer by layer (see cell_quality.h).
  std::vector<float> scaled_jacobian, aspect_ratio;
  /// Degrees, of the cells of one layer: at the wall, in the column that the cell is in (see cell_quality.h).
  std::vector<float> wall_angle;
  double volume = 0;  ///< Of all cells, world units^3; of cells in a plane their area, world units^2.
  std::size_t points = 0;
  bool plane = false;  ///< The layers are on curves.
  /// On curves: the shortest segment of any layer, as a share of the segment of the wall that it stands on.
  double least_segment = 1;
};

}  // namespace vdb_offset
