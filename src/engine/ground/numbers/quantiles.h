// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// A number as a key that grows with the number, and how many times the number counts.
struct Ranked {
  std::uint32_t key;
  std::uint64_t times;
};

/// The keys of the quantiles of a Spread, and the sum of terms, over `count` numbers: ranked(i) gives the key of number
/// i, and term(i) what it adds to the sum. If there are many numbers, the upper halves of keys are counted first, which
/// gives the upper half of each quantile; then the lower halves of the keys with these. The result does not depend on
/// the number of threads. Cost: O(count).
template <class Rank, class Term>
class Quantiles {
 public:
  /// The shares of a Spread, in its order.
  static constexpr std::array kShares = {0.0, 0.01, 0.05, 0.5, 0.95, 0.99, 1.0};
  std::array<std::uint32_t, kShares.size()> keys{};
  double sum = 0;

  /// \pre count > 0
  Quantiles(std::size_t count, Rank ranked, Term term) : count_(count), ranked_(ranked), term_(term) {
    VDB_OFFSET_ASSERT(count > 0);
    // Sorting so few numbers is faster than counting the halves of their keys, for which 2^16 counters are cleared and
    // added up. Not measured more closely.
    constexpr std::size_t kFew = 10000;
    if (count <= kFew) sort();
    else count_halves();
  }

 private:
  // kHalf: values of half a key. kBlock: numbers that one thread counts at a time, as many as there are counters to
  // clear; not measured beside other sizes.
  static constexpr std::size_t kHalf = std::size_t{1} << 16, kBlock = std::size_t{1} << 16;
  static constexpr std::uint8_t kNoSlot = 255;  // the slot of an upper half in which no quantile lies
  using Counts = std::vector<std::uint64_t>;

  void sort() {
    std::vector<Ranked> all(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      all[i] = ranked_(i);
      times_ += all[i].times;
      sum += term_(i);
    }
    std::sort(all.begin(), all.end(), [](const Ranked& a, const Ranked& b) { return a.key < b.key; });
    for (std::size_t i = 0; i < kShares.size(); ++i) {
      std::uint64_t at = rank(kShares[i]);
      auto found = all.begin();
      for (; at >= found->times; ++found) at -= found->times;
      VDB_OFFSET_ASSERT(found != all.end());
      keys[i] = found->key;
    }
  }

  void count_halves() {
    std::vector<double> sums(blocks(), 0);
    const Counts upper = counted(1, [&](std::size_t block, std::size_t i, const Ranked& number, Counts& counts) {
      sums[block] += term_(i);
      counts[number.key >> 16] += number.times;
    });
    sum = std::accumulate(sums.begin(), sums.end(), 0.0);
    times_ = std::accumulate(upper.begin(), upper.end(), std::uint64_t{0});
    slot_.assign(kHalf, kNoSlot);
    for (const double share : kShares) add_slot(upper, share);
    const Counts lower = counted(slots_, [&](std::size_t, std::size_t, const Ranked& number, Counts& counts) {
      const std::uint8_t slot = slot_[number.key >> 16];
      if (slot != kNoSlot) counts[slot * kHalf + (number.key & 0xffff)] += number.times;
    });
    for (std::size_t i = 0; i < kShares.size(); ++i) keys[i] = key_at(upper, lower, kShares[i]);
  }

  std::size_t blocks() const { return (count_ + kBlock - 1) / kBlock; }
  /// The sums of what look(block, i, number, counts) counts over all numbers, in `slots` times kHalf counters.
  template <class Look>
  Counts counted(std::size_t slots, Look&& look) {
    tbb::enumerable_thread_specific<Counts> parts([&] { return Counts(slots * kHalf, 0); });
    for_each_index(
        blocks(),
        [&](std::size_t b) {
          Counts& part = parts.local();
          for (std::size_t i = b * kBlock; i < std::min(count_, (b + 1) * kBlock); ++i) look(b, i, ranked_(i), part);
        },
        1);
    Counts all(slots * kHalf, 0);
    for (const Counts& part : parts)
      for (std::size_t i = 0; i < all.size(); ++i) all[i] += part[i];
    return all;
  }

  std::uint64_t rank(double share) const {
    return std::min(times_ - 1, static_cast<std::uint64_t>(share * static_cast<double>(times_)));
  }
  /// The half of a key in which number `rank` lies, in rising order. `rank` becomes the rank among the numbers with
  /// that half.
  static std::uint32_t half_at(std::span<const std::uint64_t> counts, std::uint64_t& rank) {
    std::uint32_t found = 0;
    for (; rank >= counts[found]; ++found) rank -= counts[found];
    return found;
  }
  void add_slot(const Counts& upper, double share) {
    std::uint64_t at = rank(share);
    std::uint8_t& slot = slot_[half_at(upper, at)];
    if (slot == kNoSlot) slot = static_cast<std::uint8_t>(slots_++);
  }
  std::uint32_t key_at(const Counts& upper, const Counts& lower, double share) const {
    std::uint64_t at = rank(share);
    const std::uint32_t high = half_at(upper, at);
    return high << 16 | half_at(std::span(lower).subspan(slot_[high] * kHalf, kHalf), at);
  }

  std::size_t count_;
  Rank ranked_;
  Term term_;
  std::uint64_t times_ = 0;         // how often all numbers together count
  std::vector<std::uint8_t> slot_;  // of each upper half: where its lower halves are counted, or kNoSlot
  std::size_t slots_ = 0;
};

struct Weighted {
  double value, weight;
};

/// Quantiles of numbers that count by their weights, at least 0; if all weights are 0, the numbers count alike. Values
/// are found to 2^-32 of the range that they take. Cost: O(values).
Spread spread_of(std::span<const Weighted> values);

/// Quantiles of `count` numbers value(i), none of which is NaN. Cost: O(values).
template <class Value>
Spread spread_of(std::size_t count, Value&& value) {
  if (count == 0) return {};
  const auto ranked = [&](std::size_t i) -> Ranked {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value(i)));
    return {bits >> 31 ? ~bits : bits | 0x80000000U, 1};
  };
  const Quantiles found(count, ranked, [&](std::size_t i) -> double { return value(i); });
  const auto number = [&](std::size_t i) -> double {
    return std::bit_cast<float>(found.keys[i] >> 31 ? found.keys[i] & 0x7fffffffU : ~found.keys[i]);
  };
  return {number(0), number(1), number(2), number(3),
          number(4), number(5), number(6), found.sum / static_cast<double>(count)};
}

}  // namespace vdb_offset
