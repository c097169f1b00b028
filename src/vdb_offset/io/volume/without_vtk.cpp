// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/error.h"
#include "vdb_offset/io/volume/volume_writers.h"

// Stands in for the writers that use VTK where the library is built without it: writing is refused.
namespace vdb_offset::io {

void write_vtu(const std::string& path, VolumeMesh&) {
  throw InvalidOption(path + ": expected another format than .vtu, as this build is without VTK (VDB_OFFSET_VTK)");
}

void write_vts(const std::string& path, const StructuredBlock&) {
  throw InvalidOption(path + ": expected another format than .vts, as this build is without VTK (VDB_OFFSET_VTK)");
}

}  // namespace vdb_offset::io
