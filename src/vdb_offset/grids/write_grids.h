// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/distance_field.h"
#include "vdb_offset/field/distance_field.h"

namespace vdb_offset {

/// Whether OpenVDB accepts a transform of this voxel size: if its determinant is below 3e-15, it takes it for singular.
inline bool can_hold(double voxel_size) { return voxel_size * voxel_size * voxel_size > 3.1e-15; }

/// Writes phi and closest to a stream, as save_vdb() asks for. `path` is for messages. \pre can_hold(voxel size)
/// \throw WriteError, std::ios_base::failure if the stream throws that
void write_grids(const std::string& path, std::ostream& file, const DistanceField& field, bool closed_surface,
                 const std::vector<std::pair<std::string, std::string>>& metadata);

}  // namespace vdb_offset
