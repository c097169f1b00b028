// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace vdb_offset {

/// Spreads a key's bits for a hash table; one to one.
inline std::uint64_t mix(std::uint64_t x) {
  x ^= x >> 32;
  x *= 0xd6e8feb86659fd93ULL;
  x ^= x >> 32;
  return x;
}

}  // namespace vdb_offset
