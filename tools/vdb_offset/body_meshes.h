// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "job.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/offset.h"

namespace vdb_offset::tool {

/// The offset mesh for a CAD model out, whose bodies are offset one by one: where bodies of the source hold each other
/// back, each is offset once more by itself.
std::vector<Vec3d> offset_bodies(const Job& job, const Distances& distances, const OffsetResult& whole);

}  // namespace vdb_offset::tool
