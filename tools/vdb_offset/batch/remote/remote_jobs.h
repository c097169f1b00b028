// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "batch/local_jobs.h"
#include "batch/remote/plan.h"
#include "batch/remote/run_mark.h"

namespace vdb_offset::tool {

/// Tasks of a plan on other machines.
class Tasks {
 public:
  virtual ~Tasks() = default;
  virtual bool are_at_work() = 0;
  /// Ends them.
  virtual void stop() = 0;
  /// What is known where a task ended without a record.
  virtual std::string last_words() const = 0;
};

/// Has models offset on other machines: writes a plan, has tasks started, and looks for the records that these save.
/// \throw InvalidInput if tasks cannot be started, WriteError
void run_remotely(const BatchRequest& request, std::span<const Model> models, std::span<const std::size_t> which,
                  const RunMark& mark, const BatchNews& news);

/// Carries out one task of a plan, on the machine that this is. The exit code of `vdb_offset batch-task PLAN NUMBER`.
int run_task(int argc, const char* const* argv);

/// Tasks by GNU parallel on the machines of a list. \throw InvalidInput
std::unique_ptr<Tasks> start_by_parallel(const Plan& plan);

/// The number of tasks that an array of Slurm can have.
std::size_t most_tasks_of_slurm();
/// Tasks as an array of jobs of Slurm. \throw InvalidInput
std::unique_ptr<Tasks> start_by_slurm(const Plan& plan);

}  // namespace vdb_offset::tool
