// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Twice the area vector of a polygon, along its normal: relative to its first corner, so that far-away polygons lose
/// no digits.
Vec3d area_vector(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon);
/// The same of a mesh's face.
inline Vec3d area_vector(PolygonView mesh, std::size_t face) { return area_vector(mesh.positions, mesh.face(face)); }

/// Splits one polygon into `size - 2` triangles over its own corners, appended to `triangles` as vertex indices
/// in the polygon's own direction: the fan around its first corner, which is what most programs take a polygon for
/// that is not flat, and a quad in any case. A flat polygon of five corners or more that its fan does not cover once
/// or that has more than a thousand, is split by clipping ears, so that the triangles cover it and nothing else. A
/// polygon that crosses itself gets triangles too; they then overlap. Where one of the triangles would be a line, as a
/// corner of a flat polygon is on a straight side, ears or a quad's other diagonal are taken, if all triangles have an
/// area then. Cost: O(corners) for a fan, about corners * log(corners) for ears (see ear_clipper.h).
void triangulate(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon,
                 std::vector<std::array<std::uint32_t, 3>>& triangles);

/// Appends the triangles of a mesh's face: those that the mesh gives, or else those of triangulate().
void append_triangles(PolygonView mesh, std::size_t face, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace vdb_offset
