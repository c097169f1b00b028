// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "offset/place.h"

namespace vdb_offset::cad {

/// Places a vertex; one of four or more faces whose offsets do not meet in one point is split into vertices of three
/// with short edges in between, such that no face's border crosses itself there. False if no way was found: the vertex
/// is then placed as well as can be.
bool resolve_vertex(Model& model, int vertex, const Tolerances& tolerances);

}  // namespace vdb_offset::cad
