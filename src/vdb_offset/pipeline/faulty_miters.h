// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/pipeline/prepared_mesh.h"
#include "vdb_offset/validity/fault_finder.h"

namespace vdb_offset {

/// Gives vertices whose miters come with faults their paths to the distance again, until no fault comes of a miter; and
/// those of them their miters again that have room in the end.
/// \param surface the one that the paths are of
/// \pre `faults` knows the vertices at the ends of the marched paths
void take_faulty_miters_back(FaultFinder& faults, const Surface& surface, PreparedMesh::Marched& marched);

}  // namespace vdb_offset
