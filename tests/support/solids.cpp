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

Polygons l_tube(int segments) {
  const std::vector<std::array<double, 2>> corners{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  std::vector<std::array<double, 2>> ring;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const int count = segments * static_cast<int>(std::abs(b[0] - a[0]) + std::abs(b[1] - a[1]));
    for (int k = 0; k < count; ++k)
      ring.push_back({a[0] + (b[0] - a[0]) * k / count, a[1] + (b[1] - a[1]) * k / count});
  }
  Polygons mesh;
  constexpr std::uint32_t kStations = 4;
  const auto n = static_cast<std::uint32_t>(ring.size());
  for (std::uint32_t j = 0; j <= kStations; ++j)
    for (const auto& [x, y] : ring) mesh.positions.emplace_back(x, y, static_cast<double>(j) / segments);
  for (std::uint32_t j = 0; j < kStations; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * n + i, b = j * n + (i + 1) % n;
      mesh.add_face({a, b, b + n, a + n});
    }
  return mesh;
}

}  // namespace vdb_offset::test
