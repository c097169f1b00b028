#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "args.h"
#include "check_command.h"
#include "inputs.h"
#include "iso_command.h"
#include "layers_command.h"
#include "messages.h"
#include "outputs.h"
#include "places.h"
#include "summary.h"
#include "terminal.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/error.h"
#include "vdb_offset/fit.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/report.h"

namespace vdb_offset::tool {
namespace {

enum ExitCode { kDone = 0, kUsage = 1, kInput = 2, kProcessing = 3, kOutput = 4 };

std::vector<OffsetResult> fit_input(const Arguments& args, const Source& source) {
  std::vector<OffsetResult> results;
  results.push_back(fit(source.view(), source.to_fit->view(), args.options.clearance, args.options));
  return results;
}

/// Whether --strict can be content with a result. Says why, if not.
bool is_as_asked(const OffsetResult& result, bool of_curves) {
  const OffsetStatistics& statistics = result.statistics;
  const auto is_clear = [](std::size_t triangles, const char* what) {
    if (triangles > 0) tell(fmt::format("--strict: {} triangles are nearer to {} than asked", triangles, what));
    return triangles == 0;
  };
  if (statistics.fit) return is_clear(statistics.fit->near, "the mesh that they are to fit");
  if (statistics.obstacles && !is_clear(statistics.obstacles->near, "an obstacle")) return false;
  const double reached = summarise(result).share_reached;
  if (reached < 1)
    tell(fmt::format("--strict: {:.4f} % of the {} fall short of the distance", 100 * (1 - reached),
                     of_curves ? "points" : "vertices"));
  return reached == 1;
}

std::string in_words(const FaultCounts& counts) {
  std::vector<std::string> words;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) words.push_back(fmt::format("{} {}", count, what));
  };
  add(counts.inverted, "inverted faces");
  add(counts.collapsed, "collapsed faces");
  add(counts.crowded, "faces where they may not be");
  add(counts.crossings, "new pairs of triangles that meet");
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Names the outputs that are not valid, though they were to be. False if there are none.
bool tell_faults(const Arguments& args, std::span<const OffsetResult> results) {
  bool any = false;
  const std::vector<Destination> places = destinations(args);
  for (std::size_t i = 0; i < results.size(); ++i) {
    const FaultCounts& left = results[i].statistics.limit.left;
    if (left.total() == 0) continue;
    any = true;
    tell(fmt::format("{}: not valid: {} are left", i < places.size() ? places[i].mesh : "--inner", in_words(left)));
  }
  return any;
}

/// Exit code 3 if a result is not valid, or what a scene expects, or --strict, is not met.
int judge(const Arguments& args, const Source& source, std::span<const OffsetResult> results,
          const std::optional<ShellFacts>& shell) {
  std::vector<std::string> failed;
  if (source.scene) failed = scene::unmet(source.scene->expect, source.view(), results.front());
  if (source.scene && source.scene->expect.volume)
    for (std::string& expectation : scene::unmet(source.scene->expect, *shell))
      failed.push_back(std::move(expectation));
  for (const std::string& expectation : failed) tell(fmt::format("{}: {}", args.input, expectation));
  if (!failed.empty() || tell_faults(args, results)) return kProcessing;
  if (!args.strict) return kDone;
  return std::all_of(results.begin(), results.end(),
                     [&](const OffsetResult& result) { return is_as_asked(result, source.curves.has_value()); })
             ? kDone
             : kProcessing;
}

void require_places(const Arguments& args, std::span<const Destination> places) {
  for (const Destination& to : places)
    for (const std::string& path : {to.mesh, to.report, to.states, to.paths})
      if (!path.empty()) require_writable(path);
  if (!args.vdb.empty()) require_writable(args.vdb);
}

int run(Arguments args) {
  const auto start = Clock::now();
  tell_of_lost_input(args.input);
  std::optional<tbb::global_control> threads;  // reading and writing, too
  if (args.options.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(args.options.threads));
  ProgressBar bar(!args.quiet);
  args.options.progress = [&](Stage stage, double share) {
    bar.show(stage, share);
    return true;
  };
  require_apart(args);
  if (!args.dry_run && !args.layers) require_places(args, destinations(args));
  bar.show(Stage::Read, 0);
  Source source = read_source(args);
  if (source.scene) require_apart(args, 0, source.scene->mesh_path);
  if (args.layers) return run_layers(args, source, start, bar) || !args.strict ? kDone : kProcessing;
  if (args.iso) {
    run_iso(args, source, start, bar);
    return kDone;
  }
  const std::vector<Distances> distances = settle_options(source, args);
  require_apart(args);  // a scene has told of its distance by now
  const std::vector<Destination> places = destinations(args);
  const double read_seconds = seconds_since(start);
  if (args.dry_run) {
    print_dry_run(args,
                  source.curves ? plan_curves(source.view(), distances, args.options)
                                : plan_several(source.view(), distances, args.options),
                  distances.front());
    return kDone;
  }
  args.options.keep_field = !args.vdb.empty();
  args.options.keep_paths = !args.paths.empty();
  if (args.options.keep_field &&
      std::all_of(distances.begin(), distances.end(), [](const Distances& d) { return d.scale() == 0; }))
    throw UsageError("--save-vdb: expected a distance other than 0, for which there is a field");
  io::WriteOptions writing = args.write;
  writing.format = format_of(args.output, args);
  if (source.file) args.options.precision = io::precision_of(args.output, *source.file, writing);
  if (source.curves) args.options.precision = io::precision_of_curves(writing);
  std::vector<OffsetResult> results = source.to_fit   ? fit_input(args, source)
                                      : source.curves ? offset_curves(source.view(), distances, args.options)
                                                      : offset_several(source.view(), distances, args.options);
  bar.show(Stage::Write, 0);
  const OffsetResult* const inner = args.inner ? &results.back() : nullptr;
  std::vector<std::optional<ShellFacts>> shells;
  OutputFiles outputs(args.sync);
  for (std::size_t i = 0; i < places.size(); ++i) {
    results[i].statistics.seconds[static_cast<std::size_t>(Stage::Read)] = read_seconds;
    shells.push_back(write_outputs(args, source, {places[i], results[i], inner}, start));
  }
  outputs.commit(ignore_interrupts);
  bar.clear();
  for (std::size_t i = 0; i < places.size() && !args.quiet; ++i)
    print_summary(args, source, {places[i], results[i], inner}, shells[i], seconds_since(start));
  return judge(args, source, results, shells.back());
}

int fail(ExitCode code, const char* message) {
  tell(message);
  return code;
}

int run(int argc, char** argv) {
  if (is_check(argc, argv)) return run_check(argc, argv);
  auto args = parse_arguments(argc, argv);
  return args ? run(std::move(*args)) : kDone;
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
