// SPDX-License-Identifier: Apache-2.0
#include "products/fill/farfield.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "vdb_offset/shapes.h"

namespace vdb_offset {
namespace {

// The edges of a sphere are 0.27 to 0.33 of its radius at two subdivisions, and those of a box a fourth of its longest
// side: with three, or an eighth, bodies had 3 to 10 % more cells, all of them far away.
constexpr int kSubdivisions = 2, kSegments = 24, kRings = 6, kOfOctant = 5;
constexpr double kCellsAlong = 4;

// The least room between a body and the farfield, as a share of the body's length: a hundredth would make cells as
// small there as on the body.
constexpr double kLeastRoom = 0.1;

/// A box along axes of its own, the last of which lead out of the planes that it ends at.
struct Frame {
  std::array<Vec3d, 3> axis{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
  Vec3d lowest{std::numeric_limits<double>::infinity()}, highest{-std::numeric_limits<double>::infinity()};
  std::array<bool, 3> ends_above{}, ends_below{};  // along each axis

  Vec3d in_frame(const Vec3d& x) const { return {x.dot(axis[0]), x.dot(axis[1]), x.dot(axis[2])}; }
  Vec3d in_world(const Vec3d& x) const { return axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2]; }
  Vec3d size() const { return highest - lowest; }
  double length() const { return std::max({size()[0], size()[1], size()[2]}); }
  bool ends_at(int k) const { return ends_above[k] || ends_below[k]; }
  int planes() const { return ends_at(0) + ends_at(1) + ends_at(2); }
};

// Cosines: of directions that are the same, and how far those at right angles may be off, as in files of seven digits.
constexpr double kSameDirection = 1e-9, kAtRightAngles = 1e-5;

/// Axes of which the last are the planes' normals. \throw InvalidInput unless planes are parallel or at right angles
std::array<Vec3d, 3> axes_of(std::span<const OpenPlane> planes) {
  std::vector<Vec3d> normals;
  for (const OpenPlane& plane : planes) {
    bool is_known = false, is_across = true;
    for (const Vec3d& other : normals) {
      const double cosine = std::abs(plane.normal.dot(other));
      is_known = is_known || cosine > 1 - kSameDirection;
      is_across = is_across && cosine < kAtRightAngles;
    }
    if (is_known) continue;
    if (!is_across)
      throw InvalidInput(
          "fill: expected openings in planes that are parallel or at right angles, got others (--farfield FILE)");
    normals.push_back(plane.normal);
  }
  if (normals.empty()) return Frame().axis;
  if (normals.size() > 1) return {normals[1].cross(normals[0]), normals[1], normals[0]};
  const auto [u, v] = axes_across(normals[0]);
  return {u, v, normals[0]};
}

Frame frame_of(std::span<const Vec3d> points, std::span<const OpenPlane> planes) {
  Frame frame;
  frame.axis = axes_of(planes);
  for (const Vec3d& point : points) {
    const Vec3d x = frame.in_frame(point);
    frame.lowest = openvdb::math::minComponent(frame.lowest, x);
    frame.highest = openvdb::math::maxComponent(frame.highest, x);
  }
  for (const OpenPlane& plane : planes)
    for (int k = 0; k < 3; ++k) {
      const double towards = plane.normal.dot(frame.axis[k]);
      if (std::abs(towards) < 1 - kSameDirection) continue;
      const double place = plane.origin.dot(frame.axis[k]);
      if (towards > 0) frame.highest[k] = place, frame.ends_above[k] = true;
      else frame.lowest[k] = place, frame.ends_below[k] = true;
    }
  return frame;
}

/// A grid of triangles on each side of a frame's box, with cells about as wide as high, but where it ends at planes.
class GridBox {
 public:
  explicit GridBox(const Frame& frame) : frame_(frame) {
    const double cell = frame.length() / kCellsAlong;
    for (int k = 0; k < 3; ++k) count_[k] = std::max(1, static_cast<int>(std::lround(frame.size()[k] / cell)));
  }

  Polygons make() {
    for (int axis = 0; axis < 3; ++axis)
      for (const bool is_upper : {false, true})
        if (!(is_upper ? frame_.ends_above : frame_.ends_below)[axis]) add_side(axis, is_upper);
    return std::move(box_);
  }

 private:
  std::uint32_t point(const std::array<int, 3>& at) {
    const auto [found, is_new] = number_.try_emplace(at, static_cast<std::uint32_t>(box_.positions.size()));
    if (is_new) {
      Vec3d x;
      for (int k = 0; k < 3; ++k)
        x[k] = at[k] == count_[k] ? frame_.highest[k] : frame_.lowest[k] + frame_.size()[k] * at[k] / count_[k];
      box_.positions.push_back(frame_.in_world(x));
    }
    return found->second;
  }

  void add_side(int axis, bool is_upper) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto corner = [&](int i, int j) {
      std::array<int, 3> at;
      at[axis] = is_upper ? count_[axis] : 0;
      at[u] = i, at[v] = j;
      return point(at);
    };
    for (int i = 0; i < count_[u]; ++i)
      for (int j = 0; j < count_[v]; ++j) {
        const std::uint32_t a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
        if (is_upper) box_.add_face({a, b, c}), box_.add_face({a, c, d});
        else box_.add_face({a, c, b}), box_.add_face({a, d, c});
      }
  }

  const Frame& frame_;
  std::array<int, 3> count_{};
  std::map<std::array<int, 3>, std::uint32_t> number_;  // of points, by their places in the grid
  Polygons box_;
};

/// The octants of a sphere on the side of 0 that a frame's box is on along each axis that it ends at, each parted into
/// rows of triangles.
Polygons octants(const Frame& frame, double radius) {
  Polygons sphere;
  std::map<std::array<int, 3>, std::uint32_t> number;
  for (int octant = 0; octant < 8; ++octant) {
    std::array<int, 3> sign;
    for (int k = 0; k < 3; ++k) sign[k] = (octant >> k) % 2 == 0 ? 1 : -1;
    bool is_in = true;
    for (int k = 0; k < 3; ++k) is_in = is_in && !(sign[k] > 0 ? frame.ends_above : frame.ends_below)[k];
    if (!is_in) continue;
    const auto point = [&](int i, int j) {
      const std::array<int, 3> at{sign[0] * i, sign[1] * j, sign[2] * (kOfOctant - i - j)};
      const auto [found, is_new] = number.try_emplace(at, static_cast<std::uint32_t>(sphere.positions.size()));
      if (is_new) sphere.positions.push_back(Vec3d(at[0], at[1], at[2]).unit() * radius);
      return found->second;
    };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      if (sign[0] * sign[1] * sign[2] > 0) sphere.add_face({a, b, c});
      else sphere.add_face({a, c, b});
    };
    for (int i = 0; i < kOfOctant; ++i)
      for (int j = 0; i + j < kOfOctant; ++j) {
        add(point(i, j), point(i + 1, j), point(i, j + 1));
        if (i + j + 1 < kOfOctant) add(point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
      }
  }
  return sphere;
}

/// A sphere around the middle of a frame's box, or what lies on this side of the planes of one around that of the sides
/// at them.
Polygons sphere_around(const Frame& frame, double radius) {
  Vec3d middle = (frame.lowest + frame.highest) / 2;
  std::array<Vec3d, 3> axis = frame.axis;
  for (int k = 0; k < 3; ++k) {
    if (frame.ends_above[k] && frame.ends_below[k])
      throw InvalidInput(
          "farfield: expected a box, as the wall ends at two planes, got a sphere (--farfield box:10L; or to fill the "
          "inside of a tube, heights of the other sign)");
    if (frame.ends_at(k)) middle[k] = frame.ends_above[k] ? frame.highest[k] : frame.lowest[k];
  }
  const Vec3d centre = frame.in_world(middle);
  Polygons sphere;
  if (frame.planes() > 1) sphere = octants(frame, radius);
  else if (!frame.ends_at(2)) sphere = shapes::icosphere(radius, kSubdivisions);
  else {
    sphere = shapes::hemisphere(radius, kSegments, kRings);
    if (frame.ends_above[2]) axis = {axis[1], axis[0], -axis[2]};
  }
  // Exactly in the plane.
  for (Vec3d& x : sphere.positions) x = centre + axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2];
  return sphere;
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

void require_enclosed(const Polygons& farfield, const Frame& frame) {
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d x;
    for (int k = 0; k < 3; ++k) x[k] = (corner >> k) % 2 == 1 ? frame.highest[k] : frame.lowest[k];
    if (winding_number(farfield, frame.in_world(x)) < 0.5)
      throw InvalidInput(
          fmt::format("farfield: expected a surface around the layers, with faces counter-clockwise seen from outside, "
                      "got one that ({:.6g}, {:.6g}, {:.6g}), a corner of their box, is outside of",
                      x[0], x[1], x[2]));
  }
}

}  // namespace

Polygons make_farfield(const Farfield& farfield, std::span<const Vec3d> points, std::span<const OpenPlane> planes) {
  Frame frame = frame_of(points, planes);
  if (farfield.shape == Farfield::Shape::Given) {
    Polygons surface = triangles_of(farfield.surface);
    if (planes.empty()) require_enclosed(surface, frame);
    return surface;
  }
  const double length = frame.length(), room = kLeastRoom * length;
  const double reach = farfield.in_lengths ? farfield.size * length : farfield.size;
  if (farfield.shape == Farfield::Shape::Box) {
    if (!(reach >= room))
      throw InvalidInput(
          fmt::format("farfield: expected a box at least {:.3g} beyond the layers, got {:.3g}", room, reach));
    for (int k = 0; k < 3; ++k) {
      if (!frame.ends_below[k]) frame.lowest[k] -= reach;
      if (!frame.ends_above[k]) frame.highest[k] += reach;
    }
    return GridBox(frame).make();
  }
  // Its triangles come nearer to the middle than the radius, by 4 %.
  Vec3d half = frame.size() / 2;
  for (int k = 0; k < 3; ++k)
    if (frame.ends_at(k)) half[k] *= 2;
  const double least = 1.1 * half.length() + room;
  if (!(reach >= least))
    throw InvalidInput(
        fmt::format("farfield: expected a radius of at least {:.3g}, to enclose the layers, got {:.3g}", least, reach));
  return triangles_of(sphere_around(frame, reach));
}

}  // namespace vdb_offset
