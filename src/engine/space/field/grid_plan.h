// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "ground/system/call_progress.h"
#include "space/field/field_grids.h"
#include "space/field/run_bytes.h"
#include "space/surface/surface.h"
#include "vdb_offset/options.h"

namespace vdb_offset {

/// Further sizes that a plan depends on.
struct PlanContext {
  RunBytes bytes;        ///< What the run needs for other things.
  bool has_grid = true;  ///< Else its frame alone is of use.
  bool slab = false;     ///< The surface is a ribbon, and its field one leaf node thick (see ribbon.h).
};

/// Chooses the voxel size and estimates the cost.
///
/// The grid serves directions only, distances are exact without it, so its voxel size is a smoothing length: the
/// distance itself (the farthest, where they differ), no finer than half the median edge or diagonal / 1024, no coarser
/// than diagonal / 64 or distance / 16, whichever is larger, and coarser still where `max_memory` (bytes; 0 for no
/// limit) asks for it. A size that the caller gives is taken as it is. `farthest` is the largest distance on each side,
/// world units; not 0 on both. \throw InvalidInput for options out of range, OutOfBudget if the run would not fit.
GridPlan plan_grid(const Surface& surface, const Reach& farthest, const GridOptions& options, std::size_t max_memory,
                   int threads, const PlanContext& context = {});
/// Plans the grid for one distance, negative inward.
GridPlan plan_grid(const Surface& surface, double distance, const GridOptions& options, std::size_t max_memory,
                   int threads);

/// Seconds of one thread that the stages of a run are expected to take where nothing is to be mended.
/// \param leaves leaf nodes of the grid, 0 without one
StageSeconds expected_seconds(double leaves, double triangles, double vertices);

/// \throw InvalidInput for a diagonal, a distance (world units, > 0) or a grid that no field can be made for.
void require_plannable(double diagonal, double distance, const GridOptions& options);

/// Share of the distance, or of a voxel of an iso-surface, by which coordinates may be rounded at most: with more, the
/// result would be a matter of rounding. Not measured.
inline constexpr double kMostRounding = 0.25;
/// Refuses a length that coordinates are too coarse for. \throw InvalidInput, with both figures, if they are rounded by
/// more than kMostRounding of it
void require_fine_coordinates(double rounding, double length, const char* of_what);
/// The largest absolute value of a coordinate of the surface.
double farthest_coordinate(const MeshFacts& facts);

/// A voxel size, world units, and the reason for it.
struct VoxelSize {
  double size;
  std::string reason;
};
/// Chooses the voxel size as plan_grid() does, memory aside, for a mesh with this median edge and this diagonal. \throw
/// InvalidInput as plan_grid()
VoxelSize choose_voxel_size(double median_edge, double diagonal, double distance, const GridOptions& options);

}  // namespace vdb_offset
