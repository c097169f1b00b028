// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/version.h"
#include "volume/writer_modules.h"

const vdb_offset::io::VtkModule vdb_offset_vtk = {VDB_OFFSET_VERSION, vdb_offset::io::write_vtu,
                                                  vdb_offset::io::write_vts};
