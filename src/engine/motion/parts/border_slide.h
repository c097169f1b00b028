// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "motion/parts/mesh_parts.h"
#include "motion/paths/propagate.h"
#include "vdb_offset/distances.h"

namespace vdb_offset {

/// Slides border vertices of a part along the faces that stay.
///
/// A vertex slides over the faces that stay around it, away from the part; where those turn away from the side that the
/// part goes to by more than 30 degrees, as the sides of a box do from its lid, along their extension instead. Where
/// they meet in one crease at the vertex, the vertex follows that, and where in more, it stays. On the faces it follows
/// the surface's bends (steps along the tangent and back to the closest point); along an extension it goes straight.
/// Vertices that planes hold (see border_planes.h) slide where the faces cut those; where the faces lie in such a plane
/// as well, vertices go in it as the part alone asks for.
class BorderSlides {
 public:
  /// Keeps references to both. \pre some faces of the mesh stay
  BorderSlides(const MeshParts& parts, const ClosestQuery& moving_part);

  /// The position at which a vertex of the whole mesh, on the border, is at this distance from the part, negative
  /// inward; or as near to that distance as it gets. In the moving part's frame.
  Vec3d operator()(std::uint32_t vertex, double distance) const;
  /// The position at which a vertex of the whole mesh, on the border, is at this distance from the faces of the part as
  /// if these went on beyond the border, in their planes: where the moved faces meet the faces that stay, or those
  /// faces' extension. Nothing if they meet farther than a slide may lead, or nowhere.
  std::optional<Vec3d> meet(std::uint32_t vertex, double distance) const;
  /// Whether a vertex on the border slides at all.
  bool lead(std::uint32_t vertex) const;

 private:
  const MeshParts& parts_;
  const ClosestQuery& moving_part_;
  ClosestQuery rest_;
};

/// The normals of the planes of the faces that stay around a vertex of the whole mesh, each plane once.
std::vector<Vec3d> planes_that_stay(const MeshParts& parts, std::uint32_t vertex);

/// Gives the border vertices new paths, to their distances, which they are bound to from then on. Distances and paths
/// are those of the moving part's vertices. The result does not depend on the number of threads. Replaces
/// `parts.bound`.
void slide_borders(MeshParts& parts, const BorderSlides& slides, const ClosestQuery& moving_part,
                   const Distances& distances, Paths& paths);

}  // namespace vdb_offset
