// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include "vdb_offset/run.h"

/// What a caller sees of a call's progress: one share that never falls, from the stages' own shares and the seconds
/// that each stage is expected to take.
namespace vdb_offset {

/// Seconds of each stage; only how they compare with each other matters here.
using StageSeconds = std::array<double, kStageCount>;

/// Reports what stages report of themselves as shares of the whole call. Copies are one. From any thread.
class CallProgress {
 public:
  /// \param caller not empty
  explicit CallProgress(ProgressCallback caller);

  /// A stage's own share. Stages before it that have not been reported count as done.
  bool operator()(Stage stage, double share) const;
  /// Spreads what is left of the call over these stages: the share that is shown stays as it is, and grows from there.
  void expect(const StageSeconds& seconds) const;
  /// The stage at hand takes so many seconds more than was expected, and begins anew with what is left of it.
  void expect_more(double seconds) const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// A copy of a call's options whose stages report their own shares, as the caller's callback is to get those of the
/// whole call.
template <class Options>
Options with_call_progress(const Options& options) {
  Options own = options;
  if (own.progress) own.progress = CallProgress(options.progress);
  return own;
}

/// As CallProgress::expect() and expect_more(), of options made by with_call_progress(); nothing without a callback.
void expect_stages(const ProgressCallback& progress, const StageSeconds& seconds);
void expect_more(const ProgressCallback& progress, double seconds);

/// What a call within another one reports to: its own 0 to 1 are `from` to `to` of the other's. Empty if that is.
ProgressCallback part_of(const ProgressCallback& progress, double from, double to);

/// The same of one of several rounds, counted from 0. Nobody knows how many there will be: each is shown as the same
/// share of what is left.
ProgressCallback part_of_round(const ProgressCallback& progress, std::size_t round);

/// Reports a share. \throw Cancelled if the callback asks for it
void report_share(const ProgressCallback& progress, Stage stage, double share);

}  // namespace vdb_offset
