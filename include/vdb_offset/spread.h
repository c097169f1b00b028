// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vdb_offset {

/// How numbers are spread.
struct Spread {
  double least = 0, quantile_01 = 0, quantile_05 = 0, median = 0, quantile_95 = 0, quantile_99 = 0, most = 0;
  double mean = 0;
};

}  // namespace vdb_offset
