// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/task_arena.h>

#include <span>
#include <vector>

#include "ground/system/thread_count.h"
#include "motion/paths/propagate.h"
#include "space/field/direction_field.h"
#include "space/field/field_grids.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/options.h"
#include "vdb_offset/result.h"

/// The stages before paths that meshes and curves share: the distance field of a surface, which is a ribbon for curves,
/// its directions, and the options of the march.
namespace vdb_offset {

/// What a run makes, for its plan: so many results, or so many layers of cells under one.
struct Yield {
  std::size_t results = 1, layers = 0;
  bool has_targets = false;  ///< Vertices have targets (see vertex_targets.h): no field is made.
  /// Distances are measured from the first so many faces: all others lie on their edges, but for rounding.
  std::uint32_t measured_faces = kNone;
  bool by_corner = false;  ///< Something is told by the corners of faces, which hanging vertices are none of.
};

/// The farthest that any vertex goes on each side, for any of the distances; world units, 0 on a side where none goes.
Reach farthest_of(std::span<const Distances> distances);
/// Whether any vertex has to move at all.
bool goes_anywhere(const Reach& farthest);

/// Rasterises a surface and sweeps its field out to the plan's reach. Adds the seconds of both stages to `statistics`.
/// \param slab the surface is a ribbon, and its field one leaf node thick
/// \pre the surface stands in the frame of the plan's voxels (see to_local_frame())
DistanceField make_field(const Surface& surface, const GridPlan& plan, bool slab, const OffsetOptions& options,
                         OffsetStatistics& statistics);

/// Makes the direction field, and notes in `statistics` how large the grids are.
/// \param open phi changes its sign away from the surface too: it has borders, or sides that do not agree
DirectionField find_directions(DistanceField& field, bool open, OffsetStatistics& statistics);

/// How vertices go along ridges of the distance field: as Collision::Merge asks for, or evenly spread.
Ridges ridges_of(const OffsetOptions& options);
/// The options of propagate() in a run.
PathOptions march_options(const OffsetOptions& options, Ridges ridges);

/// The voxel size of the frame of a surface that no field is made for (see to_local_frame()), world units, above 0.
double frame_voxel_size(const MeshFacts& facts);

/// Runs `work(threads)` in an arena of its own, which keeps the number of threads a matter of this call alone.
/// \param asked number of threads; 0 for as many as the machine has. \throw InvalidInput below 0
template <class Work>
auto in_arena(int asked, Work&& work) {
  const int threads = thread_count(asked);
  tbb::task_arena arena(threads);
  return arena.execute([&] { return work(threads); });
}

}  // namespace vdb_offset
