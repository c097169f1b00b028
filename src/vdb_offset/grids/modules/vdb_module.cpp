// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/grids/modules/vdb_module.h"

#include "vdb_offset/version.h"

const vdb_offset::VdbModule vdb_offset_vdb = {VDB_OFFSET_VERSION, vdb_offset::write_grids, vdb_offset::make_level_set};
