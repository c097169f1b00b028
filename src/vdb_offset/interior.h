#pragma once

#include <cstddef>
#include <span>

#include "vdb_offset/closest.h"

namespace vdb_offset {

/// How far a flat face is off between its vertices, which alone are put at the distance: |distance - target| / target
/// at the centres of triangles and the middles of their edges.
struct InteriorError {
  std::size_t samples = 0;
  double mean = 0, quantile_99 = 0, worst = 0;
};

/// `places` of the surface's vertices in world coordinates; `target` > 0. Looks at no more than `most` triangles,
/// evenly taken from all; 0 is all. The result does not depend on the number of threads.
InteriorError measure_interior(const ClosestQuery& query, std::span<const Vec3d> places, double target,
                               std::size_t most = 0);

}  // namespace vdb_offset
