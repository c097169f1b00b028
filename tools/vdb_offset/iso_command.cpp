#include "iso_command.h"

#include <algorithm>

#include "summary.h"
#include "vdb_offset/capture.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/captured_file.h"

namespace vdb_offset::tool {
namespace {

/// A scene may bring what the command line could not ask for.
void require_even(const Arguments& args, std::span<const Distances> distances) {
  for (const Distances& each : distances)
    if (!each.uniform())
      throw InvalidOption("--mode iso: expected one distance for the whole surface, got an uneven one");
  if (!args.options.only.empty() || args.options.obstacles.face_count() > 0)
    throw InvalidOption("--mode iso: expected the whole mesh and nothing else, got a part or obstacles");
}

CaptureOptions options_of(const Arguments& args, const Distances& distance, const std::string& path) {
  const OffsetOptions& given = args.options;
  CaptureOptions options;
  options.distance = distance[0];
  options.grid = given.grid;
  options.adaptivity = args.iso->adaptivity;
  io::WriteOptions writing = args.write;
  writing.format = format_of(path, args);
  options.precision = io::precision_of_captured(path, writing);
  options.weld = given.weld;
  options.orient = given.orient;
  options.threads = given.threads;
  options.max_memory = given.max_memory;
  options.progress = given.progress;
  return options;
}

io::Transported read_attributes_of(const Arguments& args, const Source& source) {
  const io::TransportRequest& request = args.iso->transport;
  if (source.file) return io::read_transported(*source.file, request, *format_of(args.output, args));
  if (request.is_required) throw InvalidOption("--transport: expected a mesh, as a scene's shape has nothing to take");
  return {};
}

void write_captured(const Arguments& args, const Source& source, const io::Transported& transported,
                    const Destination& to, CaptureResult& result, Clock::time_point start) {
  const auto writing = Clock::now();
  io::WriteOptions options = args.write;
  options.format = format_of(to.mesh, args);
  options.before_rename = [&] {
    result.statistics.seconds[static_cast<std::size_t>(Stage::Write)] = seconds_since(writing);
    if (!to.report.empty()) write_iso_report(args, to, result, start);
  };
  if (source.file) tell_losses(args, to.mesh, io::write_captured(to.mesh, *source.file, transported, result, options));
  else io::write_captured(to.mesh, result, options);
}

}  // namespace

bool run_iso(Arguments& args, Source& source, Clock::time_point start, ProgressBar& bar) {
  const std::vector<Distances> distances = settle_options(source, args);
  require_even(args, distances);
  const std::vector<Destination> places = destinations(args);
  const double read_seconds = seconds_since(start);
  if (args.dry_run) {
    for (std::size_t i = 0; i < places.size(); ++i)
      print_iso_dry_run(args, plan_capture(source.view(), options_of(args, distances[i], places[i].mesh)),
                        distances[i][0]);
    return true;
  }
  const io::Transported transported = read_attributes_of(args, source);
  std::vector<CaptureResult> results;
  for (std::size_t i = 0; i < places.size(); ++i)
    results.push_back(capture(source.view(), options_of(args, distances[i], places[i].mesh)));
  bar.show(Stage::Write, 0);
  if (interrupted()) throw Cancelled();
  for (std::size_t i = 0; i < places.size(); ++i) {
    results[i].statistics.seconds[static_cast<std::size_t>(Stage::Read)] = read_seconds;
    write_captured(args, source, transported, places[i], results[i], start);
    bar.clear();
    if (!args.quiet) print_iso_summary(args, places[i].mesh, distances[i][0], results[i], seconds_since(start));
  }
  return std::all_of(results.begin(), results.end(), [](const CaptureResult& r) { return r.statistics.valid(); });
}

}  // namespace vdb_offset::tool
