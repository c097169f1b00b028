// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/api.h"
#include "volume/writer_modules.h"

const vdb_offset::io::CgnsModule vdb_offset_cgns = {VDB_OFFSET_VERSION, vdb_offset::io::write_cgns};
