// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "ground/system/memory.h"
#include "valid/faults/triangle_crossings.h"

namespace vdb_offset {

// The word for a list of crossings in the message that refuses it for want of memory.
inline constexpr const char* kCrossings = "crossings";
// Bytes of a list that memory is not asked for. Reasoned: to ask takes longer than to find so few pairs.
inline constexpr std::size_t kSmallList = std::size_t{1} << 20;

/// Calls find(i, found) for 0 .. count - 1 in parallel, and sorts the pairs that it adds to `found`, each once.
template <class Find>
std::vector<TrianglePair> find_in_parallel(std::size_t count, std::size_t grain, Find&& find) {
  tbb::enumerable_thread_specific<std::vector<TrianglePair>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
    auto& mine = found.local();
    for (std::size_t i = range.begin(); i != range.end(); ++i) find(i, mine);
  });
  std::vector<TrianglePair> all;
  std::size_t pairs = 0;
  for (const auto& some : found) pairs += some.size();
  if (pairs * sizeof(TrianglePair) > kSmallList) require_memory(pairs * sizeof(TrianglePair), kCrossings);
  all.reserve(pairs);
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  tbb::parallel_sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace vdb_offset
