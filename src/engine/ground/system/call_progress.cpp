// SPDX-License-Identifier: Apache-2.0
#include "ground/system/call_progress.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

namespace vdb_offset {

struct CallProgress::State {
  ProgressCallback caller;
  std::mutex mutex;
  StageSeconds left{};         // of each stage: seconds that have not been counted as done
  Stage stage = Stage::Read;   // the one at hand
  double begun_at = 0;         // its own share, when `base` was shown
  double own_share = 0;        // its own share, as it was reported last
  double base = 0, shown = 0;  // of the whole call

  double& of_stage() { return left[static_cast<std::size_t>(stage)]; }
  double all_left() const { return std::accumulate(left.begin(), left.end(), 0.0); }

  /// The part of the stage at hand, from begun_at on, that is done.
  double done_of_stage() const { return begun_at < 1 ? (own_share - begun_at) / (1 - begun_at) : 1; }

  /// Counts what has been shown as done, so that what follows is spread over the rest.
  void settle() {
    of_stage() -= of_stage() * done_of_stage();
    begun_at = own_share;
    base = shown;
  }

  void begin(Stage next) {
    own_share = 1;
    show();
    settle();
    std::fill_n(left.begin(), static_cast<std::size_t>(next), 0.0);
    stage = next;
    begun_at = own_share = 0;
  }

  void show() {
    const double all = all_left();
    if (!(all > 0)) return;
    const double done = of_stage() * done_of_stage() / all;
    shown = done < 1 ? std::clamp(base + (1 - base) * done, shown, 1.0) : 1;
  }
};

CallProgress::CallProgress(ProgressCallback caller) : state_(std::make_shared<State>()) {
  state_->caller = std::move(caller);
  // Until more is known, all of a call is its last stage.
  state_->left[static_cast<std::size_t>(Stage::Measure)] = 1;
}

bool CallProgress::operator()(Stage stage, double share) const {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  if (stage != state.stage) state.begin(stage);
  state.own_share = std::clamp(share, state.own_share, 1.0);
  state.show();
  return state.caller(stage, state.shown);
}

void CallProgress::expect(const StageSeconds& seconds) const {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  state.left = seconds;
  state.begun_at = state.own_share;
  state.base = state.shown;
}

void CallProgress::expect_more(double seconds) const {
  State& state = *state_;
  const std::lock_guard lock(state.mutex);
  state.settle();
  state.of_stage() += seconds;
  state.begun_at = state.own_share = 0;
}

void expect_stages(const ProgressCallback& progress, const StageSeconds& seconds) {
  if (const auto* const call = progress.target<CallProgress>()) call->expect(seconds);
}

void expect_more(const ProgressCallback& progress, double seconds) {
  if (const auto* const call = progress.target<CallProgress>()) call->expect_more(seconds);
}

ProgressCallback part_of(const ProgressCallback& progress, double from, double to) {
  if (!progress) return {};
  return [progress, from, to](Stage stage, double share) { return progress(stage, from + (to - from) * share); };
}

ProgressCallback part_of_round(const ProgressCallback& progress, std::size_t round) {
  constexpr double kLeft = 0.6;  // of what was left before a round; not measured
  const double left = std::pow(kLeft, static_cast<double>(round));
  return part_of(progress, 1 - left, 1 - left * kLeft);
}

void report_share(const ProgressCallback& progress, Stage stage, double share) {
  if (progress && !progress(stage, share)) throw Cancelled();
}

}  // namespace vdb_offset
