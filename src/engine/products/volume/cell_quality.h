// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "products/volume/prism_quality.h"
#include "vdb_offset/cells.h"

namespace vdb_offset {

/// The least triple product of unit edge vectors over a cell's corners, as VTK and Verdict define it (Stimpson et al.,
/// The Verdict Geometric Quality Library, 2007): 1 for a cube, a regular tetrahedron (factor sqrt 2), a prism over a
/// regular triangle (factor 2 / sqrt 3) and a pyramid with edges of one length; for hexahedra the triple product of the
/// principal axes counts, too. At most 1; below 0 for a cell that is inside out somewhere, and 0 where an edge has no
/// length. A pyramid has that of the worst of the four tetrahedra over its base's corners; other than Verdict's, it
/// keeps its sign below 0. Polyhedra: see polygon_prism.h. Triangles (factor 2 / sqrt 3) and quadrilaterals: the least
/// sine of a corner.
double scaled_jacobian(const VolumeMesh& mesh, std::size_t cell);

/// The length of the longest edge divided by that of the shortest; infinite if the latter is 0.
double aspect_ratio(const VolumeMesh& mesh, std::size_t cell);

/// The volume of a cell, world units^3; of a cell of a plane mesh its area, world units^2. Faces that are not flat are
/// split into the fan around their corner with the lowest index, so that the cells on both sides agree, and the volumes
/// of all cells sum up to the volume inside the boundary.
double cell_volume(const VolumeMesh& mesh, std::size_t cell);

/// Six times the volume between a face and `origin`, signed: the sum over a closed boundary is six times the volume
/// inside it. `position` gives the position of a corner.
template <class Position>
double six_volumes_below(std::span<const std::uint32_t> face, const Vec3d& origin, Position&& position) {
  const std::size_t n = face.size();
  const auto first = static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
  const auto corner = [&](std::size_t k) -> Vec3d { return position(face[(first + k) % n]) - origin; };
  const Vec3d fan = corner(0);
  double sum = 0;
  for (std::size_t k = 2; k < n; ++k) sum += fan.dot(corner(k - 1).cross(corner(k)));
  return sum;
}
inline double six_volumes_below(std::span<const Vec3d> points, std::span<const std::uint32_t> face,
                                const Vec3d& origin) {
  return six_volumes_below(face, origin, [&](std::uint32_t p) -> const Vec3d& { return points[p]; });
}

/// The scaled Jacobian and the aspect ratio of a cell, for which each edge of a prism or hexahedron is looked at once.
CellQuality cell_quality(const VolumeMesh& mesh, std::size_t cell);

/// The fields "scaled_jacobian" and "aspect_ratio" of all cells.
std::array<VolumeField, 2> quality_fields(const VolumeMesh& mesh);

/// The volume inside the boundary, which is the sum of all cells' volumes. The result does not depend on the number of
/// threads.
double enclosed_volume(const VolumeMesh& mesh);

/// The angle in degrees, 0 .. 90, between the normal of a face of the wall, or of a segment, and the mean of the edges
/// that rise from its corners to the first layer: 0 is best. 90 if either has no direction. \pre `first` has a position
/// for each corner of `wall`.
double wall_angle(std::span<const Vec3d> wall, std::span<const Vec3d> first);

}  // namespace vdb_offset
