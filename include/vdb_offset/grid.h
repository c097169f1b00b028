// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace vdb_offset {

/// How far a field reaches on each side of the surface, world units, both > 0.
struct Reach {
  double inside, outside;
};

/// How fine the grid is. At most one of the two may be set; with neither the size is chosen (see plan_grid).
struct GridOptions {
  std::optional<double> voxel_size;           ///< World units, > 0.
  std::optional<double> voxels_per_distance;  ///< > 0; the voxel size is |distance| / this.
};

/// What a run will need, known before it starts.
struct GridPlan {
  double voxel_size = 0;                              ///< World units.
  std::string reason;                                 ///< Why this size, in words.
  double band = 0;                                    ///< Width on each side that is rasterised exactly.
  Reach reach{};                                      ///< Width on each side that the field covers.
  std::size_t leaf_nodes = 0, voxels = 0, bytes = 0;  ///< Estimates; bytes is the peak of the whole run.
  double seconds = 0;                                 ///< Rough estimate for `threads` threads.
};

}  // namespace vdb_offset
