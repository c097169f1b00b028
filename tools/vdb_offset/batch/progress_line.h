// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "outputs.h"

namespace vdb_offset::tool {

/// Tells how far a batch is and how long it will take, on standard error: on a terminal in one line that is redrawn,
/// elsewhere as a line each minute.
class ProgressLine {
 public:
  /// `work`: a measure of all that there is to do, as bytes of models; that of a model is reported when it has ended.
  /// `what`: what becomes of models.
  ProgressLine(bool wanted, std::size_t models, double work, const char* what);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void count(double work, bool failed);
  /// Draws the line, if it is time.
  void show();
  /// Makes room for what else is printed.
  void clear();

 private:
  std::string text() const;

  bool wanted_, on_terminal_;
  const char* what_;
  std::size_t models_, done_ = 0, failed_ = 0;
  double work_, work_done_ = 0;
  std::optional<double> expected_;  // seconds for all
  Clock::time_point begun_ = Clock::now(), shown_at_ = begun_;
  std::string shown_;
};

/// "1 model", "2 models".
std::string models_in_words(std::size_t count);

}  // namespace vdb_offset::tool
