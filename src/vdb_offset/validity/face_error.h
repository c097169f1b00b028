#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/parts/constrained_surface.h"
#include "vdb_offset/statistics.h"

namespace vdb_offset {

/// `places` of the body's vertices in world coordinates; between them, their distances' mean is asked for. Looks at no
/// more than `most` triangles, evenly taken from all; 0 is all. Samples that are asked to stay on the front, and
/// triangles off it, are left out. The result does not depend on the number of threads.
FaceInteriorError measure_interior(const ConstrainedSurface& constrained, std::span<const Vec3d> places,
                                   const Distances& distances, std::size_t most = 0);

/// Sums up errors of single places, relative to what was asked there.
FaceInteriorError sum_up_errors(std::vector<double> errors);

}  // namespace vdb_offset
