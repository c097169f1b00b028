// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "messages/cad_messages.h"
#include "offset/offset_surface.h"
#include "read/body_shape.h"
#include "read/cad_model.h"

namespace vdb_offset::cad {

/// The distances of the faces of a body's shape, which is in millimetres, towards the outside: in the order of the
/// shape, in millimetres. \param first_face the number of the body's first face in the model \param millimetres how
/// many the model's unit is \throw InvalidExpression, or what is returned InvalidInput where an expression has no
/// finite value
std::vector<FaceDistance> distances_of(const io::WriteCad& write, std::size_t first_face, const BodyShape& shape,
                                       double millimetres);

}  // namespace vdb_offset::cad
