#pragma once

#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/pieces.h"

namespace vdb_offset::io {

/// A plain mesh as a file of that format. PLY: binary, doubles. STL: binary, triangles. The pieces refer to `mesh`.
Pieces encode(Format format, PolygonView mesh, const Precision& precision);

/// What stays behind when a file becomes one of another format, in words; empty if nothing.
std::string lost_on_conversion(const MeshFile& source, Format target);

}  // namespace vdb_offset::io
