// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bytes/chunked_output.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::io {

/// An iso-surface with the attributes that it takes from the source (see io/derived_file.h); normals are gradients of
/// phi.
Pieces convert(const MeshFile& source, Format target, const IsoResult& iso, const Transported& transported,
               const Rounding& precision, WriteResult& result);

/// An iso-surface of a mesh that comes from no file.
Pieces convert(Format target, const IsoResult& iso, const Rounding& precision);

/// A hollow solid. The skin that is the source has all attributes that the format can hold; the other one, `iso`,
/// has the colours and materials of the closest points of the source.
Pieces convert(const MeshFile& source, Format target, const Hollow& hollow, const IsoResult& iso, WriteResult& result);

/// A hollow solid of plain polygons.
Pieces convert(Format target, const Hollow& hollow, std::optional<double> unit_micrometres, WriteResult& result);

}  // namespace vdb_offset::io
