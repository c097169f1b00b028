// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// The largest sine of the angle between normals of faces on one plane. Reasoned: far above the rounding of coordinates
/// with seven digits, far below all bends that are meant.
inline constexpr double kOnePlaneSine = 1e-4;

/// The largest tilt of a face that stands for a plane (see Surface::tilt). Reasoned: far below the bends of creases.
inline constexpr double kMostTilt = 0.01;

/// The planes around a vertex: their normals, the areas of the faces on each, up to a factor, and by how much the
/// largest of these may be tilted.
struct PlanesAround {
  std::vector<Vec3d> normals;
  std::vector<double> areas, tilts;
};

/// The planes of some faces of a Surface or Polyline, each once: with the normal of the largest of the faces on it,
/// which is best. normal_of(face) and tilt_of(face), the sine of the angle by which that may be wrong, are called of
/// faces that have an area; those that may be tilted by more than kMostTilt are left out.
template <class Shape, class NormalOf, class TiltOf>
PlanesAround planes_of(const Shape& shape, std::span<const std::uint32_t> of, NormalOf&& normal_of, TiltOf&& tilt_of) {
  std::vector<std::pair<double, std::uint32_t>> faces;
  for (const auto t : of)
    if (shape.triangle_normals[t].lengthSqr() > 0) faces.emplace_back(-shape.extent(t), t);
  std::sort(faces.begin(), faces.end());
  PlanesAround planes;
  for (const auto& [less, t] : faces) {
    const Vec3d& normal = normal_of(t);
    const double tilt = tilt_of(t), most = kOnePlaneSine + tilt;
    if (tilt > kMostTilt) continue;
    const auto alike = std::find_if(planes.normals.begin(), planes.normals.end(),
                                    [&](const Vec3d& plane) { return (plane - normal).lengthSqr() < most * most; });
    if (alike != planes.normals.end()) {
      planes.areas[static_cast<std::size_t>(alike - planes.normals.begin())] -= less;
      continue;
    }
    planes.normals.push_back(normal);
    planes.areas.push_back(-less);
    planes.tilts.push_back(tilt);
  }
  return planes;
}
/// Those around a vertex.
template <class Shape, class NormalOf, class TiltOf>
PlanesAround planes_around(const Shape& shape, std::uint32_t vertex, NormalOf&& normal_of, TiltOf&& tilt_of) {
  return planes_of(shape, shape.triangles_around(vertex), normal_of, tilt_of);
}
template <class Shape, class NormalOf>
PlanesAround planes_around(const Shape& shape, std::uint32_t vertex, NormalOf&& normal_of) {
  return planes_around(shape, vertex, normal_of, [](std::uint32_t) { return 0.0; });
}

}  // namespace vdb_offset
