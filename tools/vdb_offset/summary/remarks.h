// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "vdb_offset/report.h"

namespace vdb_offset::tool {

/// How much a remark matters to somebody who is about to use the result.
enum class Gravity : std::uint8_t {
  Wrong,   ///< The result may not be what was meant: the wrong side, a missing base, coordinates too coarse.
  Off,     ///< It is what was meant, and off in places.
  Input,   ///< The input has a fault that was left as it is.
  Detail,  ///< All is well, or was put right; printed with --verbose alone.
};

/// What a run says of its result besides the verdict.
class Remarks {
 public:
  void add(Gravity gravity, std::string text) { all_.push_back({gravity, std::move(text)}); }
  /// Prints the three gravest, each on a line, and how many more there are; or all of them.
  void print(std::FILE* out, bool all) const;
  /// All of them, as a report has them.
  RunSummary with_verdict(std::string verdict) const;

 private:
  struct Remark {
    Gravity gravity;
    std::string text;
  };
  std::vector<Remark> sorted() const;
  std::vector<Remark> all_;
};

/// What a run says of one result.
struct Summary {
  std::string verdict;  ///< One line, without its end.
  Remarks remarks;

  RunSummary for_report() const { return remarks.with_verdict(verdict); }
  /// Prints the verdict with the time that it took, and remarks as these do.
  void print(std::FILE* out, double seconds, bool all) const;
};

}  // namespace vdb_offset::tool
