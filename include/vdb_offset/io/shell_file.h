// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::io {

/// Writes a shell of the source's mesh (shell.h), with its faces in their order, as write_mesh() does.
///
/// In the source's own format both skins have all that the source's vertices and faces have; numbers of vertices that
/// did not move stay as they are, and the inner skin's normals point the other way.
/// - OBJ: groups `outer` and `inner`, each in front of the source's own names, and `rim`; materials and objects are the
///   source's on every part, smoothing groups on the skins. Comments, lines and points and all that is not of faces
///   comes once; lines and points join the skin that is the source. The rim has the border's texture coordinates, and
///   no normals.
/// - PLY: a face property `part`, 0 (outer), 1 (inner) or 2 (rim); faces of the rim have the values of the face at
///   their border. Other elements come once and refer to the outer skin.
/// - STL: ASCII: a solid for each part; binary: the rim's facets have the attribute bytes of those at their border.
/// - OFF: the rim's faces have the colours of those at their border.
/// \pre the shell was made of the source's polygons. \throw as write_mesh(), and InvalidInput for a shell of another
/// mesh.
VDB_OFFSET_API WriteResult write_shell(const Target& target, const MeshFile& source, const Shell& shell);
inline WriteResult write_shell(const std::string& path, const MeshFile& source, const Shell& shell,
                               const WriteOptions& options = {}) {
  return write_shell(target_of(path, source, options, Faces::Others), source, shell);
}

/// Writes a shell of plain polygons: positions, faces and, in OBJ and PLY, the parts. \throw as write_mesh()
VDB_OFFSET_API WriteResult write_shell(const Target& target, const Shell& shell);
inline WriteResult write_shell(const std::string& path, const Shell& shell, const WriteOptions& options = {}) {
  return write_shell(target_of(path, options), shell);
}

}  // namespace vdb_offset::io
