// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "ground/numbers/quantiles.h"

using namespace vdb_offset;

namespace {

/// Quantiles by sorting, of numbers that are floats.
Spread by_sorting(std::vector<float> numbers) {
  double sum = 0;
  for (const float number : numbers) sum += static_cast<double>(number);
  std::sort(numbers.begin(), numbers.end());
  const auto at = [&](double share) -> double {
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(numbers.size()));
    return numbers[std::min(rank, numbers.size() - 1)];
  };
  return {at(0), at(0.01), at(0.05), at(0.5), at(0.95), at(0.99), at(1), sum / static_cast<double>(numbers.size())};
}

void check_same(const Spread& found, const Spread& expected) {
  CHECK(found.least == expected.least);
  CHECK(found.quantile_01 == expected.quantile_01);
  CHECK(found.quantile_05 == expected.quantile_05);
  CHECK(found.median == expected.median);
  CHECK(found.quantile_95 == expected.quantile_95);
  CHECK(found.quantile_99 == expected.quantile_99);
  CHECK(found.most == expected.most);
  // Summed up in blocks: so many roundings at most, of sums no larger than all numbers together.
  CHECK(found.mean == Approx(expected.mean).epsilon(1e-12).margin(1e-12));
}

}  // namespace

TEST_CASE("quantiles: those of sorted numbers, few and many, of either sign", "[quantiles]") {
  std::mt19937 random(3);
  std::normal_distribution<float> normal(0.5F, 2);
  // Up to 10,000 are sorted, more are counted by halves of their keys; 65,536 is a block.
  for (const std::size_t count : {1U, 2U, 99U, 100U, 10000U, 10001U, 65536U, 200003U}) {
    std::vector<float> numbers(count);
    for (float& number : numbers) number = normal(random);
    check_same(spread_of(count, [&](std::size_t i) { return static_cast<double>(numbers[i]); }), by_sorting(numbers));
  }
}

TEST_CASE("quantiles: equal numbers, zeros of both signs and infinities", "[quantiles]") {
  const auto spread = [](const std::vector<double>& numbers) {
    return spread_of(numbers.size(), [&](std::size_t i) { return numbers[i]; });
  };
  const Spread same = spread(std::vector<double>(20000, -3.5));
  CHECK(same.least == -3.5);
  CHECK(same.median == -3.5);
  CHECK(same.most == -3.5);
  CHECK(same.mean == -3.5);
  const Spread wide = spread({0.0, -INFINITY, INFINITY, -0.0});
  CHECK(wide.least == -INFINITY);
  CHECK(wide.most == INFINITY);
  CHECK(wide.median == 0);
  CHECK(spread({}).mean == 0);
}

TEST_CASE("quantiles: a weight counts as so many equal numbers", "[quantiles]") {
  const std::vector<Weighted> weighted = {{5, 0}, {1, 1}, {9, 1}, {2, 6}};
  const Spread found = spread_of(weighted);
  CHECK(found.least == 1);
  CHECK(found.most == 9);
  CHECK(found.median == Approx(2).margin(8.0 / 4294967296.0));  // to 2^-32 of the range
  CHECK(found.mean == 22.0 / 8);
  // Without any weight they count alike.
  const std::vector<Weighted> alike = {{5, 0}, {1, 0}, {9, 0}};
  CHECK(spread_of(alike).mean == 5);
  CHECK(spread_of(alike).median == Approx(5).margin(8.0 / 4294967296.0));
}
