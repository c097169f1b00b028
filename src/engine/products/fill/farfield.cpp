// SPDX-License-Identifier: Apache-2.0
#include "products/fill/farfield.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "vdb_offset/shapes.h"

namespace vdb_offset {
namespace {

// The edges of a sphere are 0.27 to 0.33 of its radius at two subdivisions, and those of a box a fourth of its longest
// side: with three, or an eighth, bodies had 3 to 10 % more cells, all of them far away.
constexpr int kSubdivisions = 2;
constexpr double kCellsAlong = 4;

// The least room between a body and the farfield, as a share of the body's length: a hundredth would make cells as
// small there as on the body.
constexpr double kLeastRoom = 0.1;

/// A grid of triangles on each side of a box, with cells about as wide as high.
Polygons grid_box(const Vec3d& lowest, const Vec3d& highest) {
  const Vec3d size = highest - lowest;
  const double cell = std::max({size[0], size[1], size[2]}) / kCellsAlong;
  std::array<int, 3> count;
  for (int k = 0; k < 3; ++k) count[k] = std::max(1, static_cast<int>(std::lround(size[k] / cell)));
  Polygons box;
  std::vector<std::uint32_t> number((count[0] + 1) * (count[1] + 1) * (count[2] + 1), kNone);
  const auto point = [&](const std::array<int, 3>& at) {
    std::uint32_t& known = number[(at[2] * (count[1] + 1) + at[1]) * (count[0] + 1) + at[0]];
    if (known != kNone) return known;
    Vec3d position;
    for (int k = 0; k < 3; ++k)
      position[k] = at[k] == count[k] ? highest[k] : lowest[k] + size[k] * at[k] / count[k];
    known = static_cast<std::uint32_t>(box.positions.size());
    box.positions.push_back(position);
    return known;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool is_upper : {false, true})
      for (int i = 0; i < count[u]; ++i)
        for (int j = 0; j < count[v]; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> at;
            at[axis] = is_upper ? count[axis] : 0;
            at[u] = i + di, at[v] = j + dj;
            return point(at);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (is_upper) box.add_face({a, b, c}), box.add_face({a, c, d});
          else box.add_face({a, c, b}), box.add_face({a, d, c});
        }
  }
  return box;
}

Polygons triangles_of(const Polygons& surface) {
  Polygons triangles{surface.positions, {}, {0}};
  for (const auto& [a, b, c] : split_polygons(surface.view())) triangles.add_face({a, b, c});
  return triangles;
}

/// How often a closed surface winds around a point (van Oosterom and Strackee, The Solid Angle of a Plane Triangle,
/// 1983).
double winding_number(const Polygons& surface, const Vec3d& x) {
  constexpr double kTwoPi = 6.283185307179586;
  double sum = 0;
  for (std::size_t f = 0; f < surface.face_count(); ++f) {
    Vec3d side[3];
    double length[3];
    for (std::size_t k = 0; k < 3; ++k) {
      side[k] = surface.positions[surface.corners[3 * f + k]] - x;
      length[k] = side[k].length();
    }
    const double volume = side[0].dot(side[1].cross(side[2]));
    const double base = length[0] * length[1] * length[2] + side[0].dot(side[1]) * length[2] +
                        side[1].dot(side[2]) * length[0] + side[2].dot(side[0]) * length[1];
    sum += std::atan2(volume, base);
  }
  return sum / kTwoPi;
}

void require_enclosed(const Polygons& farfield, const Vec3d& lowest, const Vec3d& highest) {
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d x;
    for (int k = 0; k < 3; ++k) x[k] = (corner >> k) % 2 == 1 ? highest[k] : lowest[k];
    if (winding_number(farfield, x) < 0.5)
      throw InvalidInput(
          fmt::format("farfield: expected a surface around the layers, with faces counter-clockwise seen from outside, "
                      "got one that ({:.6g}, {:.6g}, {:.6g}), a corner of their box, is outside of",
                      x[0], x[1], x[2]));
  }
}

}  // namespace

Polygons make_farfield(const Farfield& farfield, const Vec3d& lowest, const Vec3d& highest) {
  const Vec3d size = highest - lowest;
  const double length = std::max({size[0], size[1], size[2]}), room = kLeastRoom * length;
  Polygons surface;
  if (farfield.shape == Farfield::Shape::Given) {
    surface = triangles_of(farfield.surface);
    require_enclosed(surface, lowest, highest);
    return surface;
  }
  const double reach = farfield.in_lengths ? farfield.size * length : farfield.size;
  if (farfield.shape == Farfield::Shape::Box) {
    if (!(reach >= room))
      throw InvalidInput(
          fmt::format("farfield: expected a box at least {:.3g} beyond the layers, got {:.3g}", room, reach));
    return grid_box(lowest - Vec3d(reach), highest + Vec3d(reach));
  }
  // Its triangles come nearer to the middle than the radius, by 4 %.
  const double least = 1.1 * size.length() / 2 + room;
  if (!(reach >= least))
    throw InvalidInput(
        fmt::format("farfield: expected a radius of at least {:.3g}, to enclose the layers, got {:.3g}", least, reach));
  surface = shapes::icosphere(reach, kSubdivisions);
  for (Vec3d& position : surface.positions) position += (lowest + highest) / 2;
  return surface;
}

}  // namespace vdb_offset
