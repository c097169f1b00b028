// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/grids/level_set.h"
#include "vdb_offset/grids/write_grids.h"

// What uses OpenVDB's library is a module of the command (see io/base/open_module.h): the loader takes many times as
// long for that library as for all others together, and most runs need nothing of it.
namespace vdb_offset {

struct VdbModule {
  const char* version;
  decltype(&vdb_offset::write_grids) write_grids;
  decltype(&vdb_offset::make_level_set) make_level_set;
};

}  // namespace vdb_offset

// NOLINTNEXTLINE(readability-identifier-naming): it is found by its module's name
extern "C" VDB_OFFSET_API const vdb_offset::VdbModule vdb_offset_vdb;
