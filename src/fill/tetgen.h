// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "vdb_offset/fill.h"

namespace vdb_offset {

/// Fills a domain by the program tetgen (Si, TetGen, a Delaunay-based quality tetrahedral mesh generator, 2015).
/// \param folder for its files; whoever made it removes it
/// \param most_memory how many bytes of addresses it may ask for; 0: any
/// \throw FillFailed with how it ended, or what of its files is missing; FillerMissing if there is no such program
FilledDomain fill_by_tetgen(const FillDomain& domain, const std::string& folder, std::uint64_t most_memory);

}  // namespace vdb_offset
