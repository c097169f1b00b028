// SPDX-License-Identifier: Apache-2.0
#include "assimp/assimp_meshes.h"
#include "vdb_offset/api.h"

const vdb_offset::io::AssimpModule vdb_offset_assimp = {VDB_OFFSET_VERSION, vdb_offset::io::parse_with_assimp};
