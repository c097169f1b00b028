// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "read/cad_model.h"

namespace vdb_offset::cad {

/// Triangles of a model, as OpenCASCADE makes them, joined along the model's edges: no edge of them is in the middle of
/// another's, and a solid's are closed. What is open is sewn, in `model` as well; what had to be done is reported.
io::CadMesh tessellate(CadModel& model, const io::CadFineness& fineness);

}  // namespace vdb_offset::cad
