// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/fill.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The surface of a farfield around a box, as triangles, ccw seen from outside. Its edges are about a third of its
/// radius long: cells there are as large as they may be.
/// \throw InvalidInput unless the farfield encloses the box, with some room
Polygons make_farfield(const Farfield& farfield, const Vec3d& lowest, const Vec3d& highest);

}  // namespace vdb_offset
