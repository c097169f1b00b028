// SPDX-License-Identifier: Apache-2.0
#include "support/solids.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace vdb_offset::test {

Polygons letter_c(std::uint32_t segments) {
  const auto on_arc = [&](double radius, std::uint32_t i) {
    const double angle = std::numbers::pi * (0.25 + 1.5 * i / segments);
    return Vec3d(radius * std::cos(angle), radius * std::sin(angle), 0);
  };
  Polygons mesh;
  for (std::uint32_t i = 0; i <= segments; ++i) mesh.positions.push_back(on_arc(3, i));
  for (std::uint32_t i = 0; i <= segments; ++i) mesh.positions.push_back(on_arc(2, segments - i));
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t i = 0; i < count; ++i) mesh.positions.push_back(mesh.positions[i] + Vec3d(0, 0, 1));
  for (std::uint32_t i = count; i-- > 0;) mesh.corners.push_back(i);
  mesh.close_face();
  for (std::uint32_t i = 0; i < count; ++i) mesh.corners.push_back(count + i);
  mesh.close_face();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    mesh.add_face({i, next, count + next, count + i});
  }
  return mesh;
}

Polygons lathe(std::span<const std::array<double, 2>> profile, std::uint32_t segments) {
  const auto rows = static_cast<std::uint32_t>(profile.size());
  Polygons mesh;
  for (std::uint32_t i = 0; i < segments; ++i) {
    const double angle = 2 * std::numbers::pi * i / segments;
    for (const auto& [r, z] : profile) mesh.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  for (std::uint32_t i = 0; i < segments; ++i)
    for (std::uint32_t j = 0; j < rows; ++j) {
      const std::uint32_t here = i * rows, there = (i + 1) % segments * rows, up = (j + 1) % rows;
      mesh.add_face({here + j, there + j, there + up, here + up});
    }
  return mesh;
}

Polygons nose_strip(double depth, double half_width, double power, double length, std::uint32_t segments) {
  Polygons mesh;
  for (std::uint32_t i = 0; i <= segments; ++i) {
    const double t = 2.0 * i / segments - 1;
    for (const double z : {-length / 2, length / 2})
      mesh.positions.emplace_back(depth * std::pow(std::abs(t), power), half_width * t, z);
  }
  for (std::uint32_t i = 0; i < segments; ++i) {
    mesh.add_face({2 * i, 2 * i + 1, 2 * i + 3});
    mesh.add_face({2 * i, 2 * i + 3, 2 * i + 2});
  }
  return mesh;
}

}  // namespace vdb_offset::test
