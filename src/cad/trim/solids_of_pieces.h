// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

#include "trim/cut_faces.h"

namespace vdb_offset::cad {

/// The solids that pieces of faces enclose, each with its cavities: one, or a compound of some. Null if the pieces do
/// not hang together by edges that two of them have in opposite ways, or a cavity lies in no solid.
TopoDS_Shape solids_of_pieces(const std::vector<FacePiece>& pieces);

/// What pieces each face is left with, by number: null, a face, or a compound of some.
std::vector<TopoDS_Shape> faces_left(const std::vector<FacePiece>& pieces, std::size_t faces);

}  // namespace vdb_offset::cad
