// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "ground/system/memory.h"
#include "vdb_offset/run.h"

namespace vdb_offset::shapes {
namespace {

using std::numbers::pi;

constexpr int kMostDivisions =
    20000;  // a mistyped number must not fill the memory, and its square has to fit into an int

void require_count(const char* what, int value, int least) {
  if (value < least || value > kMostDivisions)
    throw InvalidInput(fmt::format("shape: expected {} from {} to {}, got {}", what, least, kMostDivisions, value));
}
void require_length(const char* what, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw InvalidInput(fmt::format("shape: expected {} > 0, got {}", what, value));
}

/// \throw OutOfBudget if so many more faces do not fit into memory, with as many points and their entries in Builder's
/// map.
void require_room(std::size_t faces) {
  constexpr std::size_t kFaceBytes = 5 * 4, kPointBytes = sizeof(Vec3d) + 80;  // 80: a node of the map, in libstdc++
  require_memory(faces * (kFaceBytes + kPointBytes), "shape");
}

/// Collects faces over points; points at one position become one vertex.
class Builder {
 public:
  std::uint32_t vertex(const Vec3d& p) {
    const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto [at, added] = index_.try_emplace({p[0] + 0.0, p[1] + 0.0, p[2] + 0.0}, next);
    if (added) mesh_.positions.push_back(p);
    return at->second;
  }
  /// Adds a face. Corners that coincide are left out, so that a quad at a pole becomes a triangle.
  void face(std::initializer_list<Vec3d> points) {
    std::vector<std::uint32_t> corners;
    for (const Vec3d& p : points) {
      const auto v = vertex(p);
      if (std::find(corners.begin(), corners.end(), v) == corners.end()) corners.push_back(v);
    }
    if (corners.size() < 3) return;
    mesh_.corners.insert(mesh_.corners.end(), corners.begin(), corners.end());
    mesh_.close_face();
  }
  /// Adds the quads of a map from the unit square, counter-clockwise in (u, v).
  template <class Map>
  void grid(int nu, int nv, Map&& at) {
    require_room(static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv));
    for (int i = 0; i < nu; ++i)
      for (int j = 0; j < nv; ++j) face({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  Polygons take() { return std::move(mesh_); }

 private:
  Polygons mesh_;
  std::map<std::array<double, 3>, std::uint32_t> index_;
};

/// Adds the six sides of a box. `inward` reverses all faces.
void add_box(Builder& builder, const Vec3d& lower, const Vec3d& upper, int divisions, bool inward = false) {
  const auto at = [&](int axis, int n) {
    return n == divisions ? upper[axis] : lower[axis] + (upper[axis] - lower[axis]) * n / divisions;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const bool top : {false, true}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      builder.grid(divisions, divisions, [&](int i, int j) {
        Vec3d p;
        p[axis] = top ? upper[axis] : lower[axis];
        p[u] = at(u, top != inward ? i : j);
        p[v] = at(v, top != inward ? j : i);
        return p;
      });
    }
}

Polygons split_quads(const Polygons& quads) {
  Polygons triangles;
  triangles.positions = quads.positions;
  for (std::size_t f = 0; f < quads.face_count(); ++f) {
    const auto face = quads.view().face(f);
    for (std::size_t k = 2; k < face.size(); ++k) triangles.add_face({face[0], face[k - 1], face[k]});
  }
  return triangles;
}

Vec3d on_circle(double radius, int i, int segments, double z) {
  const double angle = 2 * pi * (i % segments) / segments;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Adds a closed outline in x and y with a hole, both of the same number of points, extruded along z.
template <class Outer, class Inner>
void add_extrusion(Builder& builder, int points, double height, int stacks, Outer&& outer, Inner&& inner) {
  const auto level = [&](int k) { return -height / 2 + height * k / stacks; };
  builder.grid(points, stacks, [&](int i, int k) { return outer(i, level(k)); });
  builder.grid(stacks, points, [&](int k, int i) { return inner(i, level(k)); });
  for (int i = 0; i < points; ++i) {
    builder.face(
        {outer(i, level(stacks)), outer(i + 1, level(stacks)), inner(i + 1, level(stacks)), inner(i, level(stacks))});
    builder.face({outer(i + 1, level(0)), outer(i, level(0)), inner(i, level(0)), inner(i + 1, level(0))});
  }
}

/// The part of a sphere from a latitude up to the north pole.
Polygons zone(double radius, int segments, int rings, double lowest) {
  require_length("a radius", radius);
  require_count("segments", segments, 3);
  Builder builder;
  builder.grid(segments, rings, [&](int i, int j) {
    const double latitude = lowest + (pi / 2 - lowest) * j / rings;
    const double r = j == rings || (j == 0 && lowest < 0) ? 0 : radius * std::cos(latitude);
    return on_circle(r, i, segments, radius * std::sin(latitude));
  });
  return builder.take();
}

}  // namespace

Polygons icosphere(double radius, int subdivisions) {
  require_length("a radius", radius);
  if (subdivisions < 0 || subdivisions > 10)
    throw InvalidInput(fmt::format("shape: expected subdivisions from 0 to 10, got {}", subdivisions));
  require_room(std::size_t{20} << 2 * subdivisions);
  const double g = std::numbers::phi;
  Polygons mesh;
  for (const auto& p : {Vec3d{-1, g, 0},
                        {1, g, 0},
                        {-1, -g, 0},
                        {1, -g, 0},
                        {0, -1, g},
                        {0, 1, g},
                        {0, -1, -g},
                        {0, 1, -g},
                        {g, 0, -1},
                        {g, 0, 1},
                        {-g, 0, -1},
                        {-g, 0, 1}})
    mesh.positions.push_back(p.unit() * radius);
  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<Triangle> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, added] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
      if (added) mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]).unit() * radius);
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Triangle& t : {Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) finer.push_back(t);
    }
    triangles = std::move(finer);
  }
  for (const auto& [a, b, c] : triangles) mesh.add_face({a, b, c});
  return mesh;
}

Polygons uv_sphere(double radius, int segments, int rings) {
  require_count("rings", rings, 2);
  return zone(radius, segments, rings, -pi / 2);
}

Polygons hemisphere(double radius, int segments, int rings) {
  require_count("rings", rings, 1);
  return zone(radius, segments, rings, 0);
}

Polygons box(const Vec3d& size, int divisions, bool triangles) {
  for (int k = 0; k < 3; ++k) require_length("a size", size[k]);
  require_count("divisions", divisions, 1);
  Builder builder;
  add_box(builder, size * -0.5, size * 0.5, divisions);
  return triangles ? split_quads(builder.take()) : builder.take();
}

Polygons torus(double major, double minor, int segments, int sides) {
  require_length("a minor radius", minor);
  require_length("a major radius beyond the minor one", major - minor);
  require_count("segments", segments, 3);
  require_count("sides", sides, 3);
  Builder builder;
  builder.grid(segments, sides, [&](int i, int j) {
    const double angle = 2 * pi * (j % sides) / sides;
    return on_circle(major + minor * std::cos(angle), i, segments, minor * std::sin(angle));
  });
  return builder.take();
}

Polygons cylinder(double radius, double height, int segments, int stacks, int rings) {
  require_length("a radius", radius);
  require_length("a height", height);
  require_count("segments", segments, 3);
  require_count("stacks", stacks, 1);
  require_count("rings", rings, 1);
  Builder builder;
  builder.grid(segments, stacks,
               [&](int i, int k) { return on_circle(radius, i, segments, -height / 2 + height * k / stacks); });
  const auto ring = [&](int j) { return j == rings ? radius : radius * j / rings; };
  builder.grid(segments, rings, [&](int i, int j) { return on_circle(ring(j), i, segments, -height / 2); });
  builder.grid(segments, rings, [&](int i, int j) { return on_circle(ring(rings - j), i, segments, height / 2); });
  return builder.take();
}

Polygons socket(double radius, double depth, double wall, int segments, int stacks) {
  require_length("a radius", radius);
  require_length("a depth", depth);
  require_length("a wall", wall);
  require_count("segments", segments, 3);
  require_count("stacks", stacks, 1);
  Builder builder;
  const auto between = [&](double from, double to, int k) { return from + (to - from) * k / stacks; };
  builder.grid(segments, stacks,
               [&](int i, int k) { return on_circle(radius + wall, i, segments, between(-wall, depth, k)); });
  builder.grid(stacks, segments, [&](int k, int i) { return on_circle(radius, i, segments, between(0, depth, k)); });
  builder.grid(segments, 1, [&](int i, int j) { return on_circle(j ? radius + wall : 0, i, segments, -wall); });
  builder.grid(segments, 1, [&](int i, int j) { return on_circle(j ? 0 : radius, i, segments, 0); });
  builder.grid(segments, 1, [&](int i, int j) { return on_circle(j ? radius : radius + wall, i, segments, depth); });
  return builder.take();
}

Polygons plates(double width, double thickness, double gap, int divisions) {
  require_length("a width", width);
  require_length("a thickness", thickness);
  require_length("a gap", gap);
  require_count("divisions", divisions, 1);
  Builder builder;
  for (const double z : {-gap / 2 - thickness, gap / 2})
    add_box(builder, {-width / 2, -width / 2, z}, {width / 2, width / 2, z + thickness}, divisions);
  return builder.take();
}

Polygons wedge(double angle, double length, double width, int divisions) {
  require_length("an angle", angle);
  require_length("an angle below 180 degrees", 180 - angle);
  require_length("a length", length);
  require_length("a width", width);
  require_count("divisions", divisions, 1);
  Builder builder;
  const double half = angle * pi / 360;
  for (const int side : {-1, 1})
    builder.grid(divisions, divisions, [&](int i, int j) {
      const double s = length * (side > 0 ? i : divisions - i) / divisions;
      return Vec3d(side * s * std::sin(half), -width / 2 + width * j / divisions, s * std::cos(half));
    });
  return builder.take();
}

Polygons room_corner(double side, int divisions) {
  require_length("a side", side);
  require_count("divisions", divisions, 1);
  Builder builder;
  for (int axis = 0; axis < 3; ++axis)
    builder.grid(divisions, divisions, [&](int i, int j) {
      Vec3d p(0.0);
      p[(axis + 1) % 3] = side * i / divisions;
      p[(axis + 2) % 3] = side * j / divisions;
      return p;
    });
  return builder.take();
}

Polygons diffuser(double inlet, double outlet, double length, int divisions) {
  require_length("an inlet", inlet);
  require_length("an outlet", outlet);
  require_length("a length", length);
  require_count("divisions", divisions, 1);
  Builder builder;
  const auto half_width = [&](double x) {
    return (inlet + (outlet - inlet) * std::clamp(3 * x / length - 1, 0.0, 1.0)) / 2;
  };
  constexpr int kAround[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
  for (int wall = 0; wall < 4; ++wall)
    builder.grid(3 * divisions, divisions, [&](int i, int j) {
      const double x = length * i / (3 * divisions), r = half_width(x);
      const auto at = [&](int k) {
        return j == 0           ? r * kAround[wall][k]
               : j == divisions ? r * kAround[wall + 1][k]
                                : r * (kAround[wall][k] + (kAround[wall + 1][k] - kAround[wall][k]) *
                                                              (static_cast<double>(j) / divisions));
      };
      return Vec3d(x, at(0), at(1));
    });
  return builder.take();
}

Polygons naca_wing(const std::string& digits, double chord, double span, int points, int stacks) {
  if (digits.size() != 4 || !std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; }))
    throw InvalidInput("shape: expected four digits of a NACA section, got '" + digits + "'");
  require_length("a chord", chord);
  require_length("a span", span);
  require_count("points on each side of the section", points, 4);
  require_count("stacks", stacks, 1);
  const double camber = (digits[0] - '0') / 100.0, camber_at = (digits[1] - '0') / 10.0,
               thickness = ((digits[2] - '0') * 10 + (digits[3] - '0')) / 100.0;
  require_length("a thickness (the last two digits)", thickness);
  // The i-th of points + 1 points from nose to trailing edge, on the upper (side = 1) or the lower side (-1). They are
  // denser at both ends.
  const auto section = [&](int i, int side, double y) {
    const double x = (1 - std::cos(pi * i / points)) / 2;
    const double t =
        i == points
            ? 0
            : 5 * thickness * (0.2969 * std::sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - 0.1036 * x))));
    double z = 0, slope = 0;
    if (camber > 0 && camber_at > 0) {
      const double p = camber_at, c = x < p ? camber / (p * p) : camber / ((1 - p) * (1 - p));
      z = x < p ? c * (2 * p * x - x * x) : c * (1 - 2 * p + 2 * p * x - x * x);
      slope = 2 * c * (p - x);
    }
    const double tilt = std::atan(slope);
    return Vec3d(chord * (x - side * t * std::sin(tilt)), y, chord * (z + side * t * std::cos(tilt)));
  };
  Builder builder;
  const auto level = [&](int k) { return -span / 2 + span * k / stacks; };
  builder.grid(points, stacks, [&](int i, int k) { return section(i, 1, level(k)); });
  builder.grid(stacks, points, [&](int k, int i) { return section(i, -1, level(k)); });
  builder.grid(points, 1, [&](int i, int j) { return section(i, j ? 1 : -1, level(0)); });
  builder.grid(1, points, [&](int j, int i) { return section(i, j ? 1 : -1, level(stacks)); });
  return builder.take();
}

Polygons gear(int teeth, double root_radius, double tip_radius, double bore_radius, double thickness, int stacks) {
  require_count("teeth", teeth, 3);
  require_count("stacks", stacks, 1);
  require_length("a bore radius", bore_radius);
  require_length("a root radius beyond the bore", root_radius - bore_radius);
  require_length("a tip radius beyond the root", tip_radius - root_radius);
  require_length("a thickness", thickness);
  // A tooth in 16 steps of angle: 5 on the root, 3 up the flank, 5 on the tip, 3 down.
  constexpr int kSteps = 16;
  const auto radius_at = [&](int i) {
    const int s = i % kSteps;
    const double rise = s < 5 ? 0 : s < 8 ? (s - 4) / 4.0 : s < 13 ? 1 : (16 - s) / 4.0;
    return root_radius + (tip_radius - root_radius) * rise;
  };
  const int points = kSteps * teeth;
  Builder builder;
  add_extrusion(
      builder, points, thickness, stacks, [&](int i, double z) { return on_circle(radius_at(i), i, points, z); },
      [&](int i, double z) { return on_circle(bore_radius, i, points, z); });
  return builder.take();
}

Polygons bumpy_sphere(double radius, double amplitude, double frequency, unsigned seed, int subdivisions) {
  require_length("a frequency", frequency);
  if (!(std::abs(amplitude) < radius)) throw InvalidInput("shape: expected an amplitude below the radius");
  Polygons mesh = icosphere(radius, subdivisions);
  // Raw numbers of the engine are used: they are the same everywhere, unlike those of the library's distributions.
  std::mt19937 engine(seed);
  const auto random = [&] { return static_cast<double>(engine()) / 4294967296.0; };
  struct Wave {
    Vec3d direction;
    double phase;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 12; ++i) {
    const double z = 2 * random() - 1, angle = 2 * pi * random(), r = std::sqrt(1 - z * z);
    waves.push_back(
        {Vec3d(r * std::cos(angle), r * std::sin(angle), z) * (frequency * (0.5 + random())), 2 * pi * random()});
  }
  for (Vec3d& p : mesh.positions) {
    const Vec3d n = p.unit();
    double sum = 0;
    for (const Wave& wave : waves) sum += std::sin(2 * pi * wave.direction.dot(n) + wave.phase);
    p = n * (radius + amplitude * sum / static_cast<double>(waves.size()));
  }
  return mesh;
}

Polygons hollow_box(double side, double wall, int divisions) {
  require_length("a wall", wall);
  require_length("a side beyond both walls", side - 2 * wall);
  require_count("divisions", divisions, 1);
  Builder builder;
  add_box(builder, Vec3d(-side / 2), Vec3d(side / 2), divisions);
  add_box(builder, Vec3d(-side / 2 + wall), Vec3d(side / 2 - wall), divisions, true);
  return builder.take();
}

Polygons patch(double side, double amplitude, int divisions) {
  require_length("a side", side);
  require_count("divisions", divisions, 1);
  if (!std::isfinite(amplitude)) throw InvalidInput("shape: expected a finite amplitude");
  Builder builder;
  builder.grid(divisions, divisions, [&](int i, int j) {
    const double u = static_cast<double>(i) / divisions, v = static_cast<double>(j) / divisions;
    return Vec3d(side * (u - 0.5), side * (v - 0.5), amplitude * std::sin(2 * pi * u) * std::sin(2 * pi * v));
  });
  return builder.take();
}

}  // namespace vdb_offset::shapes
