// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ground/mesh/point_triangle.h"
#include "products/iso/iso_source.h"
#include "space/surface/surface.h"
#include "vdb_offset/iso_surface.h"

namespace vdb_offset {

/// A point on a face of a mesh, inside a triangle of three of the face's corners.
struct SourcePoint {
  std::uint32_t face = 0;
  std::array<std::uint32_t, 3> corner{};  ///< Indices into PolygonView::corners.
  std::array<double, 3> weight{};         ///< Barycentric: >= 0, their sum is 1.
};

/// Finds the points of the source that are closest to the vertices and faces of an iso-surface, for their attributes.
class SourceLookup {
 public:
  /// Keeps references to both.
  /// \param mesh the source
  SourceLookup(const IsoResult& iso, PolygonView mesh);

  /// Cuts the source into charts, as texture coordinates do: triangles are in one chart if they share an edge, and the
  /// values at both of its ends. Without this, all of the source is one chart.
  /// \param value_of_corner of each of the mesh's corners: the number of its value
  void cut_into_charts(std::span<const std::uint32_t> value_of_corner);

  /// The point closest to a vertex.
  SourcePoint at_vertex(std::uint32_t vertex) const;
  /// The face closest to the centre of a triangle.
  std::uint32_t face_of(std::size_t triangle) const { return source().face[home_[triangle]]; }
  /// The point that corner k of a triangle takes its values from: closest to its vertex in the chart of the triangle
  /// that is closest to the centre, so that no seam is inside of a triangle.
  SourcePoint at_corner(std::size_t triangle, std::size_t k) const;

 private:
  const Surface& source() const { return iso_.source->surface; }
  Vec3d local(std::uint32_t vertex) const { return iso_.polygons.positions[vertex] - source().origin; }
  std::uint32_t corner_at(std::uint32_t triangle, std::size_t k) const;
  SourcePoint point_on(std::uint32_t triangle, const Vec3d& x) const;
  std::uint32_t closest_in_chart(const Vec3d& x, std::uint32_t start) const;

  const IsoResult& iso_;
  PolygonView mesh_;
  std::vector<std::uint32_t> home_;  // of each triangle of the iso-surface: the source's triangle closest to its centre
  std::vector<std::uint32_t> chart_;  // of each of the source's triangles; empty if all are in one chart
};

}  // namespace vdb_offset
