// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "bytes/chunked_output.h"
#include "document/encode.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

// The readers of all formats. Each takes a file with `path`, `format` and `bytes` set, and fills in `polygons`,
// `precision`, `extras`, `remarks`, `normal_count`, `unit_micrometres` and `document`.
// \throw InvalidInput for content that is no such mesh.
void parse_obj(MeshFile& file);
void parse_off(MeshFile& file);
void parse_ply(MeshFile& file);
void parse_stl(MeshFile& file);
void parse_gltf(MeshFile& file);  ///< .gltf and .glb
void parse_3mf(MeshFile& file);
void parse_vtk(MeshFile& file);  ///< .vtp, .vtk and .vtu
void parse_by_assimp(MeshFile& file);
void parse_cad(MeshFile& file, const CadReading& how);  ///< .step, .iges and .brep; fills in `exact`, too

void parse_vdb(MeshFile& file, const VdbReading& how);  ///< .vdb; fills in `voxel_size`, too

/// The unit of glTF's coordinates.
inline constexpr double kMetre = 1e6;  // micrometres
std::optional<double> unit_of_3mf(const std::string& path);

// New files of a content, which encode() calls; its `with` has been fitted to the format (see fit_to_format()).
Pieces to_obj(const SharedContent& content);
Pieces to_off(const SharedContent& content);
Pieces to_ply(const SharedContent& content);
Pieces to_stl(const SharedContent& content);
Pieces to_glb(const SharedContent& content);
Pieces to_gltf(const SharedContent& content);
Pieces to_3mf(const SharedContent& content);
Pieces to_vtk(Format format, const SharedContent& content);  ///< .vtp, .vtk or .vtu

}  // namespace vdb_offset::io
