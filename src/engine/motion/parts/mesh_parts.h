// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "motion/parts/constrained_surface.h"
#include "space/surface/surface.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/options.h"

namespace vdb_offset {

struct MeshPartsOptions {
  std::span<const std::uint8_t> only;  ///< Of each face: 1 if it is on the moving part. Empty: all are.
  PolygonView obstacles;               ///< Without faces: none.
  WeldOptions weld;
  Orient orient = Orient::Keep;
};

/// A mesh, sorted into the part that moves, which distances are measured from, the faces that stay, and obstacles.
struct MeshParts {
  Surface moving_part;           ///< The moving part.
  std::optional<Surface> whole;  ///< All of the mesh, then the obstacles; empty if that is the moving part alone.
  std::optional<Surface> rest;   ///< The faces that stay; empty if none does.
  std::optional<Surface> obstacles;
  PolygonView obstacle_mesh;               ///< The mesh that the obstacles were built from.
  std::vector<std::uint32_t> part_vertex;  ///< These three as in ConstrainedSurface.
  std::vector<std::uint8_t> off_part;
  std::vector<std::uint8_t> bound;
  std::vector<std::uint8_t> at_border;  ///< Of each vertex of the whole: 1 if it is on the moving part and on the rest.

  const Surface& surface() const { return whole ? *whole : moving_part; }
  ConstrainedSurface constrained(const ClosestQuery& query, const Obstacles* keep_away, bool off_source,
                                 std::size_t resting_faces = 0) const {
    return {query, surface(), part_vertex, off_part, bound, keep_away, off_source, resting_faces};
  }
  /// The positions of the vertices of surface() in the input, to the last bit.
  std::vector<Vec3d> source(PolygonView mesh) const;
};

/// The vertices of the whole that the moving part's are.
std::vector<std::uint32_t> vertices_of_whole(const MeshParts& parts);

/// Sorts a mesh into its parts.
/// \throw InvalidInput as build_surface(), and if `only` has not one mark for each face or marks no face
MeshParts build_mesh_parts(PolygonView mesh, const MeshPartsOptions& options);

/// What becomes of the moving part's edges in planes that the faces which stay lead out of: they follow those faces, or
/// keep to the planes, as the sides of layers do.
enum class PartEdges : std::uint8_t { FollowFaces, KeepPlanes };

/// Puts all parts into the moving part's frame (see to_local_frame()), appends the obstacles to the whole, and finds
/// which vertices of the moving part stay in planes, none of which goes farther than `reach` (world units). To be
/// called once, before distances are made for surface(), and before any ConstrainedSurface. \throw InvalidInput as
/// hold_in_planes()
void to_local_frame(MeshParts& parts, double voxel_size, const SymmetryOptions& symmetry, double reach,
                    PartEdges edges = PartEdges::FollowFaces);

/// The distances of the vertices of surface(): the mean of those of the input's vertices at one position, which are
/// moved as one; 0 for vertices that stay. `disagreeing` grows by the number of vertices with another distance than the
/// first one at their position. \pre to_local_frame() has been called
Distances distances_on_parts(const MeshParts& parts, Border border, const Distances& of_input,
                             std::size_t& disagreeing);

/// The distances of the moving part's vertices, picked from those of all vertices.
Distances distances_of_part(const MeshParts& parts, const Distances& of_all);

/// The distances of the input's vertices, from those of a surface's; 0 for vertices that no face uses.
Distances distances_of_input(const Surface& surface, const Distances& distances);

}  // namespace vdb_offset
