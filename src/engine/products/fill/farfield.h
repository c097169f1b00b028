// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "products/fill/openings.h"
#include "vdb_offset/fill.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The surface of a farfield around points, as triangles, ccw seen from outside; open where it ends at planes. Its
/// edges are about a third of its radius long: cells there are as large as they may be. \param planes that the points
/// end at, and the farfield with them; their normals lead out \throw InvalidInput unless the farfield encloses the
/// points, with some room, and for planes that are not parallel
Polygons make_farfield(const Farfield& farfield, std::span<const Vec3d> points, std::span<const OpenPlane> planes);

}  // namespace vdb_offset
