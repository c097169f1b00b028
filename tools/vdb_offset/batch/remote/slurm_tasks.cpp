// SPDX-License-Identifier: Apache-2.0
// Tasks of a batch as an array of jobs of Slurm.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "batch/model_run.h"
#include "batch/process/child.h"
#include "batch/process/program.h"
#include "batch/remote/plan.h"
#include "batch/remote/remote_jobs.h"
#include "batch/remote/shell_words.h"
#include "outputs.h"
#include "vdb_offset/error.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::tool {
namespace {

constexpr const char* kOption = "--slurm";
constexpr double kSecondsBetweenQuestions = 2;  // to Slurm, which answers all of its users

/// Where the number of the array is while it is at work.
std::string note_of_array(const std::string& out) { return state_folder(out) + "/array"; }

/// Ends the array of a batch that was killed, as it would work on beside the new one.
void cancel_array_before(const std::string& out) {
  std::string array;
  if (std::ifstream(note_of_array(out)) >> array) ask_program({"scancel", array}, kOption);
}

class SlurmTasks : public Tasks {
 public:
  SlurmTasks(std::string array, const std::string& out)
      : array_(std::move(array)), log_(log_of_tasks(out)), note_(note_of_array(out)) {
    write_file(note_, array_);
  }
  ~SlurmTasks() override {
    std::error_code gone;
    std::filesystem::remove(note_, gone);
  }

  bool are_at_work() override {
    if (!at_work_ || seconds_since(asked_) < kSecondsBetweenQuestions) return at_work_;
    asked_ = Clock::now();
    // An array that is over is forgotten after a while, and then is an error.
    const Answer answer = ask_program({"squeue", "--noheader", "--jobs", array_, "--format", "%i"}, kOption);
    const bool unknown = answer.exit_code != 0 && answer.printed.find("Invalid job id") != std::string::npos;
    at_work_ = !unknown && !(answer.exit_code == 0 && answer.printed.empty());
    return at_work_;
  }
  void stop() override { ask_program({"scancel", array_}, kOption); }
  std::string last_words() const override { return last_line_of(log_); }

 private:
  std::string array_, log_, note_;
  Clock::time_point asked_ = Clock::now();
  bool at_work_ = true;
};

}  // namespace

std::size_t most_tasks_of_slurm() {
  constexpr std::size_t kUsual = 1001;  // where Slurm's configuration says nothing
  constexpr std::string_view kName = "MaxArraySize";
  const std::string facts = ask_program({"scontrol", "show", "config"}, kOption).printed;
  std::size_t most = kUsual;
  if (const std::size_t at = facts.find(kName); at != std::string::npos) {
    const std::size_t number = facts.find_first_of("0123456789", at);
    if (number != std::string::npos) std::from_chars(facts.data() + number, facts.data() + facts.size(), most);
  }
  return std::max<std::size_t>(1, most - 1);
}

std::unique_ptr<Tasks> start_by_slurm(const BatchRequest& request, std::size_t tasks) {
  cancel_array_before(request.out);
  const std::string log = log_of_tasks(request.out);
  std::error_code gone;
  std::filesystem::remove(log, gone);
  std::vector<std::string> words{"sbatch",
                                 "--parsable",
                                 "--job-name=vdb_offset",
                                 "--partition=" + request.partition,
                                 fmt::format("--array=0-{}", tasks - 1),
                                 "--output=" + log,
                                 "--open-mode=append"};
  if (request.jobs) words[4] += fmt::format("%{}", *request.jobs);
  for (const GivenOption& option : request.each)
    if (option.name == "--threads" && *option.value != "0") words.push_back("--cpus-per-task=" + *option.value);
  words.push_back("--wrap=" + words_of_task(request.out) + " \"$SLURM_ARRAY_TASK_ID\"");
  const Answer answer = ask_program(words, kOption);
  if (answer.exit_code != 0) throw InvalidInput(fmt::format("{}: {}", kOption, on_one_line(answer.printed)));
  // The number of the array, and behind a semicolon the name of the cluster.
  return std::make_unique<SlurmTasks>(answer.printed.substr(0, answer.printed.find(';')), request.out);
}

}  // namespace vdb_offset::tool
