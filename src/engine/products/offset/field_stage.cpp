// SPDX-License-Identifier: Apache-2.0
#include "products/offset/field_stage.h"

#include <algorithm>

#include "ground/system/assert.h"
#include "ground/system/stage_timer.h"
#include "space/field/describe_field.h"
#include "space/field/rasterise.h"
#include "space/field/sweep.h"

namespace vdb_offset {
namespace {

// The number of voxels along the diagonal of a surface that no field is made for. Its only effect is where the origin
// of the frame lies. A power of two, so that scaling a mesh by one changes no digit; not measured.
constexpr double kFrameVoxels = 256;
// World units: the diagonal that is taken for a surface without any size, so that its frame has voxels. Any number
// above 0 would do; this is far below all coordinates that a format keeps.
constexpr double kLeastSize = 1e-100;

}  // namespace

Reach farthest_of(std::span<const Distances> distances) {
  Reach farthest{0, 0};
  for (const Distances& d : distances)
    farthest = {std::max(farthest.inside, d.inward()), std::max(farthest.outside, d.outward())};
  return farthest;
}

bool goes_anywhere(const Reach& farthest) { return farthest.inside > 0 || farthest.outside > 0; }

double frame_voxel_size(const MeshFacts& facts) { return std::max(facts.diagonal, kLeastSize) / kFrameVoxels; }

DistanceField make_field(const Surface& surface, const GridPlan& plan, bool slab, const OffsetOptions& options,
                         OffsetStatistics& statistics) {
  VDB_OFFSET_ASSERT(plan.voxel_size > 0 && plan.band > plan.voxel_size);
  VDB_OFFSET_ASSERT(surface.triangle_normals.size() == surface.triangles.size());
  Front front;
  {
    const StageTimer timer(statistics.seconds, Stage::Rasterise);
    front = rasterise(surface, {plan.voxel_size, plan.band, slab}, options.progress);
  }
  const StageTimer timer(statistics.seconds, Stage::Sweep);
  return sweep(std::move(front), surface, {options.solver, plan.reach}, options.progress);
}

DirectionField find_directions(DistanceField& field, bool open, OffsetStatistics& statistics) {
  const StageTimer timer(statistics.seconds, Stage::Gradient);
  DirectionField directions = make_directions(field, open);
  describe_field(field, directions, statistics);
  return directions;
}

Ridges ridges_of(const OffsetOptions& options) {
  return options.collision == Collision::Merge ? Ridges::Sharp : Ridges::Smooth;
}

PathOptions march_options(const OffsetOptions& options, Ridges ridges) {
  return {options.keep_paths ? KeepPaths::Yes : KeepPaths::No, ridges};
}

}  // namespace vdb_offset
