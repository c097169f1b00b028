// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "ground/numbers/rounding.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// New values for a file's normals.
struct NewNormals {
  std::vector<Vec3d> value;     ///< One for each normal of the file, of unit length; zero for one that stays as it is.
  std::size_t disagreeing = 0;  ///< Normals shared by vertices that have different ones now.
};

/// Whether a position differs from the source's at the file's precision.
inline bool has_moved(const Vec3d& before, const Vec3d& after, const Rounding& precision) {
  return !(after == before) && !(precision(before, after) == before);
}

/// Faces of a file over other vertices than its own, as in a skin of a shell. Empty spans: all faces, over the file's
/// vertices.
struct PlacedFaces {
  std::span<const std::uint32_t> faces;    ///< The faces that count.
  std::span<const std::uint32_t> corners;  ///< For each of the file's corners the index of its position.
  std::span<const std::uint32_t> origin;   ///< For each position the file's vertex that it comes from.
};

/// Computes those normals of the file that a corner of a face names of which a vertex moved: the sum, over the corners
/// that name a normal, of the corner's face normal times its angle. Of documents that are no rows
/// (glTF, VTK), vertices that had one position and one normal name one normal. Computed from positions as they are
/// written.
NewNormals new_normals(const MeshFile& source, std::span<const Vec3d> positions, const Rounding& precision,
                       const PlacedFaces& placed = {});

}  // namespace vdb_offset::io
