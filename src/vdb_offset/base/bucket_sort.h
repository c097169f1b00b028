#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace vdb_offset {

/// Sorts things into numbered buckets, from any number of threads: first each is counted, then each is given its place.
/// Which of a bucket's places it is given depends on the threads; whoever needs an order sorts each bucket.
class Buckets {
 public:
  explicit Buckets(std::size_t count) : begin_(count + 2, 0) {}

  void count(std::size_t bucket) { std::atomic_ref(begin_[bucket + 2]).fetch_add(1, std::memory_order_relaxed); }
  /// After all have been counted; returns how many.
  std::uint32_t close() {
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    return begin_.back();
  }
  std::uint32_t next(std::size_t bucket) {
    return std::atomic_ref(begin_[bucket + 1]).fetch_add(1, std::memory_order_relaxed);
  }
  /// Where each bucket begins, once all have been given their places; one more than buckets.
  std::vector<std::uint32_t> take() {
    begin_.pop_back();
    return std::move(begin_);
  }

 private:
  std::vector<std::uint32_t> begin_;
};

}  // namespace vdb_offset
