// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "messages/cad_messages.h"
#include "read/cad_model.h"

namespace vdb_offset::cad {

/// Makes the offset of a model as a file of a CAD model: each body by offset_cad(). The file is read again, and what is
/// found in it is judged; solids that are not good are left out as such, and their faces or triangles written. In
/// processes of their own, as OpenCASCADE may not survive a result that is not good: at most five.
/// \throw InvalidCad if OpenCASCADE cannot write it
io::CadWritten write_offset(const CadModel& model, const io::WriteCad& write);

}  // namespace vdb_offset::cad
