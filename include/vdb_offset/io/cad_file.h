// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/statistics.h"

namespace vdb_offset::io {

struct CadWriting {
  double fit_tolerance = 0;  ///< The most distance of a fitted face from its offset, world units; 0: 1e-4 distances.
  std::vector<std::uint8_t> only;  ///< Of each face of the mesh: 1 if it is offset; the others stay. Empty: all are.
  bool faceted = false;            ///< Where no solid comes of the faces, write one of triangles.
};

/// Whether a file of that name is a CAD model that can be written: .step, .stp or .brep.
VDB_OFFSET_API bool is_cad_output(const std::string& path);

/// Writes the offset of a CAD model as one, through a temporary file that is renamed at the end: each face becomes one
/// over the same (u, v), and where these do not make a valid solid, faces or triangles. The file is read again before.
/// \param distance towards the outside, world units; negative is inward
/// \param positions of the offset mesh
/// \throw InvalidInput if the source is no CAD model, or only a part of one of its faces is offset; Error if nothing
/// could be made; WriteError
VDB_OFFSET_API CadFileFacts write_cad(const std::string& path, const MeshFile& source, double distance,
                                      std::span<const Vec3d> positions, const CadWriting& how = {});

}  // namespace vdb_offset::io
