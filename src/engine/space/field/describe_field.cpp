// SPDX-License-Identifier: Apache-2.0
#include "space/field/describe_field.h"

namespace vdb_offset {

void describe_field(const DistanceField& field, const DirectionField& directions, OffsetStatistics& statistics) {
  statistics.active_voxels = field.phi->activeVoxelCount();
  statistics.leaf_nodes = field.phi->tree().leafCount();
  statistics.phi_bytes = field.phi->memUsage();
  statistics.closest_bytes = field.closest->memUsage();
  statistics.gradient_bytes = directions.gradient->memUsage();
}

}  // namespace vdb_offset
