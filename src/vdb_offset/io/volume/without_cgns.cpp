// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/error.h"
#include "vdb_offset/io/volume/volume_writers.h"

// Stands in for write_cgns.cpp where the library is built without CGNS: writing is refused.
namespace vdb_offset::io {

void write_cgns(const std::string& path, const VolumeMesh&) {
  throw InvalidOption(path + ": expected another format than .cgns, as this build is without CGNS (VDB_OFFSET_CGNS)");
}

}  // namespace vdb_offset::io
