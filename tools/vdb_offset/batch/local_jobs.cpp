// SPDX-License-Identifier: Apache-2.0
#include "batch/local_jobs.h"

#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <thread>

#include "batch/process/stop.h"
#include "job.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

namespace fs = std::filesystem;

// Milliseconds between two looks at the time, for the line of progress.
constexpr int kLookEvery = 250;
// Seconds that models at work have to end after a stop, before they are ended by force. They remove temporary files.
constexpr double kSecondsToStop = 5;
// How often a model that waits for memory may be overtaken by others that take less. Not measured.
constexpr std::size_t kMostOvertaken = 16;
// Bytes that a model is taken to hold for each byte of its file until its estimate is known. Measured, up to then: 6
// to 7, and 13 to 17 where the file is compressed.
constexpr std::size_t kBytesPerByte = 7, kBytesPerPackedByte = 17;

/// Processors that this process may use; of a job of Slurm, which may be bound to none, as many as that was given.
std::size_t processors() {
  std::size_t count = std::max(1U, std::thread::hardware_concurrency());
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof set, &set) == 0) count = static_cast<std::size_t>(std::max(1, CPU_COUNT(&set)));
  if (const char* const given = std::getenv("SLURM_CPUS_ON_NODE"))
    count = std::min(count, static_cast<std::size_t>(std::max(1, std::atoi(given))));
  return count;
}

std::size_t first_guess(const std::string& path) {
  std::error_code unknown;
  const auto size = fs::file_size(path, unknown);
  const bool is_packed = path.ends_with(".gz") || path.ends_with(".zst");
  return unknown ? 0 : (is_packed ? kBytesPerPackedByte : kBytesPerByte) * static_cast<std::size_t>(size);
}

/// Makes the folders that the files of a run go to. The run itself reports what cannot be made.
void make_folders(const ModelRun& run) {
  std::error_code failed;
  for (const std::string& path : run.written) fs::create_directories(fs::path(path).parent_path(), failed);
}

/// Allows this process as many open files as so many jobs need, as far as the system lets it.
void allow_files_for(std::size_t jobs) {
  constexpr rlim_t kOfJob = 2, kElse = 64;  // a pipe and a socket each; what else is open
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  const rlim_t wanted = std::min(limit.rlim_max, kOfJob * jobs + kElse);
  if (wanted <= limit.rlim_cur) return;
  limit.rlim_cur = wanted;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

bool ended_by_stop(const Ending& ending) {
  return ending.exit_code == 128 + SIGINT || ending.exit_code == 128 + SIGTERM || ending.exit_code == 128 + SIGHUP;
}

/// What a model that was killed has left beside its outputs.
void remove_leftovers(const ModelRun& run) {
  for (const auto* const paths : {&run.written, &run.reports})
    for (const std::string& path : *paths) remove_stale_temporaries(replaced_path(path).parent_path());
}

}  // namespace

Shares share_out(const BatchRequest& request) {
  constexpr std::size_t kParts = 5, kPartsTaken = 4;  // four fifths of what is free, as a run by itself
  Shares shares;
  const std::size_t all = processors(), of_machine = std::max(1U, std::thread::hardware_concurrency());
  shares.jobs = request.jobs ? static_cast<std::size_t>(*request.jobs) : all;
  shares.threads = (all + shares.jobs - 1) / shares.jobs;
  // A job of Slurm that has not all processors has no more of the memory, either.
  const std::size_t free = available_memory() / of_machine * std::min(all, of_machine);
  shares.memory = request.max_memory.value_or(std::max<std::size_t>(1, free / kParts * kPartsTaken));
  return shares;
}

void LocalJobs::run(std::span<const std::size_t> which, const BatchNews& news) {
  allow_files_for(shares_.jobs);
  news.begun();
  std::size_t next = 0;
  while (!stop_signal() && (next < which.size() || !jobs_.empty())) {
    while (next < which.size() && !stop_signal() && has_room_for(which[next])) {
      if (try_to_begin(which[next], news.ended)) ++next;
      else shares_.jobs = jobs_.size();  // more than these the system does not allow
    }
    hand_out_memory();
    wait_for_news(news.ended);
    news.waited();
  }
  if (stop_signal()) stop(news.ended);
}

/// Whether another model may begin, by the number of jobs and the memory that it takes to read it.
bool LocalJobs::has_room_for(std::size_t model) const {
  if (jobs_.size() >= shares_.jobs) return false;
  std::size_t held = first_guess(request_.folder + "/" + models_[model].path);
  for (const Job& job : jobs_) {
    held += job.held;
    if (job.overtaken >= kMostOvertaken) return false;
  }
  return jobs_.empty() || held <= shares_.memory;
}

/// False if the system has no process or no descriptor left for another model: then it waits for one of those at work.
/// \throw std::system_error if there is none
bool LocalJobs::try_to_begin(std::size_t model, const Ended& ended) {
  try {
    begin(model, run_of(request_, models_[model]));
  } catch (const UnusableName& error) {
    refuse(model, error.what(), ended);
  } catch (const std::system_error&) {
    if (jobs_.empty()) throw;
    return false;
  }
  return true;
}

void LocalJobs::begin(std::size_t model, ModelRun run) {
  make_folders(run);
  remove_record(request_.out, models_[model]);
  Ingredients made_of = ingredients_of(request_, models_[model], run);
  std::string stamp = made_of.stamp({}), key = made_of.key({});
  if (stop_signal()) return;
  std::vector<std::string> words = run.words;
  if (!request_.threads_given) words.push_back(fmt::format("--threads={}", shares_.threads));
  words.push_back(fmt::format("--max-memory={}", shares_.memory));
  const std::size_t held = first_guess(run.read.front());
  jobs_.push_back({.model = model,
                   .run = std::move(run),
                   .made_of = std::move(made_of),
                   .key = std::move(key),
                   .stamp = std::move(stamp),
                   .begun = Clock::now(),
                   .held = held,
                   .child = Child(words)});
}

/// Notes down a model that cannot be done at all.
void LocalJobs::refuse(std::size_t model, const char* why, const Ended& ended) {
  Record record;
  record.batch = mark_;
  record.ending = {.exit_code = kUsage, .message = why};
  save_record(request_.out, models_[model], record);
  ended(model, record);
}

/// Lets models go on for which there is room, in the order in which they began. One alone always goes on: whether it
/// fits is for its own limit.
void LocalJobs::hand_out_memory() {
  std::size_t held = 0;
  bool any_at_work = false;
  for (const Job& job : jobs_) {
    held += job.held;
    any_at_work |= job.wanted == 0;
  }
  Job* first_waiting = nullptr;
  for (Job& job : jobs_) {
    if (job.wanted == 0) continue;
    // One that takes much is not to be overtaken for ever.
    if (first_waiting && first_waiting->overtaken >= kMostOvertaken) return;
    if (any_at_work && held - job.held + job.wanted > shares_.memory) {
      if (!first_waiting) first_waiting = &job;
      continue;
    }
    held -= job.held;
    job.held = std::exchange(job.wanted, 0);
    held += job.held;
    any_at_work = true;
    job.waited += seconds_since(job.asked);
    job.overtaken = 0;  // others may begin again
    job.child.let_go();
    if (first_waiting) ++first_waiting->overtaken;
  }
}

void LocalJobs::wait_for_news(const Ended& ended) {
  std::vector<pollfd> sources{{stop_descriptor(), POLLIN, 0}};
  for (const Job& job : jobs_) {
    sources.push_back({job.child.errors(), POLLIN, 0});
    sources.push_back({job.child.gate(), POLLIN, 0});
  }
  if (::poll(sources.data(), sources.size(), kLookEvery) <= 0) return;
  for (auto job = jobs_.begin(); job != jobs_.end();) {
    const bool is_there = read_news(*job);
    if (!is_there) end(*job, ended);
    job = is_there ? std::next(job) : jobs_.erase(job);
  }
}

/// Reads what a model reports and asks for. False once it has ended.
bool LocalJobs::read_news(Job& job) {
  job.child.read_errors();
  const bool is_there = job.child.read_gate();
  if (const std::size_t wanted = job.child.wanted(); wanted > 0) {
    job.wanted = wanted;
    job.asked = Clock::now();
  }
  return is_there;
}

void LocalJobs::end(Job& job, const Ended& ended) {
  Ending ending = job.child.wait();
  if (ending.exit_code > 128) remove_leftovers(job.run);
  ending.seconds = seconds_since(job.begun) - job.waited;
  // Ctrl-C goes to the models as well, and they may be faster.
  pollfd stopped{stop_descriptor(), POLLIN, 0};
  if (ended_by_stop(ending) && (stop_signal() || ::poll(&stopped, 1, kLookEvery) > 0)) return;
  if (forced_ && ending.exit_code == 128 + SIGKILL) return;
  Record record = record_of(job.run, std::move(ending));
  record.batch = mark_;
  record.read_besides = job.child.files_read();
  // Of what is found out by reading alone, the contents are those of now.
  record.key = record.read_besides.empty() ? job.key : job.made_of.key(record.read_besides);
  record.stamp = record.read_besides.empty() ? job.stamp : job.made_of.stamp(record.read_besides);
  // The record first: a row that is in the table once is never gone from it.
  save_record(request_.out, models_[job.model], record);
  ended(job.model, record);
}

/// Ends the models at work. One that is complete all the same counts.
void LocalJobs::stop(const Ended& ended) {
  for (const Job& job : jobs_) job.child.signal(SIGTERM);
  const auto begun = Clock::now();
  while (!jobs_.empty()) {
    if (!forced_ && seconds_since(begun) > kSecondsToStop) {
      for (const Job& job : jobs_) job.child.signal(SIGKILL);
      forced_ = true;
    }
    std::vector<pollfd> sources;
    for (const Job& job : jobs_) sources.push_back({job.child.gate(), POLLIN, 0});
    ::poll(sources.data(), sources.size(), kLookEvery);
    jobs_.remove_if([&](Job& job) {
      const bool has_ended = !read_news(job);
      if (has_ended) end(job, ended);
      return has_ended;
    });
  }
}

}  // namespace vdb_offset::tool
