// SPDX-License-Identifier: Apache-2.0
#include "batch/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "terminal.h"

namespace vdb_offset::tool {
namespace {

constexpr double kSecondsBetweenLines = 60;  // in a file or a pipe

}  // namespace

std::string models_in_words(std::size_t count) { return fmt::format("{} model{}", count, count == 1 ? "" : "s"); }

ProgressLine::ProgressLine(bool wanted, std::size_t models, double work, const char* what)
    : wanted_(wanted && models > 0),
      on_terminal_(::isatty(STDERR_FILENO) == 1),
      what_(what),
      models_(models),
      work_(work) {}

void ProgressLine::count(double work, bool failed) {
  ++done_;
  failed_ += failed ? 1 : 0;
  work_done_ += work;
  // The work of a model is about in proportion to its size.
  const double seconds = seconds_since(begun_);
  if (work_done_ > 0) expected_ = seconds + seconds * (work_ - work_done_) / work_done_;
}

std::string ProgressLine::text() const {
  std::string line = fmt::format("{} of {} {}", done_, models_in_words(models_), what_);
  if (failed_ > 0) line += fmt::format(", {} failed", failed_);
  if (expected_ && done_ < models_)
    line += fmt::format(", {} left", time_in_words(std::max(0.0, *expected_ - seconds_since(begun_))));
  return line;
}

void ProgressLine::show() {
  if (!wanted_) return;
  if (on_terminal_) {
    const std::string line = text();
    if (line == shown_) return;
    std::fputs(fmt::format("\r{:{}}", line, shown_.size()).c_str(), stderr);
    shown_ = line;
  } else if (seconds_since(shown_at_) >= kSecondsBetweenLines) {
    shown_at_ = Clock::now();
    std::fputs((text() + "\n").c_str(), stderr);
  }
}

void ProgressLine::clear() {
  if (!shown_.empty()) std::fputs(fmt::format("\r{:{}}\r", "", shown_.size()).c_str(), stderr);
  shown_.clear();
}

}  // namespace vdb_offset::tool
