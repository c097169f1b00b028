// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "ground/numbers/index_set.h"

namespace vdb_offset {

/// Replaces the members of `set` that are in `some` by those of `some` that is_member(index) is true of. Both sorted.
template <class IsMember>
void replace_members(Indices& set, const Indices& some, IsMember&& is_member) {
  std::erase_if(set, [&](std::uint32_t i) { return std::binary_search(some.begin(), some.end(), i); });
  for (const auto i : some)
    if (is_member(i)) set.push_back(i);
  std::sort(set.begin(), set.end());
}

}  // namespace vdb_offset
