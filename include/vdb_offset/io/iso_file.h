// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/io/attributes.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::io {

/// What a captured mesh is to take of its source.
struct TransportRequest {
  bool texture = true, colours = true, materials = true;
  bool is_required = false;  ///< What is asked for must be there, and the format must have a place for it.
};

/// What a source file has for a captured mesh, as asked for.
struct Transported {
  Attributes attributes;  ///< Without normals: those of the source are not the captured mesh's.
  Materials materials;
};

/// \throw InvalidOption for something required that the source does not have, or the format no place for.
VDB_OFFSET_API Transported read_transported(const MeshFile& source, const TransportRequest& request, Format target);

/// Writes a captured mesh: triangles, normals (OBJ, OFF, PLY), and what it takes of the source.
///
/// Colours of a vertex are those of the closest point of the source, interpolated on its face. Each triangle takes the
/// chart of its texture coordinates, and its material, from the source's face that is closest to its centre; its
/// corners take the texture coordinates of the points of this chart that are closest to them. So the source's seams
/// come along, between triangles and as fine as these; which is why OBJ and PLY may have several texture coordinates
/// for a vertex. In OBJ the faces come material by material.
/// `captured` was made of the source's polygons, for a target that comes from no file. \throw as write_mesh()
VDB_OFFSET_API WriteResult write_iso_surface(const Target& target, const MeshFile& source,
                                             const Transported& transported, const IsoResult& captured);

/// Writes an iso-surface of a mesh that comes from no file: triangles and normals. \throw as write_mesh()
VDB_OFFSET_API void write_iso_surface(const Target& target, const IsoResult& captured);

/// Writes a hollow solid: the skin that is its source with the source's faces in their order and all that the format
/// can hold of them, the other skin, which was captured, with colours and materials of what is closest. OBJ has groups
/// `outer` and `inner`, PLY a face property `part`, 0 or 1. Without a source that is one of the skins: plain polygons.
/// \throw as write_mesh()
VDB_OFFSET_API WriteResult write_hollow(const Target& target, const MeshFile* source, const Hollow& hollow,
                                        const IsoResult& captured);

}  // namespace vdb_offset::io
