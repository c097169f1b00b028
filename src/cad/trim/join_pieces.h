// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "trim/cut_faces.h"

namespace vdb_offset::cad {

/// Makes pieces of faces those of closed shells, if they can be: of pieces that lie over each other one stays, or none
/// if they look at each other; edges in one place become one; pieces with an edge that no other piece has go, and slits
/// that these leave in others. `near` is a length that counts as nothing.
void join_pieces(std::vector<FacePiece>& pieces, double near);

}  // namespace vdb_offset::cad
