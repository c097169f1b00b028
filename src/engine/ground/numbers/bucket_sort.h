// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "ground/system/assert.h"

namespace vdb_offset {

/// Sorts things into numbered buckets, from any number of threads: first each is counted, then each is given its index.
/// The order within a bucket depends on the threads; where it matters, each bucket is sorted afterwards.
class Buckets {
 public:
  explicit Buckets(std::size_t count) : begin_(count + 2, 0) {}

  void count(std::size_t bucket) {
    VDB_OFFSET_ASSERT(bucket + 2 < begin_.size());
    std::atomic_ref(begin_[bucket + 2]).fetch_add(1, std::memory_order_relaxed);
  }
  /// Ends the counting; returns how many things there are.
  std::uint32_t close() {
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    return begin_.back();
  }
  /// The index at which one thing of a bucket belongs. \pre close() was called, and no more things than were counted
  /// ask for one
  std::uint32_t next(std::size_t bucket) {
    const std::uint32_t index = std::atomic_ref(begin_[bucket + 1]).fetch_add(1, std::memory_order_relaxed);
    VDB_OFFSET_ASSERT(index < begin_.back());
    return index;
  }
  /// Where each bucket begins, once all things have been given their indices; one number more than buckets.
  std::vector<std::uint32_t> take() {
    begin_.pop_back();
    return std::move(begin_);
  }

 private:
  std::vector<std::uint32_t> begin_;
};

}  // namespace vdb_offset
