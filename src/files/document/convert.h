// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "bytes/chunked_output.h"
#include "document/encode.h"
#include "document/new_normals.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// The source as a file of another format: other positions, other normals where a face moved if asked for, and all that
/// the format can hold besides. `result` receives the names of what it cannot hold. The pieces refer to `source` and
/// `positions`.
Pieces convert(const MeshFile& source, Format target, std::span<const Vec3d> positions, const Rounding& precision,
               Normals normals, WriteResult& result);

// The functions below are for all conversions of mesh files, to shells and iso-surfaces as well.

/// Replaces the normals of faces that moved. They are computed from the coordinates as written, in single precision.
void update_normals(const NewNormals& computed, std::vector<Vec3d>& normals, WriteResult& result);

/// Drops attributes that the format cannot hold, and names them in `attributes.lost`.
void fit_to_format(Format target, PolygonView mesh, Attributes& attributes);

/// Encodes the content without attributes that are not finite or that the format cannot hold; `result` names these.
Pieces encode_fitting(const MeshFile& source, Format target, const std::shared_ptr<Content>& content,
                      WriteResult& result);

/// Whether a format has names or properties of faces, for the parts of a solid that has these attributes.
bool keeps_parts(Format format, const Attributes& with);

/// The name of what formats without names for parts lose.
inline constexpr const char* kShellParts = "the parts of the shell (outer, inner and rim follow each other)";

}  // namespace vdb_offset::io
