// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <span>
#include <string>
#include <vector>

#include "batch/batch_request.h"
#include "batch/model_run.h"
#include "batch/models.h"
#include "batch/process/child.h"
#include "batch/record.h"
#include "outputs.h"

namespace vdb_offset::tool {

/// How many models are at work on this machine at once, and what they may take.
struct Shares {
  std::size_t jobs = 1;
  std::size_t threads = 1;  ///< Each.
  std::size_t memory = 0;   ///< Bytes, all together.
};

/// What this machine has, shared out as the request says.
Shares share_out(const BatchRequest& request);

/// What a batch reports while it is at work.
struct BatchNews {
  std::function<void()> begun = [] {};  ///< Models are about to be done; before that, nothing has been changed.
  std::function<void(std::size_t model, const Record& record)> ended = [](std::size_t, const Record&) {};
  std::function<void()> waited = [] {};  ///< Several times a second.
};

/// Offsets models on this machine, several at once, each by a process of its own. Once a stop is asked for (see
/// stop.h), they are ended, and no other is begun.
class LocalJobs {
 public:
  using Ended = decltype(BatchNews::ended);

  /// `mark` is that of the batch (see RunMark).
  LocalJobs(const BatchRequest& request, std::span<const Model> models, const Shares& shares, std::string mark)
      : request_(request), models_(models), shares_(shares), mark_(std::move(mark)) {}

  /// Offsets these of the models. A record is saved for each that has ended, then news.ended is called. \throw
  /// WriteError
  void run(std::span<const std::size_t> which, const BatchNews& news);

 private:
  struct Job {
    std::size_t model;
    ModelRun run;
    Ingredients made_of;
    std::string key, stamp;
    Clock::time_point begun;
    double waited = 0;       // seconds, for memory
    std::size_t held = 0;    // bytes that it may take
    std::size_t wanted = 0;  // bytes that it waits for; 0: it does not
    Clock::time_point asked = {};
    std::size_t overtaken = 0;  // by how many that began later, while it waits
    Child child;
  };

  bool has_room_for(std::size_t model) const;
  bool try_to_begin(std::size_t model, const Ended& ended);
  void begin(std::size_t model, ModelRun run);
  void refuse(std::size_t model, const char* why, const Ended& ended);
  void hand_out_memory();
  void wait_for_news(const Ended& ended);
  bool read_news(Job& job);
  void end(Job& job, const Ended& ended);
  void stop(const Ended& ended);

  const BatchRequest& request_;
  std::span<const Model> models_;
  Shares shares_;
  std::string mark_;
  std::list<Job> jobs_;
  bool forced_ = false;  // models have been ended by force
};

}  // namespace vdb_offset::tool
