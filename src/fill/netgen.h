// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/fill.h"

namespace vdb_offset {

/// Fills a domain by Netgen. Its sizes follow from the lengths of the domain's edges, and grow from there.
/// \throw FillFailed with Netgen's words; where the domain's border is none, Netgen may also end the process
FilledDomain fill_by_netgen(const FillDomain& domain);

}  // namespace vdb_offset
