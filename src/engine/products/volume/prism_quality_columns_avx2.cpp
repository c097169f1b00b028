// SPDX-License-Identifier: Apache-2.0
// Compiled for AVX2, and run only where the machine has it. What it includes may not define inline functions with
// numbers of types that other sources use: the linker keeps one of each, and it could be the one for AVX2.
#include "products/volume/prism_quality_lanes.h"

namespace vdb_offset {

SixVolumes measure_prism_quads(const PrismQualityColumns& columns) {
  SixVolumes six_volumes{};
  PrismLanes<double4>(columns, 0).measure(six_volumes.data());
  return six_volumes;
}

}  // namespace vdb_offset
