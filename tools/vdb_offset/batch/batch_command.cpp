// SPDX-License-Identifier: Apache-2.0
// `vdb_offset batch`: which models are to be done, and what is reported of them.
#include "batch/batch_command.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include "batch/batch_request.h"
#include "batch/local_jobs.h"
#include "batch/process/child.h"
#include "batch/process/stop.h"
#include "batch/progress_line.h"
#include "batch/remote/remote_jobs.h"
#include "batch/remote/run_mark.h"
#include "batch/table.h"
#include "job.h"
#include "messages.h"
#include "terminal.h"
#include "vdb_offset/run.h"

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
  for (const char* const mark : {"{i}", "{d}"})
    if (request.out.find(mark) != std::string::npos)
      throw UsageError(
          "OUT: expected a folder without {i} and {d} in its path, which stand for the number of a distance "
          "and for the distance, got " +
          request.out);
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

Way way_of(const BatchRequest& request) {
  return !request.sshlogin.empty() ? Way::SshLogin : !request.partition.empty() ? Way::Slurm : Way::Here;
}

/// A batch, from what is there already to the table.
class Batch {
 public:
  Batch(const BatchRequest& request, const FoundModels& found)
      : request_(request), models_(found.models), left_out_(found.unreadable.size()), table_(request.out) {
    sort_out();
  }

  void print_plan() const;
  /// Does what is to be done, unless a stop is asked for.
  ExitCode run(const RunMark& mark);

 private:
  void sort_out();
  std::optional<Record> record_that_holds(const Model& model) const;
  double work_of(std::size_t model) const;
  void end(std::size_t model, const Record& record, ProgressLine& progress);
  void print_summary(double seconds) const;

  const BatchRequest& request_;
  const std::vector<Model>& models_;
  std::size_t left_out_;  // folders
  Table table_;
  std::vector<std::size_t> to_do_;
  std::size_t kept_ = 0, done_ = 0, warned_ = 0, failed_ = 0;
};

/// Finds out which models are done already, with the same content and options.
void Batch::sort_out() {
  ProgressLine progress(!request_.quiet, models_.size(), 0, "looked at");
  for (std::size_t i = 0; i < models_.size() && !stop_signal(); ++i) {
    const std::optional<Record> record = record_that_holds(models_[i]);
    progress.count(0, false);
    progress.show();
    if (!record) {
      to_do_.push_back(i);
      continue;
    }
    ++(record->ending.exit_code != 0 ? failed_ : kept_);
    table_.keep(i, rows_of(models_[i], *record));
  }
}

/// The record of a model that need not be done again.
std::optional<Record> Batch::record_that_holds(const Model& model) const {
  std::optional<Record> record = load_record(request_.out, model);
  if (!record) return std::nullopt;
  // What the disk or a signal did to it may be over.
  if (record->ending.exit_code != 0 && (request_.retry_failed || !record->failed_for_good())) return std::nullopt;
  try {
    const ModelRun run = run_of(request_, model);
    if (!are_there(run, *record)) return std::nullopt;
    const Ingredients made_of = ingredients_of(request_, model, run);
    const std::string stamp = made_of.stamp(record->read_besides);
    if (record->stamp == stamp) return record;
    if (record->key != made_of.key(record->read_besides)) return std::nullopt;
    record->stamp = stamp;
    if (!request_.dry_run) save_record(request_.out, model, *record);
    return record;
  } catch (const UnusableName&) {
    return std::nullopt;
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
  if (code == 0 && std::ranges::any_of(record.figures, [](const auto& each) { return !each.warning.empty(); }))
    ++warned_;
  progress.count(work_of(model), code != 0);
  progress.clear();
  if (code != 0) report_problem(fmt::format("{}: failed ({}): {}", models_[model].path, code, record.ending.message));
  if (request_.verbose) fmt::print(Printout(), "{}", rows);
}

ExitCode Batch::run(const RunMark& mark) {
  const auto begun = Clock::now();
  if (stop_signal()) {  // not all models have been looked at, and the table of the last time is true still
    report_problem("stopped: no model was begun; the table is as it was");
    return kProcessing;
  }
  double work = 0;
  for (const std::size_t model : to_do_) work += work_of(model);
  ProgressLine progress(!request_.quiet, to_do_.size(), work, "done");
  BatchNews news;
  news.begun = [&] { table_.begin(); };
  news.ended = [&](std::size_t model, const Record& record) { end(model, record, progress); };
  news.waited = [&] { progress.show(); };
  if (to_do_.empty()) news.begun();
  else if (way_of(request_) != Way::Here) run_remotely(request_, models_, to_do_, mark, news);
  else LocalJobs(request_, models_, share_out(request_), mark.name()).run(to_do_, news);
  progress.clear();
  table_.finish();
  if (stop_signal())
    report_problem(fmt::format("stopped after {} of {}. Run the same command to resume", kept_ + done_ + failed_,
                               models_in_words(models_.size())));
  else if (!request_.quiet) print_summary(seconds_since(begun));
  return failed_ + left_out_ == 0 ? kDone : kProcessing;
}

void Batch::print_summary(double seconds) const {
  std::string line = fmt::format("{}: {}: {} offset", table_.path(), models_in_words(models_.size()), done_);
  if (warned_ > 0) line += fmt::format(" ({} with a warning, in the column 'message')", warned_);
  if (kept_ > 0) line += fmt::format(", {} already up to date", kept_);
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
  const FoundModels found = find_models(request->folder, request->out, request->selection);
  for (const std::string& folder : found.unreadable) report_problem(folder + "; left out");
  require_apart(*request, found.models);
  if (request->dry_run) {
    Batch(*request, found).print_plan();
    return kDone;
  }
  make_state_folders(request->out);
  const Descriptor alone = lock(request->out);
  catch_stops();
  ExitCode code;
  {
    const RunMark mark(request->out, way_of(*request));
    code = Batch(*request, found).run(mark);
  }
  if (stop_signal()) end_by_stop();
  return code;
}

}  // namespace vdb_offset::tool
