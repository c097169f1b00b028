// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <vector>

#include "vdb_offset/run.h"
namespace vdb_offset {

/// Tells one callback of several like pieces of work that are done at the same time as if they were one.
class JointProgress {
 public:
  /// Keeps a reference to the callback.
  JointProgress(const ProgressCallback& callback, std::size_t pieces) : callback_(callback), share_(pieces, 0.0) {}

  /// The callback for one piece of the work. Empty if the joint one is.
  ProgressCallback of(std::size_t piece);

 private:
  const ProgressCallback& callback_;
  std::vector<double> share_;  // of each piece: the share that is done
  std::mutex mutex_;
};

/// How many units a stage has.
enum class Units {
  Known,   ///< As many as are named.
  Unknown  ///< Half of the stage is shown once as many as are named are done, and ever less for each one after.
};

/// Carries one stage's progress from many threads to one callback.
class Progress {
 public:
  /// `total` units of work make up the stage. An empty callback costs nothing and never cancels.
  Progress(const ProgressCallback& callback, Stage stage, std::size_t total, Units units = Units::Known);

  /// Reports `count` more units. \throw Cancelled once the callback has returned false.
  void advance(std::size_t count);

 private:
  void tell(std::size_t done);

  const ProgressCallback& callback_;
  Stage stage_;
  std::size_t total_;
  Units units_;
  std::atomic<std::size_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::mutex mutex_;
};

}  // namespace vdb_offset
