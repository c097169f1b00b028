// SPDX-License-Identifier: Apache-2.0
#include "summary/remarks.h"

#include <fmt/format.h>

#include <algorithm>

#include "messages.h"

namespace vdb_offset::tool {

void Remarks::print(std::FILE* out, bool all) const {
  constexpr std::size_t kMost = 3;  // more are not read
  std::vector<Remark> sorted = all_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Remark& a, const Remark& b) { return a.gravity < b.gravity; });
  std::size_t left = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const bool is_detail = sorted[i].gravity == Gravity::Detail;
    if (all || (i < kMost && !is_detail)) fmt::print(out, "{}{}\n", is_detail ? "note: " : "warning: ", sorted[i].text);
    else if (!is_detail) ++left;
  }
  if (left > 0) fmt::print(out, "{} more warning{} with --verbose\n", left, plural(left));
}

}  // namespace vdb_offset::tool
