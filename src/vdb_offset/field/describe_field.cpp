// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/field/describe_field.h"

namespace vdb_offset {

void describe_field(const DistanceField& field, const DirectionField& directions, OffsetStatistics& statistics) {
  statistics.active_voxels = field.leaves->active_voxels();
  statistics.leaf_nodes = field.leaves->size();
  const std::size_t beside = sizeof(FieldLeaf) / 2;  // what a leaf node has beside its voxels
  statistics.phi_bytes = statistics.leaf_nodes * (kLeafVoxels * sizeof(float) + beside);
  statistics.closest_bytes = statistics.leaf_nodes * (kLeafVoxels * sizeof(std::int32_t) + beside);
  statistics.gradient_bytes = directions.gradient.size() * sizeof(LeafGradients);
}

}  // namespace vdb_offset
