#pragma once

#include <array>
#include <chrono>
#include <span>

#include "vdb_offset/field/direction_field.h"
#include "vdb_offset/pipeline/offset.h"

namespace vdb_offset {

// What every run does besides its stages: it takes their time, and tells of them.

/// Adds the time that it lives to one stage's seconds.
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

/// How many threads to use if `asked` are asked for; 0: as many as the machine has. \throw InvalidInput below 0
int thread_count(int asked);

void describe_field(const DistanceField& field, const DirectionField& directions, OffsetStatistics& statistics);

void count_states(std::span<const VertexState> states, OffsetStatistics& statistics);

}  // namespace vdb_offset
