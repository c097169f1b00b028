// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "read/cad_model.h"

namespace vdb_offset::cad {

/// Makes solids that touch or get into each other one. What is left of a face keeps what is told of it; bodies come in
/// the order of their first faces in the file. \throw InvalidCad if OpenCASCADE makes no union of them
void fuse_bodies(CadModel& model);

}  // namespace vdb_offset::cad
