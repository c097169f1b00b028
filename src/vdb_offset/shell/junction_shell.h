#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/base/rounding.h"
#include "vdb_offset/sheets/sheet_sides.h"
#include "vdb_offset/shell.h"

namespace vdb_offset {

/// What a shell is made of where more sheets meet than two sides can tell apart.
struct JunctionInput {
  Sheets sheets;                            ///< Of the faces that it is made of.
  std::span<const Vec3d> outer, inner;      ///< Skins that are valid with all junctions where they are in the mesh.
  std::span<const std::uint8_t> junctions;  ///< Of each vertex: 1 at a junction (see find_junctions()).
  WeldOptions weld;
  Rounding precision;
  bool to_be_valid = true;  ///< What folds or crosses there goes back towards those skins.
};

/// A shell with a vertex for each wedge of space at a junction, where the skins of the sheets around it meet: at the
/// intersection of their planes ("mitred"), no farther than four thicknesses away. Skins make room for that: around
/// junctions, within six thicknesses and all over flat sheets that end there, vertices lie on their faces' planes
/// at the thickness as well, and are moved along these.
/// Faces, but for the rim's, are those of `sheets`. Its facts are not counted yet, but for the rim's and junctions'.
Shell make_junction_shell(const JunctionInput& input);

}  // namespace vdb_offset
