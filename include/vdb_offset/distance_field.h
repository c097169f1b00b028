// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/api.h"

namespace vdb_offset {

/// The distance field of a run, which OffsetResult::field keeps. make_grids() makes OpenVDB's grids of it
/// (field_grids.h).
struct DistanceField;

/// Writes phi and the closest triangles as a .vdb file; `metadata` is added to both grids as strings.
/// The file is written under a temporary name and renamed. \throw WriteError, also for voxels below 1.5e-5.
VDB_OFFSET_API void save_vdb(const DistanceField& field, const std::string& path, bool closed_surface,
                             const std::vector<std::pair<std::string, std::string>>& metadata);

/// Checks whether .vdb files can be written, before the work that one is to hold. \throw WriteError where the program
/// loads OpenVDB when it is needed, as the command does, and it cannot be loaded
VDB_OFFSET_API void require_vdb_writer(const std::string& path);

}  // namespace vdb_offset
