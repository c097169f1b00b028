// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "space/surface/surface.h"

/// Start directions of vertices, for those of a Surface and of a Polyline alike.
namespace vdb_offset {

/// Start direction of a vertex, of unit length, and the least cosine between it and the normals of the vertex's faces.
struct StartDirection {
  Vec3d direction;
  double slope;
};

template <class Shape>
double least_cosine(const Shape& surface, std::uint32_t vertex, const Vec3d& n, std::uint32_t* worst = nullptr) {
  double least = 1;
  for (const auto t : surface.triangles_around(vertex)) {
    const Vec3d& normal = surface.triangle_normals[t];
    if (normal.lengthSqr() == 0) continue;
    const double cosine = normal.dot(n);
    if (cosine >= least) continue;
    least = cosine;
    if (worst) *worst = t;
  }
  return least;
}

/// The angle-weighted normal, at a border along the border's plane; where faces turn away from it, a direction that
/// more of them face (the most visible one, found by leaning towards the worst face in ever smaller steps); where faces
/// cancel, the first face's normal; none if a plane holds the vertex that this leads out of.
template <class Shape>
StartDirection start_of(const Shape& surface, std::uint32_t vertex) {
  Vec3d n = surface.along_border(vertex, surface.vertex_normals[vertex]);
  if (!(n.lengthSqr() > 1e-12)) {
    for (const auto t : surface.triangles_around(vertex))
      if (surface.triangle_normals[t].lengthSqr() > 0 && !surface.is_held(vertex))
        return {surface.triangle_normals[t], 0};
    return {Vec3d(0.0), 0};
  }
  n.normalize();
  StartDirection best{n, least_cosine(surface, vertex, n)};
  // Cosine from which a direction is not looked for further: 73 degrees to the worst face. Not measured; 40 steps of
  // 1 / 2, 1 / 3 ... turn a direction anywhere.
  constexpr double kWellSeen = 0.3;
  for (int i = 0; i < 40 && best.slope < kWellSeen; ++i) {
    std::uint32_t worst = kNone;
    least_cosine(surface, vertex, n, &worst);
    if (worst == kNone) break;
    n += surface.along_border(vertex, surface.triangle_normals[worst]) * (1.0 / (i + 2));
    if (!(n.lengthSqr() > 1e-12)) break;
    n.normalize();
    const double slope = least_cosine(surface, vertex, n);
    if (slope > best.slope) best = {n, slope};
  }
  return best;
}

}  // namespace vdb_offset
