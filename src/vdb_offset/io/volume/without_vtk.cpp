// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/error.h"
#include "vdb_offset/io/volume/volume_writers.h"

// Stands in for the writers that use VTK where the library is built without it: writing is refused.
namespace vdb_offset::io {

void require_vtk(const std::string& path) {
  throw InvalidOption(path + ": expected another format, as this build is without VTK (VDB_OFFSET_VTK)");
}

void write_vtu(const WrittenFile& file, VolumeMesh&) { require_vtk(file.path); }

void write_vts(const WrittenFile& file, const StructuredBlock&) { require_vtk(file.path); }

}  // namespace vdb_offset::io
