#include "iso_command.h"

#include <fmt/format.h>

#include <optional>

#include "places.h"
#include "summary.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/iso_file.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::tool {
namespace {

/// No file is written of what is not what it is said to be.
void require_valid(const IsoStatistics& found) {
  if (found.valid()) return;
  throw Error(fmt::format(
      "capture: expected a closed, manifold surface that does not cross itself, got {} border edges, {} non-manifold "
      "edges, {} pinched vertices, {} crossings and {} triangles without area on each of {} lattices (try another "
      "--voxel-size, or more digits)",
      found.border_edges, found.non_manifold_edges, found.pinched_vertices, found.mending.left.crossings,
      found.mending.left.needles, found.attempts));
}

/// A scene may bring what the command line could not ask for.
void require_even(const Arguments& args, std::span<const Distances> distances) {
  for (const Distances& each : distances)
    if (!each.uniform())
      throw InvalidOption("--mode iso: expected one distance for the whole surface, got an uneven one");
  if (!args.options.only.empty() || args.options.obstacles.face_count() > 0)
    throw InvalidOption("--mode iso: expected the whole mesh and nothing else, got a part or obstacles");
}

IsoOptions options_of(const Arguments& args, const Distances& distance, const std::string& path,
                      const io::Transported& transported = {}) {
  const OffsetOptions& given = args.options;
  IsoOptions options;
  options.distance = distance[0];
  options.grid = given.grid;
  options.adaptivity = args.iso->adaptivity;
  // What comes along differs within what is flat.
  const auto& [attributes, materials] = transported;
  if (!options.adaptivity && !(attributes.texture.empty() && attributes.colours.empty() && materials.of_face.empty()))
    options.adaptivity = 0;
  options.use_winding = args.iso->use_winding;
  options.keep_specks = args.iso->keep_specks;
  io::WriteOptions writing = args.write;
  writing.format = format_of(path, args);
  options.precision = io::precision_of_iso(path, writing);
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

void write_iso_surface(const Arguments& args, const Source& source, const io::Transported& transported,
                       const Destination& to, IsoResult& result, Clock::time_point start) {
  const auto writing = Clock::now();
  io::WriteOptions options = args.write;
  options.format = format_of(to.mesh, args);
  if (source.file)
    tell_losses(args, to.mesh, io::write_iso_surface(to.mesh, *source.file, transported, result, options));
  else io::write_iso_surface(to.mesh, result, options);
  result.statistics.seconds[static_cast<std::size_t>(Stage::Write)] = seconds_since(writing);
  if (!to.report.empty()) write_iso_report(args, to, result, start);
}

IsoResult capture_valid(const Arguments& args, const Source& source, const Distances& distance, const std::string& path,
                        const io::Transported& transported) {
  IsoResult result =
      make_iso_surface_in_metric(source.view(), options_of(args, distance, path, transported), args.options.metric);
  require_valid(result.statistics);
  return result;
}

void require_inside(const IsoResult& result) {
  if (!result.statistics.is_signed)
    throw InvalidInput("--shell with --mode iso: expected a mesh that has an inside, got an open one");
}

/// The mesh and the captured surface, or two of these, as one solid.
Hollow hollow_of(const Source& source, double distance, const IsoResult& captured, const IsoResult* inner) {
  const PolygonView mesh = source.view(), skin = captured.polygons.view();
  if (inner) return make_hollow(skin, inner->polygons.view(), Hollow::Source::Neither);
  return distance < 0 ? make_hollow(mesh, skin, Hollow::Source::Outer) : make_hollow(skin, mesh, Hollow::Source::Inner);
}

void write_hollow(const Arguments& args, const Source& source, const Destination& to, const Hollow& hollow,
                  IsoResult& captured, const IsoResult* inner, Clock::time_point start) {
  const auto writing = Clock::now();
  io::WriteOptions options = args.write;
  options.format = format_of(to.mesh, args);
  const io::MeshFile* const file = source.file ? &*source.file : nullptr;
  tell_losses(args, to.mesh, io::write_hollow(to.mesh, file, hollow, captured, options));
  captured.statistics.seconds[static_cast<std::size_t>(Stage::Write)] = seconds_since(writing);
  if (!to.report.empty()) write_iso_report(args, to, captured, start, &hollow.facts, inner);
}

}  // namespace

void run_iso(Arguments& args, Source& source, Clock::time_point start, ProgressBar& bar) {
  const std::vector<Distances> distances = settle_options(source, args);
  require_even(args, distances);
  require_apart(args);
  const std::vector<Destination> places = destinations(args);
  const double read_seconds = seconds_since(start);
  if (args.dry_run) {
    for (std::size_t i = 0; i < places.size(); ++i)
      print_iso_dry_run(args,
                        plan_iso_surface_in_metric(source.view(), options_of(args, distances[i], places[i].mesh),
                                                   args.options.metric),
                        distances[i][0]);
    return;
  }
  const io::Transported transported = read_attributes_of(args, source);
  std::vector<IsoResult> results;
  for (std::size_t i = 0; i < places.size(); ++i)
    results.push_back(capture_valid(args, source, distances[i], places[i].mesh, transported));
  std::optional<IsoResult> inner;
  if (args.inner) inner = capture_valid(args, source, distances.back(), places.front().mesh, transported);
  if (args.shell) require_inside(results.front());
  bar.show(Stage::Write, 0);
  const IsoResult* const inner_skin = inner ? &*inner : nullptr;
  OutputFiles outputs(args.sync);
  std::optional<Hollow> hollow;  // of one distance
  for (std::size_t i = 0; i < places.size(); ++i) {
    results[i].statistics.seconds[static_cast<std::size_t>(Stage::Read)] = read_seconds;
    if (args.shell) hollow = hollow_of(source, distances[i][0], results[i], inner_skin);
    if (hollow) write_hollow(args, source, places[i], *hollow, results[i], inner_skin, start);
    else write_iso_surface(args, source, transported, places[i], results[i], start);
  }
  outputs.commit(ignore_interrupts);
  bar.clear();
  for (std::size_t i = 0; i < places.size() && !args.quiet; ++i) {
    const double distance = distances[i][0];
    if (hollow)
      print_hollow_summary(args, places[i].mesh, distance, *hollow, results[i], inner_skin, seconds_since(start));
    else print_iso_summary(args, places[i].mesh, distance, results[i], seconds_since(start));
  }
}

}  // namespace vdb_offset::tool
