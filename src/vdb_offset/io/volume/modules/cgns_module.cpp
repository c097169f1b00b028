// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/volume/modules/writer_modules.h"
#include "vdb_offset/version.h"

const vdb_offset::io::CgnsModule vdb_offset_cgns = {VDB_OFFSET_VERSION, vdb_offset::io::write_cgns};
