// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "products/offset/prepared_mesh.h"
#include "valid/faults/fault_finder.h"

namespace vdb_offset {

/// Gives vertices whose miters come with faults their paths to the distance again, until no fault comes of a miter; and
/// those of them their miters again that have room in the end. Near a fault that comes of no miter, those have none
/// either that would be at the distance without (with Corners::Round all of them): where one vertex goes straight and
/// its neighbour follows the field, less can be saved. \param surface the one that the paths are of \param distance the
/// farthest that vertices go, > 0 \pre `faults` knows the vertices at the ends of the marched paths
void take_faulty_miters_back(FaultFinder& faults, const Surface& surface, Corners corners, double distance,
                             PreparedMesh::Marched& marched);

}  // namespace vdb_offset
