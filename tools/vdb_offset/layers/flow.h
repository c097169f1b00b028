// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "job.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/io/case_file.h"

namespace vdb_offset::tool {

/// The flow that is asked for, with what follows from the others: the length from the source's box, and the viscosity
/// from a Reynolds number or a density. \pre a viscosity or a Reynolds number is given
io::Flow flow_of(const Job& job);

/// Calls patches as is asked for. \throw InvalidOption for patches that there are not
void rename_patches(const Request& request, VolumeMesh& mesh);

/// Looks whether patches can be called as is asked for and, for a case, whether it is known what each is: to know it
/// before a mesh is filled. \param mesh with all patches, but not necessarily with all of their faces
/// \throw InvalidOption
void require_patches(const Request& request, const VolumeMesh& mesh);

/// Writes the case that is asked for, if one is. What it leaves as it is there is warned of.
/// \param thickness of a mesh that is one cell thick; 0: it is another
void write_case(const Job& job, const VolumeMesh& mesh, double thickness);

}  // namespace vdb_offset::tool
