// SPDX-License-Identifier: Apache-2.0
// The command: reads a request from the command line, makes a job of it and the source, and carries it out.
#include <tbb/global_control.h>

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <span>
#include <string>

#include "batch/batch_command.h"
#include "batch/process/gate.h"
#include "check_command.h"
#include "file_plan.h"
#include "iso_command.h"
#include "job.h"
#include "layers/layers_command.h"
#include "messages.h"
#include "offset_command.h"
#include "outputs.h"
#include "page/view_command.h"
#include "request/presets.h"
#include "request/request.h"
#include "source.h"
#include "terminal.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

bool is_cad(const Request& request) {
  const std::optional<io::Format> format = format_of(request.input, request);
  return format && io::is_cad(*format);
}

/// How much of a run reading takes, for its progress. Measured: of CAD models 0.02 to 0.3, of others 0.01 to 0.1.
double reading_share(const Request& request) { return is_cad(request) ? 0.1 : 0.03; }

/// How much of a run writing takes, once all is read. Measured: of CAD models 0.3 to 0.9; of 1, 5 and 20 layers 0.15,
/// 0.45 and 0.7; of others 0.01 to 0.1.
double writing_share(const Job& job) {
  if (is_cad_output(job.request.output, job.request)) return 0.7;
  const auto layers = static_cast<double>(job.request.layers ? job.distances.size() : 0);
  return std::max(0.03, layers / (layers + 7));
}

ExitCode run(const Job& job, const Timing& timing, ProgressBar& bar) {
  require_apart(job.files);
  if (job.request.layers) return run_layers(job, timing, bar);
  return job.request.iso ? run_iso(job, timing, bar) : run_offset(job, timing, bar);
}

ExitCode run(const Request& request) {
  const auto start = Clock::now();
  const bool of_batch = belongs_to_batch();
  report_lost_input(request.input);
  std::optional<tbb::global_control> threads;  // limits reading and writing as well
  if (request.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(request.threads));
  const bool curves = holds_curves(request.input);
  require_for_input(request, curves);
  const FilePlan files = plan_files(request);
  require_apart(files);
  // Names that a scene's own distance is part of, and those of layers, are known later.
  if (!request.dry_run && !request.layers && !request.distances.empty()) require_writable_files(files);
  ProgressBar bar(!request.quiet);
  bar.expect_reading(reading_share(request));
  bar.show(Stage::Read, 0);
  const Source source = read_source(request, curves, bar.callback());
  Job job = resolve(request, source);
  bar.expect_writing(writing_share(job), is_cad_output(request.output, request) ? "building the CAD model" : "writing");
  job.options.progress = bar.callback();
  if (of_batch) {
    if (source.scene && !source.scene->mesh_path.empty()) report_file_read(source.scene->mesh_path);
    for (const std::string& path : job.files_of_heights) report_file_read(path);
    if (source.file)
      for (const std::string& path : source.file->files_beside) report_file_read(path);
    job.options.reserve = wait_for_memory;
  }
  return run(job, {start, seconds_since(start)}, bar);
}

int fail(ExitCode code, const char* message) {
  report_problem(message);
  return code;
}

int run(int argc, char** argv) {
  if (is_check(argc, argv)) return run_check(argc, argv);
  if (is_view(argc, argv)) return run_view(argc, argv);
  if (is_batch(argc, argv)) return run_batch(argc, argv);
  const auto request = parse_command_line(argc, argv);
  return request ? explaining_presets(request->of_preset, [&] { return run(*request); }) : kDone;
}

int guarded(int argc, char** argv) {
  try {
    const int code = run(argc, argv);
    require_printed();
    return code;
  } catch (const UsageError& error) {
    return fail(kUsage, error.what());
  } catch (const InvalidOption& error) {
    return fail(kUsage, error.what());
  } catch (const InvalidInput& error) {
    return fail(kInput, error.what());
  } catch (const ReadError& error) {
    return fail(kInput, error.what());
  } catch (const WriteError& error) {
    return fail(kOutput, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kProcessing, "out of memory (see --max-memory and --voxel-size)");
  } catch (const std::exception& error) {
    return fail(kProcessing, error.what());
  }
}

}  // namespace
}  // namespace vdb_offset::tool

int main(int argc, char** argv) {
  vdb_offset::tool::catch_interrupts();
  return vdb_offset::tool::guarded(argc, argv);
}
