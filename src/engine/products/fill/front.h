// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_offset/fill.h"

namespace vdb_offset {

/// A triangle on the border of what is to be filled: points of the volume mesh, ccw seen from outside of that.
struct FrontTriangle {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t cell;   ///< The cell behind it; kNone: it is on the boundary.
  std::uint32_t patch;  ///< Then its patch.
};

/// A face of a cell that is parted into triangles of the front.
struct PartedFace {
  std::uint32_t cell;
  std::vector<std::uint32_t> corners;  ///< As the cell has them: ccw seen from outside of it.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// What layers leave to be filled, but for the farfield.
struct FillFront {
  std::vector<FrontTriangle> triangles;
  std::vector<PartedFace> parted;
};

/// Takes the patch "outer" from the mesh, and the sides too where a part of the wall carries layers, and adds what of
/// the wall carries none. On faces of four corners pyramids are put, or they are parted, as all larger faces are. The
/// front is open where the wall is.
FillFront take_front(PolygonView mesh, const LayersResult& layers, const LayerCellFacts& facts, const WallNames& names,
                     FillQuads quads, VolumeMesh& volume);

/// Gives the cells with parted faces these triangles in place of them: they become polyhedra.
void part_cells(const std::vector<PartedFace>& parted, VolumeMesh& volume);

}  // namespace vdb_offset
