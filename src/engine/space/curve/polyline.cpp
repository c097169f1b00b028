// SPDX-License-Identifier: Apache-2.0
#include "space/curve/polyline.h"

#include <algorithm>

namespace vdb_offset {
namespace {

/// Gives each vertex the number of the chain that its first segment is part of.
void find_components(Polyline& line) {
  line.component.assign(line.vertices.size(), kNone);
  std::vector<std::uint32_t> todo;
  for (std::uint32_t v = 0; v < line.vertices.size(); ++v) {
    if (line.component[v] != kNone) continue;
    const auto number = static_cast<std::uint32_t>(line.facts.components++);
    line.component[v] = number;
    for (todo.push_back(v); !todo.empty();) {
      const auto at = todo.back();
      todo.pop_back();
      for (const auto s : line.triangles_around(at))
        for (const auto next : line.segments[s])
          if (line.component[next] == kNone) {
            line.component[next] = number;
            todo.push_back(next);
          }
    }
  }
}

void find_normals(Polyline& line) {
  line.vertex_normals.assign(line.vertices.size(), Vec3d(0.0));
  if (line.facts.ends > 0) line.conormals.assign(line.vertices.size(), Vec3d(0.0));
  for (const auto& [a, b] : line.segments) {
    const Vec3d along = (line.vertices[b] - line.vertices[a]).unit(), normal(along[1], -along[0], 0);
    line.triangle_normals.push_back(normal);
    for (const auto v : {a, b}) {
      line.vertex_normals[v] += normal;
      if (line.triangles_around(v).size() == 1) line.conormals[v] = v == b ? along : -along;
    }
  }
}

}  // namespace

Polyline make_polyline(std::vector<Vec3d> vertices, std::vector<Segment> segments, const CurveChains& chains) {
  Polyline line;
  line.vertices = std::move(vertices);
  line.segments = std::move(segments);
  line.facts.ends = chains.ends;
  line.facts.branchings = chains.branchings;
  line.incident_begin.assign(line.vertices.size() + 1, 0);
  for (const Segment& segment : line.segments)
    for (const auto v : segment) ++line.incident_begin[v + 1];
  for (std::size_t v = 0; v < line.vertices.size(); ++v) line.incident_begin[v + 1] += line.incident_begin[v];
  std::vector<std::uint32_t> next(line.incident_begin.begin(), line.incident_begin.end() - 1);
  line.incident.resize(2 * line.segments.size());
  for (std::uint32_t s = 0; s < line.segments.size(); ++s)
    for (const auto v : line.segments[s]) line.incident[next[v]++] = s;
  find_components(line);
  find_normals(line);
  return line;
}

TrianglePoint Polyline::closest_on(std::uint32_t segment, const Vec3d& x) const {
  const auto [a, b] = segments[segment];
  return detail::closest_on_segment(x, vertices[a], vertices[b], Feature::Vertex0, Feature::Vertex1, Feature::Face);
}

Vec3d Polyline::across(std::uint32_t, Feature feature, const Vec3d& away, const Vec3d& displacement) const {
  return feature == Feature::Face ? away * (away.dot(displacement) / away.lengthSqr()) : displacement;
}

Vec3d Polyline::pseudonormal(std::uint32_t segment, Feature feature) const {
  return feature == Feature::Face ? triangle_normals[segment]
                                  : vertex_normals[segments[segment][feature == Feature::Vertex1]];
}

}  // namespace vdb_offset
