// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "motion/parts/border_slide.h"
#include "motion/parts/mesh_parts.h"
#include "motion/paths/miters.h"
#include "motion/paths/own_distances.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/options.h"

namespace vdb_offset {

/// The planes that the edge of a part slides in with its miters, of the moving part's vertices: those of the faces that
/// stay around a vertex, where these are flat and not in the plane of the part. Empty unless the edge slides.
std::vector<MiterWalls> walls_at_edge(const MeshParts& parts, Border border);

/// The ends of border vertices where the moved faces meet those that stay (see BorderSlides::meet()), as miters:
/// mitered, if they are farther from the part than their distance. Of the whole's vertices, sorted by vertex. Distances
/// are those of the moving part's; vertices whose faces have different ones of their own have none. The result does not
/// depend on the number of threads.
std::vector<Miter> edge_miters_of(const MeshParts& parts, const BorderSlides& slides, const ClosestQuery& moving_part,
                                  const Distances& distances, const OwnDistances* own);

/// Miters, and those at the edge of a part, of the whole's vertices, sorted by vertex. A vertex that has both keeps its
/// miter, unless that leaves the faces that stay: where these are no walls, which are of the moving part's vertices,
/// and no plane holds the vertex in them.
std::vector<Miter> with_edge_miters(const MeshParts& parts, const BorderSlides& slides, std::vector<Miter> miters,
                                    const std::vector<Miter>& at_edge, std::span<const MiterWalls> walls);

/// The miters of the moving part's vertices by their numbers among the vertices of parts.surface(). Sorted by vertex.
std::vector<Miter> miters_of_all(const MeshParts& parts, std::vector<Miter> of_part);

}  // namespace vdb_offset
