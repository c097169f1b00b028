#include "layers_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "places.h"
#include "summary.h"
#include "vdb_offset/curve_cells.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/states_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/io/wall_names.h"
#include "vdb_offset/layer_cells.h"
#include "vdb_offset/layer_report.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/report.h"
#include "vdb_offset/structured_block.h"

namespace vdb_offset::tool {
namespace {

bool is_volume(const std::string& path) {
  return io::volume_format_of(path).has_value() || io::structured_format_of(path).has_value();
}

/// Cells are measured whatever is written; those over a mesh are made if they are.
struct Grown {
  LayersResult layers;
  WallNames names;
  std::optional<MeasuredCells> cells;
  VolumeMesh on_curves;
  LayerReport report;
};

void measure_on_curves(CurvesView curves, Grown& grown) {
  CurveCells cells = make_curve_cells(curves, grown.layers);
  grown.report =
      report_layers(cells.segments.view(), grown.layers, {}, cells.facts, measure_curve_cells(cells, grown.layers));
  grown.on_curves = std::move(cells.mesh);
}

void measure(const Source& source, Grown& grown) {
  if (source.file) grown.names = io::wall_names(*source.file);
  grown.cells.emplace(source.view(), grown.layers);
  grown.report = report_layers(source.view(), grown.layers, grown.names, grown.cells->facts(), grown.cells->quality());
}

/// Into an object that stays where it is, as what is measured refers to its layers.
void grow(const Arguments& args, const Source& source, std::span<const Distances> heights, Grown& grown) {
  if (source.curves) {
    grown.layers = grow_curve_layers(source.view(), heights, args.options);
  } else {
    const bool foam = io::volume_format_of(args.output) == io::VolumeFormat::Foam;
    grown.layers = grow_layers(source.view(), heights, args.options, foam ? CellRules::OpenFoam : CellRules::AnySolver);
  }
  const auto start = Clock::now();
  if (source.curves) measure_on_curves(source.view(), grown);
  else measure(source, grown);
  grown.layers.statistics.seconds[static_cast<std::size_t>(Stage::Measure)] += seconds_since(start);
}

void write_surfaces(const Arguments& args, const Source& source, const LayersResult& layers) {
  for (std::size_t k = 0; k < layers.count(); ++k) {
    const std::string path = name_of_layer(args.output, k + 1, layers.count());
    io::WriteOptions options = args.write;
    const std::vector<Vec3d> surface = layers.stacks.surface(k + 1);
    if (source.curves) {
      write_curves(path, source, surface, options);
      continue;
    }
    options.format = format_of(path, args);
    if (source.file) {
      tell_losses(args, path, io::write_mesh(path, *source.file, surface, options));
      continue;
    }
    const PolygonView mesh = source.view();
    io::write_mesh(path, PolygonView{surface, mesh.corners, mesh.face_begin}, options);
  }
}

void write_volume(const Arguments& args, const Source& source, Grown& grown) {
  const io::VolumeWriteResult written = io::write_volume(
      args.output, source.curves ? std::move(grown.on_curves) : std::move(*grown.cells).make(grown.names));
  grown.report.foam = written.foam;
}

void write_block(const Arguments& args, const Source& source, Grown& grown) {
  if (source.curves) return io::write_structured(args.output, make_curve_block(source.view(), grown.layers));
  const StructuredBlock block = make_block(source.view(), grown.layers);
  grown.report.inverted_block_cells = inverted_cells(block);
  io::write_structured(args.output, block);
}

void write_cells(const Arguments& args, const Source& source, Grown& grown) {
  if (args.layers->structured) write_block(args, source, grown);
  else if (is_volume(args.output)) write_volume(args, source, grown);
  else write_surfaces(args, source, grown.layers);
}

bool are_valid(const LayerReport& report) {
  return report.all.inverted_cells == 0 && report.inverted_block_cells == 0 &&
         (!report.foam || report.foam->wrong_faces == 0);
}

void require_names(const Arguments& args, std::size_t layers) {
  for (const std::string& path : {args.report, args.states})
    if (!path.empty()) require_writable(path);
  if (is_volume(args.output)) {
    if (io::volume_format_of(args.output) != io::VolumeFormat::Foam) require_writable(args.output);
    return;
  }
  for (std::size_t k = 1; k <= layers; ++k) require_writable(name_of_layer(args.output, k, layers));
}

}  // namespace

bool run_layers(Arguments& args, Source& source, Clock::time_point start, ProgressBar& bar) {
  const std::vector<Distances> heights = settle_layers(source, args);
  require_apart(args, heights.size());
  const double read_seconds = seconds_since(start);
  if (args.dry_run) {
    const auto outermost = std::span(heights).last(1);
    print_dry_run(args,
                  source.curves ? plan_curves(source.view(), outermost, args.options, heights.size())
                                : plan_several(source.view(), outermost, args.options, heights.size()),
                  heights.back());
    return true;
  }
  require_names(args, heights.size());
  if (source.file && !is_volume(args.output))
    args.options.precision = io::precision_of(name_of_layer(args.output, 1, heights.size()), *source.file, args.write);
  if (source.curves && !is_volume(args.output)) args.options.precision = io::precision_of_curves(args.write);
  Grown grown;
  grow(args, source, heights, grown);
  LayersResult& layers = grown.layers;
  bar.show(Stage::Write, 0);
  layers.statistics.seconds[static_cast<std::size_t>(Stage::Read)] = read_seconds;
  const PolygonView mesh = source.view();
  OutputFiles outputs(args.sync);
  if (!args.states.empty())
    io::write_states(args.states, {layers.stacks.surface(layers.count()), mesh.corners, mesh.face_begin},
                     {layers.states, layers.achieved, layers.heights.back()});
  const auto writing = Clock::now();
  write_cells(args, source, grown);
  layers.statistics.seconds[static_cast<std::size_t>(Stage::Write)] = seconds_since(writing);
  if (!args.report.empty()) write_layers_report(args, grown.layers, grown.report, start);
  outputs.commit(ignore_interrupts);
  bar.clear();
  if (!args.quiet) print_layers_summary(args, source, grown.layers, grown.report, seconds_since(start));
  if (layers.statistics.obstacles && layers.statistics.obstacles->near > 0) return false;
  return are_valid(grown.report) && std::all_of(layers.states.begin(), layers.states.end(), [](VertexState state) {
           return state == VertexState::Reached || state == VertexState::Unused;
         });
}

}  // namespace vdb_offset::tool
