// SPDX-License-Identifier: Apache-2.0
// Tasks of a batch as an array of jobs of Slurm.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <system_error>

#include "batch/process/child.h"
#include "batch/process/program.h"
#include "batch/remote/plan.h"
#include "batch/remote/remote_jobs.h"
#include "batch/remote/shell_words.h"
#include "messages.h"
#include "outputs.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

constexpr const char* kOption = "--slurm";
constexpr double kSecondsBetweenQuestions = 2;  // to Slurm, which answers all of its users
constexpr double kSecondsToTell = 30;           // until a line says why nothing begins

class SlurmTasks : public Tasks {
 public:
  SlurmTasks(std::string array, std::string log) : array_(std::move(array)), log_(std::move(log)) {}
  ~SlurmTasks() override {
    if (!at_work_) return;
    try {
      ask_program({"scancel", array_}, kOption);
    } catch (const Error& error) {
      report_problem(error.what());
    }
  }

  bool are_at_work() override {
    if (!at_work_ || seconds_since(asked_) < kSecondsBetweenQuestions) return at_work_;
    asked_ = Clock::now();
    // An array that is over is forgotten after a while, and then is an error. So is a Slurm that does not answer.
    const Answer answer = ask_program({"squeue", "--noheader", "--jobs", array_, "--format", "%T %r"}, kOption);
    const bool unknown = answer.exit_code != 0 && answer.printed.find("Invalid job id") != std::string::npos;
    at_work_ = !unknown && !(answer.exit_code == 0 && answer.printed.empty());
    if (answer.exit_code == 0) report_waiting(answer.printed);
    return at_work_;
  }
  void stop() override {
    ask_program({"scancel", array_}, kOption);
    at_work_ = false;
  }
  std::string last_words() const override { return last_line_of(log_); }

 private:
  /// Says once why nothing begins, as with more processors asked for than a machine has.
  void report_waiting(const std::string& states) {
    has_begun_ |= states.find("RUNNING") != std::string::npos || states.find("COMPLETING") != std::string::npos;
    if (has_begun_ || seconds_since(submitted_) < kSecondsToTell) return;
    has_begun_ = true;
    report_problem(fmt::format("{}: no job has begun yet: {}", kOption, states.substr(0, states.find('\n'))));
  }

  std::string array_, log_;
  Clock::time_point submitted_ = Clock::now(), asked_ = submitted_;
  bool at_work_ = true, has_begun_ = false;
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

std::unique_ptr<Tasks> start_by_slurm(const Plan& plan) {
  const BatchRequest& request = plan.request;
  const std::string log = log_of_tasks(request.out);
  std::error_code gone;
  std::filesystem::remove(log, gone);
  std::string array = fmt::format("--array=0-{}", plan.tasks - 1);
  if (plan.most_at_once > 0) array += fmt::format("%{}", plan.most_at_once);
  std::vector<std::string> words{
      "sbatch", "--parsable",        "--job-name=" + plan.mark, "--partition=" + request.partition,
      array,    "--output=/dev/null"};
  for (const GivenOption& option : request.each)
    if (option.name == "--threads" && *option.value != "0") words.push_back("--cpus-per-task=" + *option.value);
  // (In names of logs that Slurm is given, some characters mean something.)
  words.push_back(
      fmt::format("--wrap={} \"$SLURM_ARRAY_TASK_ID\" >>{} 2>&1", words_of_task(request.out), in_quotes(log)));
  const Answer answer = ask_program(words, kOption);
  if (answer.exit_code != 0) throw InvalidInput(fmt::format("{}: {}", kOption, on_one_line(answer.printed)));
  // The number of the array, and behind a semicolon the name of the cluster.
  return std::make_unique<SlurmTasks>(answer.printed.substr(0, answer.printed.find(';')), log);
}

}  // namespace vdb_offset::tool
