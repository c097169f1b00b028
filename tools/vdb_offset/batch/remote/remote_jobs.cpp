// SPDX-License-Identifier: Apache-2.0
#include "batch/remote/remote_jobs.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <set>
#include <system_error>
#include <unordered_map>

#include "batch/process/stop.h"
#include "batch/remote/plan.h"
#include "messages.h"
#include "request/option_values.h"

namespace vdb_offset::tool {
namespace {

namespace fs = std::filesystem;

// Milliseconds between two looks at the records.
constexpr int kLookForRecordsEvery = 500;
// Looks after the end of all tasks: on another machine's disk a file may be seen later.
constexpr int kLastLooks = 4;

/// Waits, unless a stop is asked for.
void rest() {
  pollfd stop{stop_descriptor(), POLLIN, 0};
  ::poll(&stop, 1, kLookForRecordsEvery);
}

/// The models that tasks have, by the names of their records.
using Awaited = std::unordered_map<std::string, std::size_t>;

/// Tells of the records that have come.
void look_for_records(const BatchRequest& request, std::span<const Model> models, Awaited& awaited,
                      const LocalJobs::Ended& ended) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_of_records(request.out))) {
    const auto found = awaited.find(entry.path().stem().string());
    if (found == awaited.end() || entry.path().extension() != ".json") continue;
    const std::optional<Record> record = load_record(request.out, models[found->second]);
    if (!record) continue;
    ended(found->second, *record);
    awaited.erase(found);
  }
}

}  // namespace

void run_remotely(const BatchRequest& request, std::span<const Model> models, std::span<const std::size_t> which,
                  const LocalJobs::Ended& ended, const std::function<void()>& waited) {
  const bool by_slurm = !request.partition.empty();
  Plan plan{request, {}, by_slurm ? std::min(which.size(), most_tasks_of_slurm()) : which.size()};
  if (by_slurm) plan.request.jobs = 1;  // in a task: the others are Slurm's to begin
  Awaited awaited;
  for (const std::size_t model : which) {
    remove_record(request.out, models[model]);
    plan.models.push_back(models[model]);
    awaited.emplace(state_name(models[model]), model);
  }
  std::error_code gone;
  fs::remove(path_of_stop(request.out), gone);
  write_plan(plan);
  const std::unique_ptr<Tasks> tasks =
      by_slurm ? start_by_slurm(request, plan.tasks) : start_by_parallel(request, plan.tasks);
  for (int looks_left = kLastLooks; looks_left > 0 && !awaited.empty() && !stop_signal();) {
    if (!tasks->are_at_work()) --looks_left;
    look_for_records(request, models, awaited, ended);
    waited();
    if (!awaited.empty()) rest();
  }
  if (stop_signal()) {
    write_file(path_of_stop(request.out), "");
    tasks->stop();
    look_for_records(request, models, awaited, ended);
    return;
  }
  Record lost;
  lost.ending = {.exit_code = 3, .message = "its task ended without a result: " + tasks->last_words()};
  for (const auto& [name, model] : awaited) ended(model, lost);
}

int run_task(int argc, const char* const* argv) {
  constexpr int kWords = 4;  // of the command line
  if (argc != kWords) throw UsageError("batch-task: expected PLAN and NUMBER");
  const Plan plan = read_plan(argv[2]);
  const auto number = static_cast<std::size_t>(parse_count("batch-task", argv[3], 0, static_cast<int>(plan.tasks) - 1));
  std::vector<std::size_t> which;
  for (std::size_t model = number; model < plan.models.size(); model += plan.tasks) which.push_back(model);
  catch_stops();
  Shares shares = share_out(plan.request);
  shares.memory /= std::exchange(shares.jobs, 1);  // the others are tasks, too
  const std::string stop = path_of_stop(plan.request.out);
  LocalJobs(plan.request, plan.models, shares)
      .run(
          which, [](std::size_t, const Record&) {},
          [&] {
            std::error_code unknown;
            if (fs::exists(stop, unknown)) std::raise(SIGTERM);
          });
  if (stop_signal()) end_by_stop();
  return 0;
}

}  // namespace vdb_offset::tool
