// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "space/query/closest_query.h"
#include "space/surface/surface.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

int side_of_point(PolygonView polygons, const Vec3d& point, const WeldOptions& weld, Orient orient) {
  Surface surface = build_surface(polygons, weld, orient);
  if (surface.triangles.empty()) throw InvalidInput("side: expected faces with an area, got none");
  to_frame(surface, surface.vertices[surface.triangles[0][0]]);
  const ClosestQuery query(surface);
  const Vec3d x = point - surface.origin;
  const Closest closest = query(x, 0);
  const Vec3d away = x - closest.point;
  const double height = surface.pseudonormal(closest.triangle, closest.feature).dot(away);
  // As far as positions of single precision may be off.
  constexpr double kOnSurface = 1e-7;
  if (!(away.length() > kOnSurface * surface.facts.diagonal) || height == 0)
    throw InvalidInput(
        fmt::format("side: expected a point on one side of the surface, got ({:.6g}, {:.6g}, {:.6g}) on it", point[0],
                    point[1], point[2]));
  return height > 0 ? 1 : -1;
}

}  // namespace vdb_offset
