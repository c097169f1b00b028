// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <numbers>
#include <tuple>
#include "support/folder.h"
#include "support/oracles.h"
#include "valid/faults/clearance.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

namespace vdb_offset::test::countersink {

/// A round plate, 9 high, with a hole of radius 3 through it that a cone widens from a height of 6 on, and the marks of
/// the hole's wall.
struct Countersink {
  Polygons mesh;
  std::vector<std::uint8_t> wall;
  std::uint32_t sides;
  double slope;  // by how much the cone's radius grows with the height

  Countersink(std::uint32_t count, double angle) : sides(count), slope(std::tan(angle / 2 * std::numbers::pi / 180)) {
    const std::pair<double, double> outline[] = {{3, 0}, {3, 2}, {3, 6}, {3 + 3 * slope, 9}, {20, 9}, {20, 0}};
    for (const auto& [radius, z] : outline)
      for (std::uint32_t i = 0; i < count; ++i) mesh.positions.push_back(at(i, radius, z));
    for (std::uint32_t ring = 0; ring < 6; ++ring)
      for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t next = (i + 1) % count, low = ring * count, high = (ring + 1) % 6 * count;
        mesh.add_face({low + next, low + i, high + i});  // triangles, of which some vertices have more than others
        mesh.add_face({low + next, high + i, high + next});
        wall.insert(wall.end(), 2, ring < 2);
      }
  }

  Vec3d at(std::uint32_t i, double radius, double z) const {
    const double angle = 2 * std::numbers::pi * i / sides;
    return {radius * std::cos(angle), radius * std::sin(angle), z};
  }
};

}  // namespace vdb_offset::test::countersink
