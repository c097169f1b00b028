// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/parts/constrained_surface.h"
#include "vdb_offset/statistics.h"

namespace vdb_offset {

/// Measures how far faces are off their distance between their vertices: at a triangle's centre and at the middles of
/// its edges, where the mean of the corners' distances is asked for. Samples of distance 0, and triangles that are not
/// on the moving part, are left out. The result does not depend on the number of threads. \param positions of the
/// constrained surface's vertices, world coordinates \param most triangles that are measured, evenly taken from all; 0:
/// all are
FaceInteriorError measure_interior(const ConstrainedSurface& constrained, std::span<const Vec3d> positions,
                                   const Distances& distances, std::size_t most = 0);

/// Mean, 99 % quantile and maximum of the errors of samples, each relative to the distance that was asked there.
FaceInteriorError sum_up_errors(std::vector<double> errors);

}  // namespace vdb_offset
