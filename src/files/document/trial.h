// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace vdb_offset::io {

/// Tries in a child process whether `work`, which reads a file by somebody else's library, comes to an end: a broken
/// file may take a reader to places where it has no business, and may not take this process along. Returns false if
/// `work` throws, which it will here as well. `most_memory` is how many more bytes the child may ask for; `path` begins
/// messages. \throw InvalidInput if a signal ended it, or it took too long, OutOfBudget if it asked for more memory
bool try_in_child(const std::string& path, std::size_t most_memory, const std::function<void()>& work);

}  // namespace vdb_offset::io
