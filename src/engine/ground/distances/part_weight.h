// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace vdb_offset {

/// How much a part counts beyond its edge, beside the own part's 1, at a share of the length over which distances
/// change: from 1 at the edge to 0 at a share of 1, with two derivatives of 0 at both.
inline double part_weight(double share) {
  const double s = std::clamp(1 - share, 0.0, 1.0);
  return s * s * s * (10 - s * (15 - 6 * s));
}

}  // namespace vdb_offset
