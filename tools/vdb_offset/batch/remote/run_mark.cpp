// SPDX-License-Identifier: Apache-2.0
#include "batch/remote/run_mark.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <system_error>
#include <thread>

#include "batch/fingerprint.h"
#include "batch/model_run.h"
#include "batch/process/program.h"
#include "batch/process/stop.h"
#include "messages.h"
#include "outputs.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

constexpr std::array<const char*, 3> kWays = {"here", "sshlogin", "slurm"};
// Seconds after which tasks that GNU parallel has begun have ended, once it is gone: they look for the mark several
// times a second, and what is at work ends at once.
constexpr double kSecondsOfTasks = 3;
// Seconds to wait for jobs that Slurm has been asked to end.
constexpr double kMostSeconds = 60;

std::string path_of_mark(const std::string& out) { return state_folder(out) + "/run"; }

void wait_until(const std::function<bool()>& is_over, double seconds) {
  const auto begun = Clock::now();
  while (!is_over() && seconds_since(begun) < seconds && !stop_signal())
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
}

void end_jobs(const std::string& name) {
  constexpr const char* kOption = "--slurm, of the batch before";
  ask_program({"scancel", "--name=" + name}, kOption);
  wait_until(
      [&] {
        return ask_program({"squeue", "--noheader", "--name=" + name}, kOption).printed.empty();
      },
      kMostSeconds);
}

std::string new_name() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  constexpr std::size_t kDigits = 16;
  return "vdb_offset-" + fingerprint_of(fmt::format("{} {} {}", host.data(), ::getpid(), now)).substr(0, kDigits);
}

}  // namespace

RunMark::RunMark(const std::string& out, Way way) : path_(path_of_mark(out)), name_(new_name()) {
  std::string before, way_before;
  std::ifstream(path_) >> before >> way_before;
  OutputFiles files(OutputFiles::Sync::No);
  write_file(path_, fmt::format("{} {}\n", name_, kWays[static_cast<std::size_t>(way)]));
  files.commit();
  if (way_before == kWays[1]) wait_until([] { return false; }, kSecondsOfTasks);
  if (way_before != kWays[2]) return;
  try {
    end_jobs(before);
  } catch (const InvalidInput& error) {
    report_problem(error.what());
  }
}

RunMark::~RunMark() {
  std::error_code gone;
  std::filesystem::remove(path_, gone);
}

std::string batch_at_work(const std::string& out) {
  std::string name;
  std::ifstream(path_of_mark(out)) >> name;
  return name;
}

}  // namespace vdb_offset::tool
