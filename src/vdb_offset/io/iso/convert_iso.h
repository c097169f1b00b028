#pragma once

#include "vdb_offset/base/rounding.h"
#include "vdb_offset/hollow.h"
#include "vdb_offset/io/base/chunked_output.h"
#include "vdb_offset/io/iso_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/iso_surface.h"

namespace vdb_offset::io {

/// A captured mesh with what it takes of the source (see iso_file.h); normals are those of phi.
Pieces convert(const MeshFile& source, Format target, const IsoResult& captured, const Transported& transported,
               const Rounding& precision, WriteResult& result);

/// The same of a mesh that comes from no file.
Pieces convert(Format target, const IsoResult& captured, const Rounding& precision);

/// A hollow solid; the skin that is the source has all that the format can hold of it, and the other one its colours
/// and materials where it is closest. `captured` is the other skin.
Pieces convert(const MeshFile& source, Format target, const Hollow& hollow, const IsoResult& captured,
               WriteResult& result);

/// A hollow solid without more than that.
Pieces convert(Format target, const Hollow& hollow, WriteResult& result);

}  // namespace vdb_offset::io
