// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {

struct Tessellation {
  io::CadMesh mesh;
  std::vector<BodyMesh> bodies;  ///< What it is of, by body.
};

/// Triangles of a model, as OpenCASCADE makes them, joined along the model's edges: no edge of them is in the middle of
/// another's, and a solid's are closed. What is open is sewn, in `model` as well; what had to be done is reported.
Tessellation tessellate(CadModel& model, const io::CadFineness& fineness);

}  // namespace vdb_offset::cad
