// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace vdb_offset {

/// Calls work(0 .. count - 1) in parallel, in runs long enough for work of a few nanoseconds or of no less than
/// `grain`.
template <class Work>
void for_each_index(std::size_t count, Work&& work, std::size_t grain = 1024) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) work(i);
  });
}

/// Makes `lowest` the lesser of itself and `value`, so that of what several threads find the first is kept.
inline void lower_to(std::atomic<std::uint64_t>& lowest, std::uint64_t value) {
  for (std::uint64_t known = lowest; value < known && !lowest.compare_exchange_weak(known, value);) {
  }
}

}  // namespace vdb_offset
