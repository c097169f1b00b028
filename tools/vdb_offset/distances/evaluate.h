// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "job.h"
#include "vdb_offset/distances.h"

namespace vdb_offset::tool {

/// The distances of vertices that a request asks for, world units. \throw ReadError, InvalidInput
Distances evaluate(const Job& job, const DistanceRequest& request);

/// Multiplies all distances by a factor.
Distances scaled(const Distances& distances, double factor);

}  // namespace vdb_offset::tool
