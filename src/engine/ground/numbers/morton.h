// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// Keys of points along the Morton curve through a cube: near along the curve is near in space, for the caches' sake.
class MortonCurve {
 public:
  /// The cube from `lower` with the longest extent of the box; points outside are clamped.
  MortonCurve(const Vec3d& lower, const Vec3d& upper) : lower_(lower) {
    const double longest = std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
    scale_ = longest > 0 ? kCells / longest : 0;
  }

  /// The key of a point: 63 bits, 21 for each axis.
  std::uint64_t operator()(const Vec3d& x) const {
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k)
      code |= spread(static_cast<std::uint64_t>(std::clamp((x[k] - lower_[k]) * scale_, 0.0, kCells - 1))) << k;
    return code;
  }

 private:
  static constexpr double kCells = 2097152;  // along each axis: 2^21, as three times 21 bits fit into 64

  /// Puts two zeros after each of 21 bits, so that three axes can be interleaved.
  static std::uint64_t spread(std::uint64_t x) {
    x = (x | x << 32) & 0x1f00000000ffffULL;
    x = (x | x << 16) & 0x1f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    return (x | x << 2) & 0x1249249249249249ULL;
  }

  Vec3d lower_;
  double scale_;
};

}  // namespace vdb_offset
