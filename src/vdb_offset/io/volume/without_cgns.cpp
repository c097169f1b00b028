// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/error.h"
#include "vdb_offset/io/volume/volume_writers.h"

// Stands in for write_cgns.cpp where the library is built without CGNS: writing is refused.
namespace vdb_offset::io {

void require_cgns(const std::string& path) {
  throw InvalidOption(path + ": expected another format than .cgns, as this build is without CGNS (VDB_OFFSET_CGNS)");
}

void write_cgns(const WrittenFile& file, const VolumeMesh&) { require_cgns(file.path); }

}  // namespace vdb_offset::io
