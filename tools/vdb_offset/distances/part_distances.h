// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "job.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/io/cad_file.h"

namespace vdb_offset::tool {

/// Whether vertices get their distances from faces: parts have their own, or faces of a CAD model by their u and v.
bool are_of_parts(const Job& job, const DistanceRequest& asked);

/// The distances of vertices, of which some parts may have their own. \pre are_of_parts() \throw ReadError,
/// InvalidInput
Distances distances_of_parts(const Job& job, const DistanceRequest& asked);

/// The distances of the faces of a CAD model. \param of_vertices what is asked of these
/// \throw InvalidInput if one of them is of vertices, or none is other than 0
io::CadDistances cad_distances(const Job& job, const DistanceRequest& asked, const Distances& of_vertices);

}  // namespace vdb_offset::tool
