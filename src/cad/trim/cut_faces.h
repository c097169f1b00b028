// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

namespace vdb_offset::cad {

/// What is left of a face that is cut.
struct FacePiece {
  TopoDS_Face face;  ///< Oriented as the face that it is of.
  int of = 0;        ///< The number of that face, as TopExp_Explorer meets them.
};

/// Cuts faces along all curves in which they meet, also where borders of one face cross; pieces share edges where the
/// faces did, and along the cuts. Of a face whose borders cross only what lies inside of them. \throw Standard_Failure
std::vector<FacePiece> cut_faces(const TopoDS_Shape& shape);

}  // namespace vdb_offset::cad
