// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "messages/cad_messages.h"
#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {

/// Makes the offset of a model as a file of a CAD model, body by body: of all attempts() the first that is good is
/// taken, by what is found in its file when that is read again. Each is made in a process of its own, as OpenCASCADE
/// may not survive a result that is not good. \param meshes what the bodies were tessellated to
/// \throw InvalidCad if OpenCASCADE cannot write it
io::CadWritten write_offset(const CadModel& model, const std::vector<BodyMesh>& meshes, const io::WriteCad& write);

}  // namespace vdb_offset::cad
