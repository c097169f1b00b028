// SPDX-License-Identifier: Apache-2.0
#include "layers/layers_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "layers/flow.h"
#include "messages.h"
#include "page/run_pages.h"
#include "summary/summary.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/fill.h"
#include "vdb_offset/io/filler.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/view_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/report.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

// How thick cells on curves are where they have to be solids, by the curves' size; it does not matter.
constexpr double kThickness = 0.1;

bool is_volume(const std::string& path) {
  return io::volume_format_of(path).has_value() || io::structured_format_of(path).has_value();
}

/// Layers and their cells. Cells are always measured; over a mesh, they are made only if they are written or filled up.
struct Grown {
  LayersResult layers;
  /// Of what they are layers, if that is the source with opened edges, or corners of curves.
  std::optional<Refinement> wall;
  std::optional<Curves> opened_curves;
  WallNames names;
  std::optional<MeasuredCells> cells;
  VolumeMesh on_curves;
  std::optional<VolumeMesh> filled;  ///< The layers' cells and those in the rest of the domain.
  LayerReport report;
  std::vector<float> scaled_jacobian;  ///< Of the cells, if a page shows them.

  /// The wall that layers were grown on.
  PolygonView mesh(const Source& source) const {
    return wall ? wall->polygons.view() : opened_curves ? opened_curves->view() : source.view();
  }
};

void measure_on_curves(CurvesView curves, Grown& grown, bool keep_quality) {
  CurveCells cells = make_curve_cells(curves, grown.layers);
  const LayerQuality quality = measure_curve_cells(cells, grown.layers);
  grown.report = report_layers(cells.segments.view(), grown.layers, {}, cells.facts, quality);
  if (keep_quality) grown.scaled_jacobian = quality.scaled_jacobian;
  grown.on_curves = std::move(cells.mesh);
}

void measure(const Source& source, Grown& grown, bool keep_quality) {
  if (source.file) grown.names = io::wall_names(*source.file);
  if (grown.wall) grown.names = names_of_pieces(std::move(grown.names), *grown.wall);
  const PolygonView mesh = grown.mesh(source);
  grown.cells.emplace(mesh, grown.layers);
  grown.report = report_layers(mesh, grown.layers, grown.names, grown.cells->facts(), grown.cells->quality());
  if (keep_quality) grown.scaled_jacobian = grown.cells->quality().scaled_jacobian;
}

/// Grows layers. `grown` must not be moved afterwards: its cells refer to its layers.
void grow(const Job& job, Grown& grown) {
  const Source& source = job.source;
  if (source.curves) {
    FannedCurveLayers fanned =
        grow_fanned_curve_layers(source.view(), job.distances, job.options, fan_angle_of(job.request));
    grown.opened_curves = std::move(fanned.wall);
    grown.layers = std::move(fanned.layers);
  } else {
    const bool foam = io::volume_format_of(job.request.output) == io::VolumeFormat::Foam;
    const CellRules rules = foam ? CellRules::OpenFoam : CellRules::AnySolver;
    FannedLayers fanned;
    if (job.request.periodic)
      fanned.layers = grow_periodic_layers(source.view(), job.distances, job.options, *job.request.periodic, rules);
    else fanned = grow_fanned_layers(source.view(), job.distances, job.options, fan_angle_of(job.request), rules);
    grown.wall = std::move(fanned.wall);
    grown.layers = std::move(fanned.layers);
  }
  const auto start = Clock::now();
  const bool keep_quality = !job.request.html.empty();
  if (source.curves) measure_on_curves(grown.mesh(source), grown, keep_quality);
  else measure(source, grown, keep_quality);
  grown.layers.statistics.seconds[static_cast<std::size_t>(Stage::Measure)] += seconds_since(start);
}

/// What each vertex of a file has, of those that it has copies of: in STL facets have vertices of their own.
std::vector<Vec3d> of_copies(std::span<const Vec3d> surface, std::span<const std::uint32_t> original) {
  std::vector<Vec3d> copies;
  copies.reserve(original.size());
  for (const std::uint32_t v : original) copies.push_back(surface[v]);
  return copies;
}

void write_surfaces(const Job& job, const Grown& grown) {
  const LayersResult& layers = grown.layers;
  std::optional<RefinedSource> opened;
  if (grown.wall) opened = refined_source(job.source, *grown.wall);
  const Source& source = opened ? opened->source : job.source;
  const auto target = opened && source.file ? io::target_of(job.request.output, *source.file,
                                                            write_options(job.request, job.request.output))
                                            : job.target;
  for (std::size_t k = 0; k < layers.count(); ++k) {
    const std::string& path = job.files.layers[k];
    std::vector<Vec3d> surface = layers.stacks.surface(k + 1);
    if (opened && !opened->vertex.empty()) surface = of_copies(surface, opened->vertex);
    if (source.curves) write_curves(path, source, surface, write_options(job.request, path));
    else if (source.file) report_losses(job.request, path, io::write_mesh(target->at(path), *source.file, surface));
    else io::write_mesh(target->at(path), source.view(), surface);
  }
}

FillOptions fill_options(const Job& job, PolygonView mesh, ProgressBar& bar) {
  const FillRequest& request = *job.request.fill;
  FillOptions options{
      .farfield = request.farfield, .growth = request.growth, .caps = request.caps, .progress = bar.callback()};
  if (job.source.farfield) options.farfield.surface = *job.source.farfield;
  if (request.longest)
    options.longest = request.longest->in_world_units(request.longest->percent ? used_diagonal(mesh) : 0);
  const auto format = io::volume_format_of(job.request.output);
  const bool holds_polyhedra = format != io::VolumeFormat::Msh && format != io::VolumeFormat::Su2;
  options.before = [&request = job.request](const VolumeMesh& bordered) { require_patches(request, bordered); };
  options.quads = request.quads.value_or(holds_polyhedra ? FillQuads::Split : FillQuads::Pyramids);
  return options;
}

void fill_cells(const Job& job, Grown& grown, const FillOptions& options) {
  FillReport& report = grown.report.fill.emplace();
  if (job.curves()) {
    grown.on_curves =
        fill_plane(make_curve_cells(grown.mesh(job.source), grown.layers), grown.layers, options, &report);
    return;
  }
  const FillRequest& request = *job.request.fill;
  const io::FillerLimits limits{request.seconds, job.request.max_memory, options.progress};
  const Filler filler = io::make_filler(request.with, limits);
  grown.filled = fill_volume(grown.mesh(job.source), grown.layers, grown.cells->facts(), grown.names,
                             std::move(*grown.cells).make(grown.names), options, filler, &report);
}

/// Fills the rest of the domain. Where that fails and the layers are to be written anyway, there is a warning.
void fill(const Job& job, Grown& grown, ProgressBar& bar) {
  const auto start = Clock::now();
  try {
    fill_cells(job, grown, fill_options(job, grown.mesh(job.source), bar));
  } catch (const FillFailed& failed) {
    grown.report.fill.reset();
    if (!job.request.fill->layers_anyway) throw;
    if (!job.request.quiet) report_problem(fmt::format("warning: {}; only the layers are written", failed.what()));
    // The cells' measures have gone with those that could not be filled up.
    if (grown.cells) grown.cells.emplace(grown.mesh(job.source), grown.layers);
  }
  grown.layers.statistics.seconds[static_cast<std::size_t>(Stage::Fill)] = seconds_since(start);
}

/// Cells on curves as a file has them: in their plane, or one cell thick, a tenth of the curves' size.
VolumeMesh cells_on_curves(const Job& job, Grown& grown) {
  const auto format = io::volume_format_of(job.request.output);
  if (format == io::VolumeFormat::Vtu || format == io::VolumeFormat::Su2) return std::move(grown.on_curves);
  return extruded(grown.on_curves, kThickness * used_diagonal(job.source.view()));
}

void write_volume(const Job& job, Grown& grown) {
  VolumeMesh mesh = job.curves()   ? cells_on_curves(job, grown)
                    : grown.filled ? std::move(*grown.filled)
                                   : std::move(*grown.cells).make(grown.names);
  require_patches(job.request, mesh);
  rename_patches(job.request, mesh);
  grown.report.boundary = patch_facts(mesh);
  write_case(job, mesh, job.curves() ? kThickness * used_diagonal(job.source.view()) : 0);
  const io::VolumeWriteResult written = io::write_volume(job.request.output, std::move(mesh));
  grown.report.foam = written.foam;
}

void write_block(const Job& job, Grown& grown) {
  const std::string& path = job.request.output;
  if (job.curves()) return io::write_structured(path, make_curve_block(job.source.view(), grown.layers));
  const StructuredBlock block = make_block(job.source.view(), grown.layers);
  grown.report.inverted_block_cells = inverted_cells(block);
  io::write_structured(path, block);
}

void write_cells(const Job& job, Grown& grown) {
  if (job.request.layers->structured) write_block(job, grown);
  else if (is_volume(job.request.output)) write_volume(job, grown);
  else write_surfaces(job, grown);
}

/// \throw InvalidInput where nothing grows, with what may be the reason
void require_cells(const Job& job, const Grown& grown) {
  if (!is_volume(job.request.output) || grown.report.all.cells > 0) return;
  std::vector<std::string> hints = side_hints(job, grown.layers.statistics.room);
  if (hints.empty()) hints.emplace_back("thinner layers have more room");
  throw InvalidInput(
      fmt::format("{}: expected room for one cell at least, got none ({})", job.request.input, fmt::join(hints, "; ")));
}

bool are_valid(const LayerReport& report) {
  return report.all.inverted_cells == 0 && report.inverted_block_cells == 0 &&
         (!report.foam || report.foam->wrong_faces == 0);
}

/// Whether what --strict asks for is met: every cell is valid, every vertex keeps all of its heights, and nothing is
/// nearer to an obstacle than asked.
bool is_as_asked(const Grown& grown) {
  const LayersResult& layers = grown.layers;
  if (layers.statistics.obstacles && layers.statistics.obstacles->near > 0) return false;
  return are_valid(grown.report) &&
         std::all_of(layers.states.begin(), layers.states.end(), [](VertexState state) { return !falls_short(state); });
}

/// Whether what --strict-faces asks for is met, by the outermost surface and by that at the first height.
bool are_faces_there(const Request& request, const LayersResult& layers) {
  if (!request.strict_faces) return true;
  const bool outermost = are_within(layers.statistics.faces, *request.strict_faces, request.output),
             first = are_within(layers.layer_statistics.first_faces, *request.strict_faces,
                                request.output + " at the first height");
  return outermost && first;
}

void write_report_and_page(const Job& job, const Grown& grown, const Timing& timing) {
  const Request& request = job.request;
  if (request.report.empty() && request.html.empty()) return;
  const std::string report = layers_report(job, grown.layers, grown.report, timing.start);
  if (!request.report.empty()) write_file(request.report, report);
  if (!request.html.empty()) {
    const bool opened = grown.wall || grown.opened_curves;
    const std::optional<PolygonView> wall = opened ? std::optional(grown.mesh(job.source)) : std::nullopt;
    write_page(job, wall, grown.layers, grown.names, grown.scaled_jacobian, report);
  }
}

}  // namespace

ExitCode run_layers(const Job& job, const Timing& timing, ProgressBar& bar) {
  const Request& request = job.request;
  const Source& source = job.source;
  const std::vector<Distances>& heights = job.distances;
  if (request.dry_run) {
    const auto outermost = std::span(heights).last(1);
    print_dry_run(job,
                  source.curves ? plan_curves(source.view(), outermost, job.options, heights.size())
                                : plan_several(source.view(), outermost, job.options, heights.size()),
                  heights.back());
    return kDone;
  }
  if (is_volume(request.output)) io::require_volume_writer(request.output);
  require_writable_files(job.files);
  Grown grown;
  // Not measured: it depends on how much there is to fill.
  constexpr double kGrowing = 0.3;
  if (request.fill) bar.expect_work_between(0, kGrowing);
  grow(job, grown);
  LayersResult& layers = grown.layers;
  require_cells(job, grown);
  if (request.fill) {
    bar.expect_work_between(kGrowing, 1);
    fill(job, grown, bar);
  }
  layers.statistics.seconds[static_cast<std::size_t>(Stage::Read)] = timing.read_seconds;
  const PolygonView mesh = grown.mesh(source);
  OutputFiles outputs(request.sync);
  outputs.report_to(bar.callback(), job.files.written.size());
  if (!request.states.empty())
    io::write_states(request.states, {layers.stacks.surface(layers.count()), mesh.corners, mesh.face_begin},
                     {layers.states, layers.achieved, layers.heights.back()}, {{}, &grown.names, job.curves()});
  const auto writing = Clock::now();
  write_cells(job, grown);
  layers.statistics.seconds[static_cast<std::size_t>(Stage::Write)] = seconds_since(writing);
  write_report_and_page(job, grown, timing);
  outputs.commit(ignore_interrupts);
  bar.show(Stage::Write, 1);
  bar.clear();
  if (!request.quiet) print_layers_summary(job, grown.layers, grown.report, seconds_since(timing.start));
  if (!are_faces_there(request, grown.layers)) return kProcessing;
  return is_as_asked(grown) || !request.strict ? kDone : kProcessing;
}

}  // namespace vdb_offset::tool
