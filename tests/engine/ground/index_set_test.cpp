// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <catch2/catch.hpp>
#include <random>
#include <set>

#include "ground/numbers/bucket_sort.h"
#include "ground/numbers/index_set.h"

using namespace vdb_offset;

TEST_CASE("index set: sorted, no two the same, whatever comes", "[index_set]") {
  Indices some{5, 1, 5, 0, 9, 1};
  sort_unique(some);
  CHECK(some == Indices{0, 1, 5, 9});
  Indices none;
  sort_unique(none);
  CHECK(none.empty());
}

TEST_CASE("index set: what is not one is told", "[index_set]") {
  CHECK(is_sorted_unique({}));
  CHECK(is_sorted_unique(Indices{7}));
  CHECK(is_sorted_unique(Indices{1, 2, 9}));
  CHECK_FALSE(is_sorted_unique(Indices{1, 1}));
  CHECK_FALSE(is_sorted_unique(Indices{1, 3, 2}));
}

TEST_CASE("index set: gathering is a set, and begins anew", "[index_set]") {
  std::mt19937 random(7);
  IndexGatherer gatherer(100);
  for (int round = 0; round < 3; ++round) {
    std::set<std::uint32_t> expected;
    for (int i = 0; i < 200; ++i) {
      const auto index = static_cast<std::uint32_t>(random() % 100);
      gatherer.add(index);
      expected.insert(index);
      CHECK(gatherer.so_far().size() == expected.size());
    }
    CHECK(gatherer.take() == Indices(expected.begin(), expected.end()));
    CHECK(gatherer.so_far().empty());
  }
}

TEST_CASE("bucket sort: each thing is in its bucket once", "[index_set]") {
  constexpr std::size_t kBuckets = 13, kThings = 10000;
  const auto bucket_of = [](std::size_t thing) { return thing * thing % kBuckets; };
  Buckets buckets(kBuckets);
  tbb::parallel_for(std::size_t{0}, kThings, [&](std::size_t thing) { buckets.count(bucket_of(thing)); });
  REQUIRE(buckets.close() == kThings);
  std::vector<std::size_t> sorted(kThings);
  tbb::parallel_for(std::size_t{0}, kThings,
                    [&](std::size_t thing) { sorted[buckets.next(bucket_of(thing))] = thing; });
  const std::vector<std::uint32_t> begin = buckets.take();
  REQUIRE(begin.size() == kBuckets + 1);
  CHECK(begin.front() == 0);
  CHECK(begin.back() == kThings);
  std::set<std::size_t> seen;
  for (std::size_t b = 0; b < kBuckets; ++b)
    for (std::uint32_t i = begin[b]; i < begin[b + 1]; ++i) {
      CHECK(bucket_of(sorted[i]) == b);
      seen.insert(sorted[i]);
    }
  CHECK(seen.size() == kThings);
}
