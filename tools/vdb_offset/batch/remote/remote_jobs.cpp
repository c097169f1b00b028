// SPDX-License-Identifier: Apache-2.0
#include "batch/remote/remote_jobs.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <unordered_map>

#include "batch/process/stop.h"
#include "batch/remote/plan.h"
#include "job.h"
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

/// Reports the records that have come.
void look_for_records(const BatchRequest& request, std::span<const Model> models, const std::string& mark,
                      Awaited& awaited, const LocalJobs::Ended& ended) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_of_records(request.out))) {
    const auto found = awaited.find(entry.path().stem().string());
    if (found == awaited.end() || entry.path().extension() != ".json") continue;
    const std::optional<Record> record = load_record(request.out, models[found->second]);
    if (!record || record->batch != mark) continue;
    ended(found->second, *record);
    awaited.erase(found);
  }
}

/// What one of the tasks on this machine may take: GNU parallel begins as many at once as it was asked to, for all
/// machines or for this one, or as many as there are processors; those of Slurm have processors of their own.
Shares shares_of_task(BatchRequest request) {
  if (const char* const login = std::getenv("PARALLEL_SSHLOGIN"); login && request.partition.empty()) {
    int jobs = 0;
    const std::string_view text = login;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), jobs);
    if (error == std::errc() && jobs > 0 && end != text.data() + text.size() && *end == '/') request.jobs = jobs;
  }
  Shares shares = share_out(request);
  shares.memory = std::max<std::size_t>(1, shares.memory / std::exchange(shares.jobs, 1));
  return shares;
}

}  // namespace

void run_remotely(const BatchRequest& request, std::span<const Model> models, std::span<const std::size_t> which,
                  const RunMark& mark, const BatchNews& news) {
  const bool by_slurm = !request.partition.empty();
  Plan plan{request, {}, mark.name(), by_slurm ? std::min(which.size(), most_tasks_of_slurm()) : which.size()};
  if (by_slurm) plan.most_at_once = static_cast<std::size_t>(plan.request.jobs.value_or(0));
  if (by_slurm) plan.request.jobs = 1;  // in a task: the others are Slurm's to begin
  Awaited awaited;
  for (const std::size_t model : which) {
    plan.models.push_back(models[model]);
    awaited.emplace(state_name(models[model]), model);
  }
  write_plan(plan);
  const std::unique_ptr<Tasks> tasks = by_slurm ? start_by_slurm(plan) : start_by_parallel(plan);
  news.begun();
  for (int looks_left = kLastLooks; looks_left > 0 && !awaited.empty() && !stop_signal();) {
    if (!tasks->are_at_work()) --looks_left;
    look_for_records(request, models, mark.name(), awaited, news.ended);
    news.waited();
    if (!awaited.empty()) rest();
  }
  if (stop_signal()) {
    tasks->stop();
    look_for_records(request, models, mark.name(), awaited, news.ended);
    return;
  }
  Record lost;
  lost.ending = {.exit_code = kProcessing, .message = "its task ended without a result: " + tasks->last_words()};
  for (const auto& [name, model] : awaited) news.ended(model, lost);
}

int run_task(int argc, const char* const* argv) {
  constexpr int kWords = 4;  // of the command line
  if (argc != kWords) throw UsageError("batch-task: expected PLAN and NUMBER");
  const Plan plan = read_plan(argv[2]);
  const auto number = static_cast<std::size_t>(parse_count("batch-task", argv[3], 0, static_cast<int>(plan.tasks) - 1));
  std::vector<std::size_t> which;
  for (std::size_t model = number; model < plan.models.size(); model += plan.tasks) which.push_back(model);
  catch_stops();
  BatchNews news;
  news.waited = [&] {
    if (batch_at_work(plan.request.out) != plan.mark) std::raise(SIGTERM);
  };
  news.waited();
  LocalJobs(plan.request, plan.models, shares_of_task(plan.request), plan.mark).run(which, news);
  if (stop_signal()) end_by_stop();
  return 0;
}

}  // namespace vdb_offset::tool
