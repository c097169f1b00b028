// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace vdb_offset::tool {

/// Whether a list of machines is one that GNU parallel may have: `:` (this machine) or `[N/][user@]host[:port]`, with
/// commas between. Parallel takes all else for words of a shell, which it would carry out.
bool are_hosts(std::string_view list);

/// Whether a text is a name of a partition of Slurm, or several with commas between.
bool are_partitions(std::string_view list);

}  // namespace vdb_offset::tool
