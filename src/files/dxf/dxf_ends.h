// SPDX-License-Identifier: Apache-2.0
#pragma once

// Ends of curves that are one but for the rounding of the numbers in the file.

#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// Where a curve begins and ends.
struct DxfEnds {
  Vec3d first{0.0}, last{0.0};
  double extent = 0;     ///< Of the curve.
  bool is_open = false;  ///< Closed ones have no ends to join.
  double shift = 0;      ///< How far its ends have been moved, the farther one.
};

/// Moves ends of open curves that are no farther than `gap` from one before, at the same height, to that one. The two
/// ends of one curve, if this is much longer, are joined as well; a curve that is hardly longer than the gap stays as
/// it is.
void join_near_ends(std::vector<DxfEnds>& curves, double gap);

}  // namespace vdb_offset::io
