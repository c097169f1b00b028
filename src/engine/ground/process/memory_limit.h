// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace vdb_offset {

/// Lets this process have so many more bytes of addresses; 0: any number. Under the address sanitizer, which has
/// terabytes of them, as many as it likes.
void limit_memory(std::uint64_t more);

/// Whether the limit has been come near to: OpenCASCADE goes on where it was refused memory, and leaves faces out.
bool is_memory_short();

/// Whether most of what limit_memory() allowed was taken: a reader that was refused memory may say that the file is
/// broken.
bool is_memory_used_up(std::uint64_t more);

}  // namespace vdb_offset
