// SPDX-License-Identifier: Apache-2.0
// Tasks of a batch on other machines, by GNU parallel.
#include <fmt/format.h>

#include <csignal>
#include <fstream>

#include "batch/process/program.h"
#include "batch/remote/plan.h"
#include "batch/remote/remote_jobs.h"
#include "batch/remote/shell_words.h"
#include "messages.h"

namespace vdb_offset::tool {
namespace {

class ParallelTasks : public Tasks {
 public:
  ParallelTasks(const std::vector<std::string>& words, const std::string& input, const std::string& log)
      : log_(log), program_(words, "--sshlogin", input, log) {}

  bool are_at_work() override { return program_.is_at_work(); }
  /// The tasks miss the mark of the batch; parallel begins no other once it is asked to end.
  void stop() override { program_.signal(SIGTERM); }
  std::string last_words() const override { return last_line_of(log_); }

 private:
  std::string log_;
  Program program_;
};

}  // namespace

std::unique_ptr<Tasks> start_by_parallel(const Plan& plan) {
  const BatchRequest& request = plan.request;
  std::vector<std::string> words{"parallel", "--will-cite", "--null",     "--retries",     "3",
                                 "--halt",   "never",       "--sshlogin", request.sshlogin};
  if (request.jobs) words.insert(words.end(), {"--jobs", fmt::format("{}", *request.jobs)});
  // Whole commands, as in a command with numbers to be filled in, some characters of names mean something.
  std::string commands;
  for (std::size_t task = 0; task < plan.tasks; ++task)
    commands += fmt::format("{} {}", words_of_task(request.out), task) + '\0';
  return std::make_unique<ParallelTasks>(words, commands, log_of_tasks(request.out));
}

}  // namespace vdb_offset::tool
