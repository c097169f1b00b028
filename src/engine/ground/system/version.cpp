// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/api.h"

namespace vdb_offset {

const char* version() { return VDB_OFFSET_VERSION; }

}  // namespace vdb_offset
