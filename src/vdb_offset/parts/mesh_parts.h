#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/options.h"
#include "vdb_offset/parts/constrained_surface.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

struct MeshPartsOptions {
  std::span<const std::uint8_t> only;  ///< Of each face: 1 if it is part of the front. Empty: all are.
  PolygonView obstacles;               ///< Without faces: none.
  WeldOptions weld;
  Orient orient = Orient::Keep;
};

/// A mesh, sorted into what distances are measured from, what stays, and what is in the way.
struct MeshParts {
  Surface front;                 ///< What is offset.
  std::optional<Surface> whole;  ///< All of the mesh, then the obstacles; empty if that is the front alone.
  std::optional<Surface> rest;   ///< What stays of the mesh; empty if nothing does.
  std::optional<Surface> obstacles;
  PolygonView obstacle_mesh;                ///< What those were built from.
  std::vector<std::uint32_t> front_vertex;  ///< These three as in Body.
  std::vector<std::uint8_t> off_front;
  std::vector<std::uint8_t> bound;
  std::vector<std::uint8_t> at_border;  ///< Of each vertex of the whole: 1 if both the front and the rest have it.

  const Surface& surface() const { return whole ? *whole : front; }
  ConstrainedSurface constrained(const ClosestQuery& query, const Obstacles* keep_away, bool off_source,
                                 std::size_t resting_faces = 0) const {
    return {query, surface(), front_vertex, off_front, bound, keep_away, off_source, resting_faces};
  }
  /// Where the vertices of surface() stand in the input, to the last bit.
  std::vector<Vec3d> source(PolygonView mesh) const;
};

/// \throw InvalidInput as build_surface(), and if `only` is not one a face or holds no face.
MeshParts build_mesh_parts(PolygonView mesh, const MeshPartsOptions& options);

/// Puts all of it into the front's frame (see place()), and tells which vertices of the front stay in planes, none of
/// which goes farther than `reach`.
/// \throw InvalidInput as hold_in_planes()
void place(MeshParts& workpiece, double voxel_size, const SymmetryOptions& symmetry, double reach);

/// The distances of the body's vertices: the mean of those of the input's vertices at one place, which go as one; 0 for
/// what stays. `disagreeing` grows by how many of them are asked for another than the first there. \pre placed
Distances distances_on_body(const MeshParts& parts, Border border, const Distances& of_input, std::size_t& disagreeing);

/// Hands the distances of a surface's vertices back to the input's.
Distances distances_of_input(const Surface& surface, const Distances& distances);

}  // namespace vdb_offset
