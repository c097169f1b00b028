#include "vdb_offset/pipeline/run_statistics.h"

#include <tbb/info.h>

#include <algorithm>

#include "vdb_offset/base/error.h"

namespace vdb_offset {

int thread_count(int asked) {
  if (asked < 0) throw InvalidInput("offset: expected 0 threads or more, got " + std::to_string(asked));
  // More than the machine has would only be asked for in vain.
  const int most = tbb::info::default_concurrency();
  return asked > 0 ? std::min(asked, most) : most;
}

void describe_field(const DistanceField& field, const DirectionField& directions, OffsetStatistics& statistics) {
  statistics.active_voxels = field.phi->activeVoxelCount();
  statistics.leaf_nodes = field.phi->tree().leafCount();
  statistics.phi_bytes = field.phi->memUsage();
  statistics.closest_bytes = field.closest->memUsage();
  statistics.gradient_bytes = directions.gradient->memUsage();
}

void count_states(std::span<const VertexState> states, OffsetStatistics& statistics) {
  for (const VertexState state : states) ++statistics.vertices_by_state[static_cast<std::size_t>(state)];
}

}  // namespace vdb_offset
