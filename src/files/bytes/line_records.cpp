// SPDX-License-Identifier: Apache-2.0
#include "bytes/line_records.h"

#include <algorithm>
#include <cstring>

namespace vdb_offset::io {
namespace {

// Bytes of a run of lines: enough to keep a thread busy, and few enough for its cache. Not measured beside other
// lengths. Fuzzers set shorter runs, so that small inputs have boundaries between runs.
#ifndef VDB_OFFSET_TEXT_RUN
#define VDB_OFFSET_TEXT_RUN (1 << 19)
#endif
constexpr std::size_t kRun = VDB_OFFSET_TEXT_RUN;

bool is_continued(std::string_view text, std::size_t line_end) {
  std::size_t at = line_end;
  if (at > 0 && text[at - 1] == '\r') --at;
  return at > 0 && text[at - 1] == '\\';
}

/// The byte behind the first line end from `at` on.
std::size_t next_line(std::string_view text, std::size_t at) {
  const std::size_t end = text.find('\n', at);
  return end == std::string_view::npos ? text.size() : end + 1;
}

}  // namespace

std::vector<std::size_t> cut_at_lines(std::string_view text, std::size_t begin) {
  std::vector<std::size_t> cuts{begin};
  while (cuts.back() < text.size()) {
    std::size_t cut = next_line(text, std::min(cuts.back() + kRun, text.size()));
    while (cut < text.size() && is_continued(text, cut - 1)) cut = next_line(text, cut);
    cuts.push_back(cut);
  }
  return cuts;
}

LineRecords::LineRecords(std::string_view text, std::size_t begin, std::size_t count)
    : text_(text), count_(count), cuts_(cut_at_lines(text, begin)), first_(cuts_.size(), 0) {
  const std::size_t runs = cuts_.size() - 1;
  tbb::parallel_for(std::size_t{0}, runs, [&](std::size_t run) {
    const auto line_end = [&](std::size_t at) { return text.begin() + static_cast<std::ptrdiff_t>(at); };
    first_[run + 1] = static_cast<std::size_t>(std::count(line_end(cuts_[run]), line_end(cuts_[run + 1]), '\n'));
  });
  std::size_t run = 0;
  for (; run < runs && first_[run] < count; ++run) first_[run + 1] += first_[run];
  if (run > 0 && first_[run] < count && text.back() != '\n')
    ++first_[run];  // the last line counts, too, if its line end is missing
  first_.resize(run + 1);
  cuts_.resize(run + 1);
  // The last run ends with the last record, whose line end may be missing.
  if (run > 0 && first_[run] >= count) {
    std::size_t at = cuts_[run - 1];
    for (std::size_t i = first_[run - 1]; i < count; ++i) at = next_line(text, at);
    cuts_[run] = at;
    first_[run] = count;
  }
}

}  // namespace vdb_offset::io
