// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Where a vertex of a mesh with faces over ridges stands to be judged: a little on its way. At its place in the source
/// those faces have no area, and say nothing about what they cross. Distances from a mesh that stands there are those
/// from its source, to that share. Reasoned: a thousandth of what a vertex may be off, and a thousand times what
/// coordinates as large as a thousand distances are rounded by.
inline constexpr double kStandOff = 1e-9;
inline Vec3d stand_off(const Vec3d& source, const Vec3d& displacement) { return source + displacement * kStandOff; }

/// Heights of layers as seen from where a mesh stands that is off its source.
std::vector<Distances> less_stand_off(std::span<const Distances> heights);

/// The same of all vertices of a source; those that are welded together stand in one place.
std::vector<Vec3d> positions_off_source(PolygonView source, std::span<const Vec3d> positions, const WeldOptions& weld);

}  // namespace vdb_offset
