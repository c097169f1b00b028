// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "space/sheets/sheet_sides.h"

namespace vdb_offset {

/// The corners of wedges at a mesh's vertices (see sheet_sides.h) if sheets are as thick as they should be.
struct WedgePositions {
  std::vector<std::uint8_t> is_near;  ///< Of each wedge: 1 at a junction or near one. The others have no position here.
  std::vector<Vec3d> position;        ///< Of each wedge: mitered, with room made for junctions.
  std::vector<double> weight;         ///< Of each wedge: of that position against the offset's, 1 at junctions.
};

/// Finds the corners of wedges.
/// \param junctions of each of the mesh's vertices: 1 if it is at a junction
WedgePositions find_wedge_positions(const Sheets& sheets, const SheetSides& sides,
                                    std::span<const std::uint8_t> junctions);

}  // namespace vdb_offset
