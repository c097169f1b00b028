// SPDX-License-Identifier: Apache-2.0
// `vdb_offset batch`: which models are to be done, and what is told of them.
#include "batch/batch_command.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <vector>

#include "batch/batch_request.h"
#include "batch/local_jobs.h"
#include "batch/process/child.h"
#include "batch/process/stop.h"
#include "batch/progress_line.h"
#include "batch/remote/remote_jobs.h"
#include "batch/table.h"
#include "job.h"
#include "messages.h"
#include "vdb_offset/error.h"

namespace vdb_offset::tool {
namespace {

namespace fs = std::filesystem;

/// Makes the paths of both folders absolute, without links. \throw InvalidInput, UsageError
void settle_folders(BatchRequest& request) {
  std::error_code failed;
  if (!fs::is_directory(request.folder, failed))
    throw InvalidInput(request.folder + ": expected a folder with models, got none");
  if (fs::exists(request.out, failed) && !fs::is_directory(request.out, failed))
    throw UsageError("OUT: expected a folder, got the file " + request.out);
  request.folder = fs::canonical(request.folder).string();
  fs::path out = fs::weakly_canonical(fs::absolute(request.out));
  if (!out.has_filename()) out = out.parent_path();
  request.out = out.string();
  if (request.out == request.folder) throw UsageError("OUT: expected another folder than DIR, got " + request.out);
}

/// Makes the folders that the batch keeps its state in. \throw WriteError
void make_state_folders(const std::string& out) {
  std::error_code failed;
  for (const std::string& folder : {folder_of_records(out), state_folder(out) + "/running"}) {
    fs::create_directories(folder, failed);
    if (failed) throw WriteError(fmt::format("{}: cannot be made: {}", folder, failed.message()));
  }
}

/// Keeps others from the same outputs for as long as it lives. \throw UsageError if there is one
Descriptor lock(const std::string& out) {
  const std::string path = state_folder(out) + "/lock";
  Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  if (file.number() < 0) throw WriteError(fmt::format("{}: cannot be made: {}", path, std::strerror(errno)));
  if (::flock(file.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw UsageError(
        fmt::format("{}: expected a folder for this batch alone, got one that another is writing to", out));
  return file;
}

/// A batch, from what is there already to the table.
class Batch {
 public:
  Batch(const BatchRequest& request, const std::vector<Model>& models)
      : request_(request), models_(models), table_(request.out) {
    sort_out();
  }

  void print_plan() const;
  /// Does what is to be done, unless a stop is asked for.
  ExitCode run();

 private:
  void sort_out();
  double work_of(std::size_t model) const;
  void end(std::size_t model, const Record& record, ProgressLine& progress);
  void print_summary(double seconds) const;

  const BatchRequest& request_;
  const std::vector<Model>& models_;
  Table table_;
  std::vector<std::size_t> to_do_;
  std::size_t kept_ = 0, done_ = 0, failed_ = 0;
};

/// Finds out which models are done already, with the same content and options.
void Batch::sort_out() {
  for (std::size_t i = 0; i < models_.size(); ++i) {
    const auto record = load_record(request_.out, models_[i]);
    const bool failed = record && record->ending.exit_code != 0;
    bool as_it_is = record && !(failed && request_.retry_failed);
    if (as_it_is) {
      const ModelRun run = run_of(request_, models_[i]);
      as_it_is = are_there(run, *record) && record->key == key_of(request_, models_[i], run);
    }
    if (!as_it_is) {
      to_do_.push_back(i);
      continue;
    }
    ++(failed ? failed_ : kept_);
    table_.keep(i, rows_of(models_[i], *record));
  }
}

void Batch::print_plan() const {
  const Printout out;
  for (const std::size_t i : to_do_) fmt::print(out, "{}\n", readable(models_[i].path));
  fmt::print(out, "{} of {} to do\n", to_do_.size(), models_in_words(models_.size()));
}

double Batch::work_of(std::size_t model) const {
  std::error_code unknown;
  const auto size = fs::file_size(request_.folder + "/" + models_[model].path, unknown);
  return 1 + (unknown ? 0 : static_cast<double>(size));
}

void Batch::end(std::size_t model, const Record& record, ProgressLine& progress) {
  const std::string rows = rows_of(models_[model], record);
  table_.add(model, rows);
  const int code = record.ending.exit_code;
  ++(code == 0 ? done_ : failed_);
  progress.count(work_of(model), code != 0);
  progress.clear();
  if (code != 0) tell(fmt::format("{}: failed ({}): {}", models_[model].path, code, record.ending.message));
  if (request_.verbose) fmt::print(Printout(), "{}", rows);
}

ExitCode Batch::run() {
  const auto begun = Clock::now();
  table_.begin();
  double work = 0;
  for (const std::size_t model : to_do_) work += work_of(model);
  ProgressLine progress(!request_.quiet, to_do_.size(), work);
  const auto ended = [&](std::size_t model, const Record& record) { end(model, record, progress); };
  const auto waited = [&] { progress.show(); };
  if (to_do_.empty()) progress.clear();
  else if (!request_.sshlogin.empty() || !request_.partition.empty())
    run_remotely(request_, models_, to_do_, ended, waited);
  else LocalJobs(request_, models_, share_out(request_)).run(to_do_, ended, waited);
  progress.clear();
  table_.finish();
  if (stop_signal())
    tell(fmt::format("stopped: {} of {} have ended; the same call goes on from there", kept_ + done_ + failed_,
                     models_in_words(models_.size())));
  else if (!request_.quiet) print_summary(seconds_since(begun));
  return failed_ == 0 ? kDone : kProcessing;
}

void Batch::print_summary(double seconds) const {
  std::string line = fmt::format("{}: {}: {} done", table_.path(), models_in_words(models_.size()), done_);
  if (kept_ > 0) line += fmt::format(", {} as before", kept_);
  if (failed_ > 0) line += fmt::format(", {} failed", failed_);
  fmt::print(Printout(), "{} ({})\n", line, time_in_words(seconds));
}

}  // namespace

bool is_batch(int argc, const char* const* argv) {
  return argc > 1 && (std::strcmp(argv[1], "batch") == 0 || std::strcmp(argv[1], "batch-task") == 0);
}

int run_batch(int argc, const char* const* argv) {
  if (std::strcmp(argv[1], "batch-task") == 0) return run_task(argc, argv);
  auto request = parse_batch(argc - 1, argv + 1);
  if (!request) return kDone;
  settle_folders(*request);
  const std::vector<Model> models = find_models(request->folder, request->out, request->selection);
  require_apart(*request, models);
  if (request->dry_run) {
    Batch(*request, models).print_plan();
    return kDone;
  }
  make_state_folders(request->out);
  const Descriptor alone = lock(request->out);
  catch_stops();
  const ExitCode code = Batch(*request, models).run();
  if (stop_signal()) end_by_stop();
  return code;
}

}  // namespace vdb_offset::tool
