// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

#include "read/cad_model.h"

namespace vdb_offset::cad {

/// The faces of a body as shells, of a solid if it is one, and the numbers of the body's faces in the order in which
/// TopExp_Explorer meets them in it.
struct BodyShape {
  TopoDS_Shape shape;
  std::vector<std::size_t> face_numbers;
};
BodyShape shape_of(const Body& body);

}  // namespace vdb_offset::cad
