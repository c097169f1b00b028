// SPDX-License-Identifier: Apache-2.0
#include "space/field/sweep.h"

#include "space/field/leaf_rounds.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

DistanceField sweep(Front front, const Surface& surface, const SweepOptions& options,
                    const ProgressCallback& progress) {
  if (front.phi->activeVoxelCount() == 0)
    throw InvalidInput("sweep: expected a front with active voxels, got none (was it rasterised?)");
  if (!(options.reach.inside >= front.band) || !(options.reach.outside >= front.band))
    throw InvalidInput("sweep: expected a reach of at least the front's band on both sides");
  DistanceField field;
  static_cast<FieldGrids&>(field) = std::move(static_cast<FieldGrids&>(front));
  field.reach = options.reach;
  if (options.solver == Solver::Closest) sweep_closest(field, surface, progress);
  else sweep_eikonal(field, progress);
  return field;
}

}  // namespace vdb_offset
