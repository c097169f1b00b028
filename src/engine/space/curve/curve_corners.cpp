// SPDX-License-Identifier: Apache-2.0
#include "space/curve/curve_corners.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace vdb_offset {

std::vector<std::uint8_t> vertices_on_creases(const Polyline& line) {
  // The least angle between two segments at a corner, in radians: at less, segments are less than 0.1 % nearer than the
  // distance.
  constexpr double kSharp = 5 * std::numbers::pi / 180;
  static const double kCosine = std::cos(kSharp);
  std::vector<std::uint8_t> sharp(line.vertices.size(), 0);
  for (std::uint32_t v = 0; v < sharp.size(); ++v) {
    const auto around = line.triangles_around(v);
    sharp[v] = around.size() == 2 && line.triangle_normals[around[0]].dot(line.triangle_normals[around[1]]) < kCosine;
  }
  return sharp;
}

}  // namespace vdb_offset
