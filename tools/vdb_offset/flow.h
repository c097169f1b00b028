// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "job.h"
#include "vdb_offset/io/case_file.h"

namespace vdb_offset::tool {

/// The flow that is asked for, with what follows from the others: the length from the source's box, and the viscosity
/// from a Reynolds number or a density. \pre a viscosity or a Reynolds number is given
io::Flow flow_of(const Job& job);

}  // namespace vdb_offset::tool
