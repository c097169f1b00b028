// SPDX-License-Identifier: Apache-2.0
#include "iso_command.h"

#include <fmt/format.h>

#include <optional>
#include <span>
#include <vector>

#include "summary/summary.h"
#include "vdb_offset/field.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

/// \throw Error for a surface that is not valid, of which no file is to be written.
void require_valid(const IsoStatistics& found) {
  if (found.valid()) return;
  throw Error(fmt::format(
      "iso-surface: expected a closed, manifold surface that does not cross itself, got {} border edges, {} "
      "non-manifold "
      "edges, {} pinched vertices, {} crossings and {} triangles without area on each of {} lattices (try another "
      "--voxel-size, or more digits)",
      found.border_edges, found.non_manifold_edges, found.pinched_vertices, found.mending.left.crossings,
      found.mending.left.needles, found.attempts));
}

/// \throw InvalidOption for options that --mode iso has not, and which a scene may have brought: the command line's own
/// are refused earlier.
void require_even(const Job& job) {
  for (const Distances& each : job.distances)
    if (!each.uniform())
      throw InvalidOption("--mode iso: expected one distance for the whole surface, got an uneven one");
  if (!job.options.only.empty() || job.options.obstacles.face_count() > 0)
    throw InvalidOption("--mode iso: expected the whole mesh and nothing else, got a part or obstacles");
}

IsoOptions options_of(const Job& job, const Distances& distance, const io::Transported& transported = {}) {
  const OffsetOptions& given = job.options;
  const IsoRequest& asked = *job.request.iso;
  IsoOptions options;
  options.distance = distance[0];
  options.grid = given.grid;
  options.adaptivity = asked.adaptivity;
  // Attributes that are transported may differ within flat parts, so that these are not merged unless asked for.
  const auto& [attributes, materials] = transported;
  if (!options.adaptivity && !(attributes.texture.empty() && attributes.colours.empty() && materials.of_face.empty()))
    options.adaptivity = 0;
  options.use_winding = asked.use_winding;
  options.off_source = job.shell;
  options.keep_specks = asked.keep_specks;
  options.precision = job.options.precision;
  options.weld = given.weld;
  options.orient = given.orient;
  options.threads = given.threads;
  options.max_memory = given.max_memory;
  options.bytes_held = given.bytes_held;
  options.progress = given.progress;
  options.reserve = given.reserve;
  return options;
}

io::Transported read_attributes_of(const Job& job) {
  const io::TransportRequest& transport = job.request.iso->transport;
  if (is_level_set_output(job.request.output, job.request)) {
    if (transport.is_required)
      throw InvalidOption("--transport: expected a mesh, as a level set has a place for nothing");
    return {};
  }
  if (job.source.file)
    return io::read_transported(*job.source.file, transport, *format_of(job.request.output, job.request));
  if (transport.is_required)
    throw InvalidOption("--transport: expected a mesh, as a scene's shape has nothing to take");
  return {};
}

/// Writes the surface as a level set, on voxels as large as is asked for, or as those of the source.
LevelSetFacts write_level_set(const Job& job, const Destination& to, const IsoResult& result) {
  const GridOptions& grid = job.options.grid;
  const double of_source = job.source.file ? job.source.file->voxel_size : 0,
               of_surface = result.statistics.plan.voxel_size;
  const bool is_asked = grid.voxel_size || grid.voxels_per_distance;
  const openvdb::FloatGrid::Ptr phi =
      make_level_set(result.polygons.view(), is_asked || of_source == 0 ? of_surface : of_source);
  save_grid(phi, to.mesh, run_metadata(job, to));
  return {phi->activeVoxelCount(), phi->voxelSize()[0]};
}

/// Returns the facts of the level set, if that is what is written.
std::optional<LevelSetFacts> write_iso_surface(const Job& job, const io::Transported& transported,
                                               const Destination& to, IsoResult& result, Clock::time_point start) {
  const auto writing = Clock::now();
  const std::optional<io::MeshFile>& file = job.source.file;
  std::optional<LevelSetFacts> level_set;
  if (!job.target) level_set = write_level_set(job, to, result);
  else if (file)
    report_losses(job.request, to.mesh, io::write_iso_surface(job.target->at(to.mesh), *file, transported, result));
  else io::write_iso_surface(job.target->at(to.mesh), result);
  result.statistics.seconds[static_cast<std::size_t>(Stage::Write)] = seconds_since(writing);
  if (!to.report.empty()) write_iso_report(job, to, result, start, {.level_set = level_set});
  return level_set;
}

IsoResult make_valid(const Job& job, const Distances& distance, const io::Transported& transported) {
  IsoResult result =
      make_iso_surface_in_metric(job.source.view(), options_of(job, distance, transported), job.options.metric);
  require_valid(result.statistics);
  return result;
}

void require_inside(const IsoResult& result) {
  if (!result.statistics.is_signed)
    throw InvalidInput("--shell with --mode iso: expected a mesh that has an inside, got an open one");
}

/// The mesh and the iso-surface, or two of these, as one solid.
Hollow hollow_of(const Job& job, double distance, const IsoResult& iso, const IsoResult* inner) {
  const PolygonView mesh = job.source.view(), skin = iso.polygons.view();
  if (inner) return make_hollow(skin, inner->polygons.view(), Hollow::Source::Neither);
  return distance < 0 ? make_hollow(mesh, skin, Hollow::Source::Outer, job.options.weld)
                      : make_hollow(skin, mesh, Hollow::Source::Inner, job.options.weld);
}

/// \throw Error for skins that meet, of which no file is to be written.
void require_apart(const Hollow& hollow, const IsoStatistics& found) {
  if (hollow.facts.crossings == 0) return;
  const bool is_buried = hollow.source != Hollow::Source::Neither && found.solid.buried + found.solid.cut > 0;
  throw Error(fmt::format("hollow: expected skins that do not meet, got {} pairs of triangles that do ({})",
                          hollow.facts.crossings,
                          is_buried ? "faces lie inside the solid, where they meet its cavity: with -d and --inner "
                                      "both skins are new"
                                    : "a --voxel-size of half the distance or less keeps them apart"));
}

void write_hollow(const Job& job, const Destination& to, const Hollow& hollow, IsoResult& iso, const IsoResult* inner,
                  Clock::time_point start) {
  const auto writing = Clock::now();
  const io::MeshFile* const file = job.source.file ? &*job.source.file : nullptr;
  report_losses(job.request, to.mesh, io::write_hollow(job.target->at(to.mesh), file, hollow, iso));
  iso.statistics.seconds[static_cast<std::size_t>(Stage::Write)] = seconds_since(writing);
  if (!to.report.empty()) write_iso_report(job, to, iso, start, {.hollow = &hollow, .inner = inner});
}

/// Whether what --strict-faces asks for is met by all surfaces.
bool are_faces_there(const Job& job, std::span<const IsoResult> results, const IsoResult* inner) {
  const std::optional<double> bound = job.request.strict_faces;
  if (!bound) return true;
  bool all = true;
  for (std::size_t i = 0; i < results.size(); ++i)
    all &= are_within(results[i].statistics.faces, *bound, job.files.outputs[i].mesh);
  if (inner) all &= are_within(inner->statistics.faces, *bound, "--inner");
  return all;
}

}  // namespace

ExitCode run_iso(const Job& job, const Timing& timing, ProgressBar& bar) {
  require_even(job);
  const PolygonView mesh = job.source.view();
  const std::vector<Destination>& destinations = job.files.outputs;
  if (job.request.dry_run) {
    for (std::size_t i = 0; i < destinations.size(); ++i)
      print_iso_dry_run(job, plan_iso_surface_in_metric(mesh, options_of(job, job.distances[i]), job.options.metric),
                        job.distances[i][0]);
    return kDone;
  }
  const io::Transported transported = read_attributes_of(job);
  std::vector<IsoResult> results;
  const auto make = [&](std::size_t i) {
    const auto count = static_cast<double>(job.distances.size()), number = static_cast<double>(i);
    bar.expect_work_between(number / count, (number + 1) / count);
    return make_valid(job, job.distances[i], transported);
  };
  for (std::size_t i = 0; i < destinations.size(); ++i) results.push_back(make(i));
  std::optional<IsoResult> inner;
  if (job.request.inner) inner = make(job.distances.size() - 1);
  if (job.shell) require_inside(results.front());
  const IsoResult* const inner_skin = inner ? &*inner : nullptr;
  OutputFiles outputs(job.request.sync);
  outputs.report_to(bar.callback(), job.files.written.size());
  std::optional<Hollow> hollow;  // for one distance alone
  std::vector<std::optional<LevelSetFacts>> level_sets(destinations.size());
  for (std::size_t i = 0; i < destinations.size(); ++i) {
    results[i].statistics.seconds[static_cast<std::size_t>(Stage::Read)] = timing.read_seconds;
    if (job.shell) hollow = hollow_of(job, job.distances[i][0], results[i], inner_skin);
    if (hollow) require_apart(*hollow, results[i].statistics);
    if (hollow) write_hollow(job, destinations[i], *hollow, results[i], inner_skin, timing.start);
    else level_sets[i] = write_iso_surface(job, transported, destinations[i], results[i], timing.start);
  }
  outputs.commit(ignore_interrupts);
  bar.show(Stage::Write, 1);
  bar.clear();
  for (std::size_t i = 0; i < destinations.size() && !job.request.quiet; ++i) {
    const double distance = job.distances[i][0], seconds = seconds_since(timing.start);
    const IsoProducts made{hollow ? &*hollow : nullptr, inner_skin, level_sets[i]};
    print_iso_summary(job, destinations[i].mesh, distance, results[i], made, seconds);
  }
  return are_faces_there(job, results, inner_skin) ? kDone : kProcessing;
}

}  // namespace vdb_offset::tool
