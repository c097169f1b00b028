// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "motion/parts/mesh_parts.h"
#include "products/tolerance/refined_triangles.h"
#include "space/query/closest_query.h"
#include "space/query/obstacles.h"
#include "space/surface/border_planes.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/options.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Where a vertex goes.
struct VertexTarget {
  Vec3d displacement{0.0};  ///< World units.
  Vec3d away{0.0};          ///< Of unit length: from the closest point of the surface to the end.
  bool is_there = false;    ///< It gets to its distance, or to that from its own plane with Corners::Miter.
  bool is_mitered = false;  ///< The latter, and is farther from the surface.
};

/// Finds where vertices go that were added on a surface: between two vertices of the offset to the nearest point at the
/// distance that was asked for; and where one of those two falls short, or that finds nothing, in the direction that
/// the displacements of the surface's own vertices have there, interpolated. So the parameterization is transported
/// from the source to the offset (Wang, Guibault, Camarero, Tchon, AIAA 2005), on round corners and in valleys alike:
/// what is between two vertices in the source is between them in the offset.
///
/// Where the surface's vertices are mitered, what lies in the plane of one face goes to that plane, moved by the
/// distance, if nothing else is nearer there.
///
/// What is added on a border that stays in a plane stays in it, too.
class InterpolatedTargets {
 public:
  /// Keeps references. \param miter_limit how many distances vertices go at most to the planes of their faces
  /// \param displacement of the vertices of parts.surface(), or the direction to begin with where a vertex falls short,
  /// as long as its distance
  InterpolatedTargets(const MeshParts& parts, const ClosestQuery& query, const Obstacles* obstacles, Corners corners,
                      double miter_limit, std::vector<Vec3d> displacement);

  /// In the direction of the displacements there. \param position world coordinates; \param asked not 0
  VertexTarget along(const SurfacePlace& place, const Vec3d& position, double asked) const;
  /// From between two vertices of the offset, world coordinates, to the point nearest to that which is at the distance;
  /// beside one that is mitered, to the planes of the faces at the place, moved by the distance, if nothing else is
  /// nearer there.
  VertexTarget beside(const SurfacePlace& place, const Vec3d& position, double asked, const Vec3d& between,
                      bool is_by_miter) const;

 private:
  struct Ray;
  PlaneNormals planes_at(const SurfacePlace& place) const;
  Ray ray_along(const SurfacePlace& place, const Vec3d& origin, const Vec3d& displacement, double asked) const;
  std::vector<std::uint32_t> triangles_at(const SurfacePlace& place) const;
  Ray within_limit(const Ray& ray, const Vec3d& displacement, const Vec3d& across) const;
  VertexTarget in_plane(const Ray& ray) const;
  VertexTarget pushed_out(const Vec3d& from, const Vec3d& origin, double asked, Closest closest) const;
  VertexTarget from_between(const SurfacePlace& place, const Vec3d& origin, double asked, const Vec3d& between,
                            bool is_by_miter) const;
  std::optional<Vec3d> in_planes(const SurfacePlace& place, const Vec3d& origin, double asked, const Vec3d& between,
                                 const PlaneNormals& held) const;
  bool is_before_faces(const SurfacePlace& place, const Vec3d& displacement, double asked) const;
  bool is_first_on_the_way(const SurfacePlace& place, const Vec3d& origin, double asked,
                           const VertexTarget& target) const;
  std::uint32_t hint_at(const SurfacePlace& place) const;
  VertexTarget at_distance(const Ray& ray) const;
  bool is_free(const Ray& ray, double length, double distance) const;
  VertexTarget end_of(const Ray& ray, double length, const Closest& closest, bool is_mitered) const;

  const MeshParts& parts_;
  const ClosestQuery& query_;
  const Obstacles* obstacles_;
  Corners corners_;
  double miter_limit_;
  std::vector<Vec3d> displacement_;
};

}  // namespace vdb_offset
