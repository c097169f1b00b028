// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vdb_offset {

/// How many threads to use if `asked` are asked for; 0: as many as the machine has. \throw InvalidInput below 0
int thread_count(int asked);

}  // namespace vdb_offset
