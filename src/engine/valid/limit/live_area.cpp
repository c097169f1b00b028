// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/live_area.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// Share of the line from a corner to the centre of its face, or to another corner: the point there stands for the
// corner's third of the face. Not measured.
constexpr double kInThird = 0.6;

// Share of area that is not live which counts all the same, as it may well reach its distance by sliding. Not measured.
constexpr double kOfDead = 0.01;

// A point is live if nothing of the moving part is nearer to its image than this share of the distance. Reasoned: 1,
// but for rounding.
constexpr double kLive = 1 - 1e-9;

// Halvings that find where on a line the live part begins, to 1 / 4096 of the line. Reasoned.
constexpr int kLineHalvings = 12;

// Most positions that are tried for a vertex. Not measured.
constexpr std::size_t kMostPositions = 8;

}  // namespace

LiveArea::LiveArea(const ConstrainedSurface& constrained, const Distances& distances)
    : constrained_(constrained),
      surface_(constrained.surface),
      distances_(distances),
      live_(constrained.surface.vertices.size(), -1.0),
      area_(constrained.surface.vertices.size(), 0.0) {
  for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t) {
    if (!counts(t)) continue;
    const double area = area_of(t);
    whole_area_ += area;
    for (const auto v : surface_.triangles[t]) area_[v] += area / 3;
  }
}

bool LiveArea::counts(std::uint32_t t) const {
  return constrained_.triangle_on_part(t) && surface_.triangle_normals[t].lengthSqr() > 0;
}

double LiveArea::area_of(std::uint32_t t) const {
  const auto& [a, b, c] = surface_.triangles[t];
  const auto& x = surface_.vertices;
  return (x[b] - x[a]).cross(x[c] - x[a]).length() / 2;
}

void LiveArea::measure(const std::vector<std::uint32_t>& vertices) {
  for_each_index(
      vertices.size(),
      [&](std::size_t i) {
        double& live = live_[vertices[i]];
        if (live < 0) live = find(vertices[i]);
      },
      16);
}

double LiveArea::find(std::uint32_t v) const {
  if (!constrained_.vertex_on_part(v) || distances_[v] == 0) return 0;
  double live = 0;
  std::uint32_t hint = constrained_.hint(v);
  for (const auto t : surface_.triangles_around(v))
    if (counts(t)) {
      const Vec3d inward = (centre(t) - surface_.vertices[v]) * kInThird;
      live += area_of(t) / 3 * (image(v, t, inward, hint).live ? 1 : kOfDead);
    }
  return live;
}

Vec3d LiveArea::centre(std::uint32_t t) const {
  const auto& [a, b, c] = surface_.triangles[t];
  return (surface_.vertices[a] + surface_.vertices[b] + surface_.vertices[c]) / 3.0;
}

/// The image of the point of a triangle that lies `along` from a vertex.
LiveArea::Image LiveArea::image(std::uint32_t v, std::uint32_t t, const Vec3d& along, std::uint32_t& hint) const {
  const Vec3d position = surface_.vertices[v] + along + surface_.triangle_normals[t] * distances_[v];
  const Closest closest = constrained_.moving_part(position, hint);
  hint = closest.triangle;
  return {position, closest.distance >= std::abs(distances_[v]) * kLive};
}

bool LiveArea::is_at_border(std::uint32_t v) const {
  const auto& conormals = constrained_.moving_part.surface().conormals;
  return !conormals.empty() && conormals[constrained_.part_vertex_of(v)] != Vec3d(0.0);
}

/// Whether the faces around a vertex agree about the outside: along each edge as many run one way as the other, borders
/// aside.
bool LiveArea::faces_agree(std::uint32_t v) const {
  std::vector<std::pair<std::uint32_t, int>> ends;
  for (const auto t : surface_.triangles_around(v))
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = surface_.triangles[t][k], to = surface_.triangles[t][(k + 1) % 3];
      if (from == v) ends.emplace_back(to, 1);
      if (to == v) ends.emplace_back(from, -1);
    }
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 0, next = 0; i < ends.size(); i = next) {
    int sum = 0;
    for (; next < ends.size() && ends[next].first == ends[i].first; ++next) sum += ends[next].second;
    if (sum != 0 && next - i > 1) return false;
  }
  return true;
}

std::vector<Vec3d> LiveArea::ends_of_lines(std::uint32_t v, std::uint32_t t, Lines lines) const {
  if (lines == Lines::All || !is_at_border(v)) return {centre(t)};
  std::vector<Vec3d> ends;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t edge = 3 * t + k, from = surface_.from(edge), to = surface_.to(edge);
    if (surface_.next_around_edge[edge] == edge && (from == v || to == v))
      ends.push_back(surface_.vertices[from == v ? to : from]);
  }
  return ends;
}

/// The image of the live point on a line from a vertex that is nearest to it, if the point at kInThird is live.
std::optional<Vec3d> LiveArea::first_live(std::uint32_t v, std::uint32_t t, const Vec3d& line,
                                          std::uint32_t& hint) const {
  Image found = image(v, t, line * kInThird, hint);
  if (!found.live) return std::nullopt;
  if (const Image at_vertex = image(v, t, Vec3d(0.0), hint); at_vertex.live) return at_vertex.position;
  double dead = 0, live = kInThird;
  for (int i = 0; i < kLineHalvings; ++i) {
    const double middle = (dead + live) / 2;
    const Image there = image(v, t, line * middle, hint);
    (there.live ? live : dead) = middle;
    if (there.live) found = there;
  }
  return found.position;
}

std::vector<Vec3d> LiveArea::positions_with_room(std::uint32_t v, Lines lines) const {
  std::vector<Vec3d> positions;
  if (!faces_agree(v)) return positions;
  std::vector<std::pair<double, std::uint32_t>> faces;
  for (const auto t : surface_.triangles_around(v))
    if (counts(t)) faces.emplace_back(-area_of(t), t);
  std::sort(faces.begin(), faces.end());
  std::uint32_t hint = constrained_.hint(v);
  for (const auto& [area, t] : faces)
    for (const Vec3d& end : ends_of_lines(v, t, lines)) {
      if (positions.size() == kMostPositions) return positions;
      if (const auto position = first_live(v, t, end - surface_.vertices[v], hint)) positions.push_back(*position);
    }
  return positions;
}

}  // namespace vdb_offset
