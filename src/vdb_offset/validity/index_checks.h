#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "vdb_offset/base/index_set.h"

namespace vdb_offset {

/// Whether these are indices below `count`, sorted, each once: for assertions.
inline bool is_index_set(const Indices& indices, std::size_t count) {
  return std::is_sorted(indices.begin(), indices.end(), std::less_equal<>()) &&
         (indices.empty() || indices.back() < count);
}

}  // namespace vdb_offset
