#pragma once

#include <span>
#include <vector>

#include "vdb_offset/sheets/sheet_sides.h"

namespace vdb_offset {

/// Where wedges of space at a mesh's vertices (see sheet_sides.h) have their corners if sheets are as thick as they
/// should be.
struct WedgePlaces {
  std::vector<std::uint8_t> is_near;  ///< Of each wedge: 1 at a junction or near one. All that follows is for these.
  std::vector<Vec3d> place;           ///< Mitred, with room made for junctions.
  std::vector<double> weight;         ///< How far that counts beside where an offset would be: 1 at junctions.
};

/// `junctions` is of each of the mesh's vertices.
WedgePlaces place_wedges(const Sheets& sheets, const SheetSides& sides, std::span<const std::uint8_t> junctions);

}  // namespace vdb_offset
