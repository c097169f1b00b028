// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "vdb_offset/api.h"
#include "volume/volume_writers.h"

// The writer that uses CGNS is a module (see bytes/open_module.h).
namespace vdb_offset::io {

struct CgnsModule {
  const char* version;
  void (*write_cgns)(const WrittenFile&, const VolumeMesh&);
};

}  // namespace vdb_offset::io

// NOLINTBEGIN(readability-identifier-naming): each is found by its module's name
extern "C" VDB_OFFSET_API const vdb_offset::io::CgnsModule vdb_offset_cgns;
// NOLINTEND(readability-identifier-naming)
