// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ground/numbers/rounding.h"
#include "space/sheets/sheet_sides.h"
#include "vdb_offset/shell.h"

namespace vdb_offset {

/// The input of make_junction_shell().
struct JunctionInput {
  Sheets sheets;                            ///< The faces that the shell is made from.
  std::span<const Vec3d> outer, inner;      ///< Skins that are valid if all junctions stay where they are in the mesh.
  std::span<const std::uint8_t> junctions;  ///< Of each vertex: 1 at a junction (see find_junctions()).
  WeldOptions weld;
  Rounding precision;
  bool to_be_valid = true;  ///< Corners of faces that fold or cross are taken back towards those skins.
};

/// Makes a shell in which each wedge at a junction has a vertex of its own, where the skins of the sheets around it
/// meet: at the intersection of their planes ("mitered"), no farther than four thicknesses away. Skins make room for
/// that: within six thicknesses of junctions, and all over flat sheets that end there, vertices lie on their faces'
/// planes at the thickness as well, and are moved along these. Faces, but for those of the rim, are those of `sheets`.
/// Of the facts, only those of the rim and the junctions are counted.
Shell make_junction_shell(const JunctionInput& input);

}  // namespace vdb_offset
