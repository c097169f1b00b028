#pragma once

#include <cstddef>

namespace vdb_offset {

/// Bytes that this process may still take: what the system has free, or its control group leaves, if less.
std::size_t available_memory();

/// Most bytes that this process has held at once since it started (its resident set).
std::size_t peak_memory();

}  // namespace vdb_offset
