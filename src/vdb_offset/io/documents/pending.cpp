// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/error.h"
#include "vdb_offset/io/documents/documents.h"

namespace vdb_offset::io {
void parse_gltf(MeshFile& f) { throw InvalidInput(f.path + ": pending"); }
Pieces to_glb(const SharedContent&) { throw InvalidInput("pending"); }
Pieces to_gltf(const SharedContent&) { throw InvalidInput("pending"); }
void parse_3mf(MeshFile& f) { throw InvalidInput(f.path + ": pending"); }
void parse_vtk(MeshFile& f) { throw InvalidInput(f.path + ": pending"); }
void parse_by_assimp(MeshFile& f) { throw InvalidInput(f.path + ": pending"); }
std::optional<double> unit_of_3mf(const std::string& path) { throw InvalidInput(path + ": pending"); }
Pieces to_3mf(const SharedContent&) { throw InvalidInput("pending"); }
Pieces to_vtk(Format, const SharedContent&) { throw InvalidInput("pending"); }
}  // namespace vdb_offset::io
