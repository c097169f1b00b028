// SPDX-License-Identifier: Apache-2.0
#include "support/oracles.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "products/cells/number_cells.h"
#include "products/volume/cell_quality.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/result.h"
#include "vdb_offset/shapes.h"

namespace vdb_offset::test {
namespace {

double segment_distance(const Vec3d& x, const Vec3d& a, const Vec3d& b) {
  const Vec3d d = b - a;
  const double t = d.lengthSqr() > 0 ? std::clamp((x - a).dot(d) / d.lengthSqr(), 0.0, 1.0) : 0.0;
  return (x - a - d * t).length();
}

double triangle_distance(const Vec3d& x, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double edges = std::min({segment_distance(x, a, b), segment_distance(x, b, c), segment_distance(x, c, a)});
  Vec3d n = (b - a).cross(c - a);
  if (n.length() < 1e-14 * std::max((b - a).lengthSqr(), (c - a).lengthSqr())) return edges;
  n /= n.length();  // not normalize(), which leaves short vectors as they are
  const double height = (x - a).dot(n);
  const Vec3d p = x - n * height;
  const bool inside =
      (b - a).cross(p - a).dot(n) >= 0 && (c - b).cross(p - b).dot(n) >= 0 && (a - c).cross(p - c).dot(n) >= 0;
  return inside ? std::abs(height) : edges;
}

/// Polygons are what their triangles are: a concave one, bent by noise, has more than one surface else.
template <class Visit>
void for_each_triangle(PolygonView mesh, Visit&& visit) {
  for (const auto& [a, b, c] : split_polygons(mesh)) visit(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
}

}  // namespace

std::pair<Polygons, std::vector<double>> far_sphere() {
  Polygons mesh = shapes::icosphere(0.01, 4);
  std::vector<double> distances;
  for (Vec3d& p : mesh.positions) {
    distances.push_back(p[2] > 0.001 ? 0.001 : 0);
    p += Vec3d(100);
  }
  return {std::move(mesh), std::move(distances)};
}

Polygons torn(const Polygons& mesh) {
  Polygons soup;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (const auto v : mesh.view().face(f)) {
      soup.corners.push_back(static_cast<std::uint32_t>(soup.positions.size()));
      soup.positions.push_back(mesh.positions[v]);
    }
    soup.close_face();
  }
  return soup;
}

Polygons oblique_tube() {
  Polygons mesh;
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}})
      mesh.positions.emplace_back(x + 0.577 * z, y, z);
  for (std::uint32_t i = 0; i < 4; ++i) mesh.add_face({i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i});
  return mesh;
}

Polygons open_loft(std::uint32_t count) {
  Polygons mesh;
  for (const bool is_above : {false, true})
    for (std::uint32_t i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count, x = std::cos(angle), y = std::sin(angle),
                   far = is_above ? 20 / std::max(std::abs(x), 2 * std::abs(y)) : 10;
      mesh.positions.emplace_back(far * x, far * y, is_above ? 30 : 0);
    }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    mesh.add_face({i, next, count + next});
    mesh.add_face({i, count + next, count + i});
  }
  return mesh;
}

double brute_force_distance(PolygonView mesh, const Vec3d& x) {
  double least = std::numeric_limits<double>::infinity();
  for_each_triangle(mesh, [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    least = std::min(least, triangle_distance(x, a, b, c));
  });
  return least;
}

double enclosed_volume(const Polygons& mesh) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    for (std::size_t k = 2; k < face.size(); ++k)
      sum += mesh.positions[face[0]].dot(mesh.positions[face[k - 1]].cross(mesh.positions[face[k]])) / 6;
  }
  return sum;
}

bool is_inside(PolygonView mesh, const Vec3d& x) {
  double winding = 0;
  for_each_triangle(mesh, [&](const Vec3d& p, const Vec3d& q, const Vec3d& r) {
    const Vec3d a = p - x, b = q - x, c = r - x;
    const double la = a.length(), lb = b.length(), lc = c.length();
    // Van Oosterom and Strackee, The solid angle of a plane triangle, 1983.
    winding += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  });
  return winding > 2 * std::numbers::pi;
}

DistanceErrors judge(PolygonView source, const OffsetResult& result, double distance, std::size_t stride, bool closed) {
  DistanceErrors errors;
  const double target = std::abs(distance);
  for (std::size_t v = 0; v < result.positions.size(); v += stride) {
    if (result.states[v] == VertexState::Unused) continue;
    const double truth = brute_force_distance(source, result.positions[v]);
    errors.worst_told = std::max(errors.worst_told, std::abs(truth - result.achieved[v]) / target);
    errors.worst_beyond = std::max(errors.worst_beyond, (truth - target) / target);
    if (result.states[v] == VertexState::Reached)
      errors.worst_reached = std::max(errors.worst_reached, std::abs(truth - target) / target);
    if (closed && truth > 1e-6 * target) errors.wrong_side += is_inside(source, result.positions[v]) != (distance < 0);
  }
  return errors;
}

double share(const OffsetResult& result, VertexState state) {
  const auto& by_state = result.statistics.vertices_by_state;
  std::size_t used = 0;
  for (std::size_t s = 0; s < kVertexStateCount; ++s)
    if (static_cast<VertexState>(s) != VertexState::Unused) used += by_state[s];
  return static_cast<double>(by_state[static_cast<std::size_t>(state)]) / static_cast<double>(used);
}

void check_measured(const LayerQuality& measured, const VolumeMesh& made, const LayersResult& layers,
                    const LayerCells& cells) {
  REQUIRE(made.cell_count() == cells.count());
  const auto types = [&](std::size_t layer) {
    const auto first = made.cell_types.begin() + static_cast<std::ptrdiff_t>(cells.first_in(layer));
    return std::vector<CellType>(first, first + static_cast<std::ptrdiff_t>(cells.in_layer(layer)));
  };
  CHECK(measured.types == types(0));
  for (std::size_t layer = 1; layer < cells.layers; ++layer)
    CHECK((measured.upper_types.empty() ? measured.types : measured.upper_types) == types(layer));
  CHECK(measured.points == made.points.size());
  CHECK(measured.volume == Approx(enclosed_volume(made)).epsilon(1e-9));
  CHECK(measured.scaled_jacobian == quality_fields(made)[0].values);
  CHECK(measured.aspect_ratio == quality_fields(made)[1].values);
  REQUIRE(measured.wall_angle.size() == cells.in_layer(0));
  std::size_t wrong = 0;
  for (std::size_t c = 0; c < cells.columns.count(); ++c) {
    std::vector<Vec3d> wall, first;
    const auto ring = cells.columns.ring(c);
    bool in_fan = false;
    for (std::size_t k = 0; k < ring.size(); ++k)
      in_fan = in_fan || cells.points.foot(ring[k]) == cells.points.foot(ring[(k + 1) % ring.size()]);
    for (const auto p : cells.columns.ring(c)) {
      const auto stack = layers.stacks.of(cells.points.vertex[p]);
      wall.push_back(stack[0]), first.push_back(stack[1]);
    }
    const auto& numbers = cells.columns.in(0).cells;
    for (auto cell = numbers[c]; cell < numbers[c + 1]; ++cell)
      wrong += in_fan ? !std::isnan(measured.wall_angle[cell])
                      : measured.wall_angle[cell] != Approx(wall_angle(wall, first)).epsilon(1e-7).margin(1e-12);
  }
  CHECK(wrong == 0);
}

}  // namespace vdb_offset::test
