// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "space/curve/ribbon.h"
#include "space/surface/surface.h"

namespace vdb_offset {

/// Plane curves as the stages see them: what a Surface is to a mesh. Segments take the part of triangles, under the
/// same names, so that one template serves both. Vertices are in the frame of the ribbon that the field is made from,
/// half way up it.
struct Polyline {
  Vec3d origin{0.0};
  std::vector<Vec3d> vertices;          ///< The curves' points that segments use.
  std::vector<Segment> segments;        ///< Between vertices, in the order of the chains.
  std::vector<Vec3d> triangle_normals;  ///< Of each segment: unit length, to its right, outward.
  std::vector<Vec3d> vertex_normals;    ///< Sum of the normals of the vertex's segments.
  std::vector<Vec3d> conormals;         ///< Along the curve at its ends, zero elsewhere; empty if nothing ends.
  std::vector<std::uint32_t> incident, incident_begin;  ///< Segments around vertices.
  std::vector<std::uint32_t> component;                 ///< Chain of each vertex; one of them where several meet.
  struct Facts {
    std::size_t components = 0, ends = 0, branchings = 0;
    bool closed() const { return ends == 0 && branchings == 0; }
    bool oriented() const { return branchings == 0; }
  } facts;

  std::span<const std::uint32_t> triangles_around(std::uint32_t vertex) const {
    return std::span(incident).subspan(incident_begin[vertex], incident_begin[vertex + 1] - incident_begin[vertex]);
  }
  Vec3d along_border(std::uint32_t vertex, const Vec3d& v) const {
    return conormals.empty() ? v : v - conormals[vertex] * conormals[vertex].dot(v);
  }
  /// See Surface::is_held.
  bool is_held(std::uint32_t) const { return false; }
  TrianglePoint closest_on(std::uint32_t segment, const Vec3d& x) const;
  /// See Surface::extent.
  double extent(std::uint32_t segment) const {
    return (vertices[segments[segment][1]] - vertices[segments[segment][0]]).length();
  }
  /// Whether the line through a segment is clearly farther from x than a squared distance. A quick test: boxes around
  /// long tilted segments are large, and finding the closest point takes several times as long.
  bool is_farther(std::uint32_t segment, const Vec3d& x, double squared_distance) const {
    constexpr double kRounding = 1e-14, kShare = 1 + 1e-12;
    const Vec3d &a = vertices[segments[segment][0]], &b = vertices[segments[segment][1]];
    const double dx = b[0] - a[0], dy = b[1] - a[1], left = dx * (x[1] - a[1]), right = dy * (x[0] - a[0]);
    const double off = std::abs(left - right) - kRounding * (std::abs(left) + std::abs(right));
    return off > 0 && off * off > kShare * squared_distance * (dx * dx + dy * dy);
  }
  /// See Surface::across.
  Vec3d across(std::uint32_t segment, Feature feature, const Vec3d& away, const Vec3d& displacement) const;
  /// See Surface::pseudonormal.
  Vec3d pseudonormal(std::uint32_t segment, Feature feature) const;
};

/// \param vertices of the joined curves' points that segments use, in the ribbon's frame
Polyline make_polyline(std::vector<Vec3d> vertices, std::vector<Segment> segments, const CurveChains& chains);

}  // namespace vdb_offset
