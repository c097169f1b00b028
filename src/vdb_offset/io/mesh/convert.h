#pragma once

#include "vdb_offset/io/base/chunked_output.h"
#include "vdb_offset/io/iso/iso_file.h"
#include "vdb_offset/io/mesh/mesh_file.h"
#include "vdb_offset/iso/iso_surface.h"
#include "vdb_offset/shell/hollow.h"
#include "vdb_offset/shell/shell.h"

namespace vdb_offset::io {

/// The source as a file of another format, with other positions and, if asked for, other normals where a face moved:
/// all that the format can hold. `result` receives the rest. The pieces refer to `source` and `positions`.
Pieces convert(const MeshFile& source, Format target, std::span<const Vec3d> positions, const Precision& precision,
               Normals normals, WriteResult& result);

/// A shell of the source's mesh in another format: both skins have what the source has; what is the same for all
/// corners of a vertex, or of a border face, goes to the rim as well. The pieces refer to `source` and `shell`.
Pieces convert(const MeshFile& source, Format target, const Shell& shell, const Precision& precision, Normals normals,
               WriteResult& result);

/// A shell of a mesh that comes from no file.
Pieces convert(Format target, const Shell& shell, const Precision& precision, WriteResult& result);

/// A captured mesh with what it takes of the source (see iso_file.h); normals are those of phi.
Pieces convert(const MeshFile& source, Format target, const CaptureResult& captured, const Transported& transported,
               const Precision& precision, WriteResult& result);

/// The same of a mesh that comes from no file.
Pieces convert(Format target, const CaptureResult& captured, const Precision& precision);

/// A hollow solid; the skin that is the source has all that the format can hold of it, and the other one its colours
/// and materials where it is closest. `captured` is the other skin.
Pieces convert(const MeshFile& source, Format target, const Hollow& hollow, const CaptureResult& captured,
               WriteResult& result);

/// A hollow solid without more than that.
Pieces convert(Format target, const Hollow& hollow, WriteResult& result);

}  // namespace vdb_offset::io
