// SPDX-License-Identifier: Apache-2.0
#include "ground/system/progress_count.h"

#include <algorithm>
#include <numeric>

#include "vdb_offset/run.h"

namespace vdb_offset {

const char* name(Stage stage) {
  constexpr const char* kNames[kStageCount] = {"read",  "rasterise", "sweep",  "gradient", "propagate", "capture",
                                               "limit", "refine",    "layers", "measure",  "fill",      "write"};
  return kNames[static_cast<std::size_t>(stage)];
}

ProgressCallback JointProgress::of(std::size_t piece) {
  if (!callback_) return {};
  return [this, piece](Stage stage, double share) {
    const std::lock_guard lock(mutex_);
    share_[piece] = share;
    const double sum = std::accumulate(share_.begin(), share_.end(), 0.0);
    return callback_(stage, sum / static_cast<double>(share_.size()));
  };
}

Progress::Progress(const ProgressCallback& callback, Stage stage, std::size_t total, Units units)
    : callback_(callback), stage_(stage), total_(std::max<std::size_t>(total, 1)), units_(units) {
  if (!callback_) return;
  tell(0);
  if (cancelled_) throw Cancelled();
}

void Progress::advance(std::size_t count) {
  if (!callback_) return;
  const std::size_t done = done_.fetch_add(count) + count;
  tell(done);
  if (cancelled_) throw Cancelled();
}

void Progress::tell(std::size_t done) {
  // A thread that finds the callback busy does not wait for it: a progress bar needs no exact count.
  std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return;
  const auto units = static_cast<double>(done), total = static_cast<double>(total_);
  const double share = units_ == Units::Known ? std::min(1.0, units / total) : units / (units + total);
  if (!callback_(stage_, share)) cancelled_ = true;
}

}  // namespace vdb_offset
