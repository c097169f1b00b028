// SPDX-License-Identifier: Apache-2.0
#include "ground/numbers/quantiles.h"

#include <cmath>

namespace vdb_offset {

Spread spread_of(std::span<const Weighted> values) {
  if (values.empty()) return {};
  double whole = 0, least = values[0].value, most = least;
  for (const Weighted& v : values) {
    whole += v.weight;
    least = std::min(least, v.value);
    most = std::max(most, v.value);
  }
  constexpr double kKeys = 0xffffffffU;  // the key of the largest value; keys have 32 bits
  constexpr double kTimes = 0x1p52;      // sum of all weights as integers: added in any order, they give the same sum
  const bool weighs = whole > 0;
  const double keys = most > least ? kKeys / (most - least) : 0, times = weighs ? kTimes / whole : 0;
  const Quantiles found(
      values.size(),
      [&](std::size_t i) -> Ranked {
        return {static_cast<std::uint32_t>(std::min(kKeys, (values[i].value - least) * keys)),
                1 + static_cast<std::uint64_t>(values[i].weight * times)};
      },
      [&](std::size_t i) { return values[i].value * (weighs ? values[i].weight : 1); });
  const auto number = [&](std::size_t i) { return std::lerp(least, most, found.keys[i] / kKeys); };
  return {least,     number(1), number(2), number(3),
          number(4), number(5), most,      found.sum / (weighs ? whole : static_cast<double>(values.size()))};
}

}  // namespace vdb_offset
