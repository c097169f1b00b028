// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "offset/offset_solid.h"

namespace vdb_offset::cad {

/// How OpenCASCADE closes gaps between the offsets of faces: by parts of cylinders and spheres, or by extending them.
enum class Join { Arcs, Intersection };

/// OpenCASCADE's own offset of a solid, for what offset_cad() fails at. It may be wrong without a word.
/// \throw Standard_Failure
OffsetCadResult opencascade_offset(const OffsetCadRequest& request, Join join);

}  // namespace vdb_offset::cad
