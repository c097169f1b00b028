// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bytes/chunked_output.h"
#include "document/new_normals.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// The source's own bytes, with other coordinates where a vertex moved and other normals where there are new ones. The
/// pieces refer to `source` and `positions`; those of a text begin where cut_at_lines() cuts it.
Pieces rewrite_in_place(const MeshFile& source, std::span<const Vec3d> positions, const Rounding& precision,
                        NewNormals normals = {});

/// A text whose lines end with line feeds, with the line ends of a source.
Pieces with_line_ends_of(const MeshFile& source, Pieces pieces);

}  // namespace vdb_offset::io
