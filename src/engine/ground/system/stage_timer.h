// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>

#include "vdb_offset/run.h"

namespace vdb_offset {

/// Adds the time between its construction and its destruction to one stage's seconds.
class StageTimer {
 public:
  StageTimer(std::array<double, kStageCount>& seconds, Stage stage)
      : seconds_(seconds[static_cast<std::size_t>(stage)]), start_(Clock::now()) {}
  ~StageTimer() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_;
};

}  // namespace vdb_offset
