// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "write/made_body.h"
#include "write/offset_bodies.h"

namespace vdb_offset::cad {

/// Whether triangles may take the place of faces that fail: what is valid is taken then even if it is doubtful.
enum class Exactness { Exact, Hybrid };

/// Writes an offset of a body, reads it again and judges it; as the thick solid between the body and the offset if that
/// is asked for. Nothing is made of one that is not good, and `gaps` says why.
MadeBody check_body(const OffsetBody& body, const OffsetCadResult& result, const Asked& asked, Exactness exactness);

/// The length of the unit of a file that was read again.
double in_millimetres(const CadModel& again, const Asked& asked);

}  // namespace vdb_offset::cad
