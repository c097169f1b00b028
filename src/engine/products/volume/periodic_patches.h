// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "vdb_offset/cells.h"

namespace vdb_offset {

/// The two patches of kind Periodic. \pre the mesh has a motion, and these
std::pair<BoundaryPatch*, BoundaryPatch*> periodic_patches(VolumeMesh& mesh);

/// How far the images of points of a mesh may be from others: layers have copies of each other, the wall what files
/// keep.
double periodic_tolerance(const VolumeMesh& mesh);

/// Puts the faces of the second periodic patch into the order of those that the motion takes to them (see
/// VolumeMesh::motion); nothing for a mesh without a motion.
/// \throw InvalidInput where it takes some to none: faces beside layers that end differently
void match_periodic_patches(VolumeMesh& mesh);

}  // namespace vdb_offset
