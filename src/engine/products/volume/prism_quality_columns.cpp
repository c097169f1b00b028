// SPDX-License-Identifier: Apache-2.0
#include "products/volume/prism_quality_columns.h"

#include "products/volume/prism_quality_lanes.h"

namespace vdb_offset {

SixVolumes measure_prism_columns(const PrismQualityColumns& columns) {
#ifdef VDB_OFFSET_AVX2
  static const bool at_once = __builtin_cpu_supports("avx2") != 0;
  if (at_once) return measure_prism_quads(columns);
#endif
  return measure_prism_pairs(columns);
}

SixVolumes measure_prism_pairs(const PrismQualityColumns& columns) {
  SixVolumes six_volumes{};
  for (const std::size_t first : {0, 2}) PrismLanes<double2>(columns, first).measure(six_volumes.data());
  return six_volumes;
}

}  // namespace vdb_offset
