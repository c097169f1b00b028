// SPDX-License-Identifier: Apache-2.0
#include "summary/remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "messages.h"

namespace vdb_offset::tool {

std::vector<Remarks::Remark> Remarks::sorted() const {
  std::vector<Remark> sorted = all_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Remark& a, const Remark& b) { return a.gravity < b.gravity; });
  return sorted;
}

RunSummary Remarks::with_verdict(std::string verdict) const {
  constexpr const char* kKinds[] = {"wrong", "off", "input"};
  RunSummary summary;
  summary.verdict = std::move(verdict);
  for (const Remark& remark : sorted()) {
    if (remark.gravity == Gravity::Detail) summary.notes.push_back(remark.text);
    else summary.warnings.push_back({kKinds[static_cast<std::size_t>(remark.gravity)], remark.text});
  }
  return summary;
}

void Remarks::print(std::FILE* out, bool all) const {
  constexpr std::size_t kMost = 3;  // more are not read
  const std::vector<Remark> remarks = sorted();
  std::size_t left = 0;
  for (std::size_t i = 0; i < remarks.size(); ++i) {
    const bool is_detail = remarks[i].gravity == Gravity::Detail;
    if (all || (i < kMost && !is_detail))
      fmt::print(out, "{}{}\n", is_detail ? "note: " : "warning: ", remarks[i].text);
    else if (!is_detail) ++left;
  }
  if (left > 0) fmt::print(out, "{} more warning{} with --verbose\n", left, plural(left));
}

void Summary::print(std::FILE* out, double seconds, bool all) const {
  fmt::print(out, "{} ({:.2f} s)\n", verdict, seconds);
  remarks.print(out, all);
}

}  // namespace vdb_offset::tool
