// SPDX-License-Identifier: Apache-2.0
// What the page of a run shows, for each kind of run.
#include "page/run_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>

#include "messages.h"
#include "request/units.h"
#include "summary/summary.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/view_file.h"
#include "vdb_offset/report.h"

namespace vdb_offset::tool {
namespace {

io::PageSurface surface_of(const std::string& name, const OffsetResult& result) {
  io::PageSurface surface;
  surface.name = name;
  surface.position = [&result](std::size_t v) { return result.positions[v]; };
  surface.states = result.states;
  surface.achieved = result.achieved;
  surface.target = &result.distances;
  surface.face_errors = result.face_errors;
  surface.face_faults = result.face_faults;
  return surface;
}

/// Says that faults are left, of which the library knows the number alone: between layers, of curves, and of rims.
void add_faults(const FaultCounts& left, std::vector<std::string>& remarks) {
  if (left.total() > 0)
    remarks.push_back(fmt::format(
        "{} faults are left in the result; the page does not show where (vdb_offset check counts them)", left.total()));
}

std::string name_of(const std::string& path) { return std::filesystem::path(path).filename().string(); }

io::Page page_of(const Request& request, const Source& source, const std::string& report) {
  io::Page page;
  page.title = name_of(request.input);
  page.command = request.command;
  page.report = report;
  page.source = source.view();
  page.are_curves = source.curves.has_value();
  const std::optional<double> of_file = source.file     ? source.file->unit_micrometres
                                        : source.curves ? source.curves->file.unit_micrometres
                                                        : micrometres_of(request.unit);
  if (of_file) page.unit = name_of_unit(*of_file);
  if (source.file && (source.file->format == io::Format::Glb || source.file->format == io::Format::Gltf)) page.up = 1;
  return page;
}

WallNames groups_of(const Source& source) { return source.file ? io::wall_names(*source.file) : WallNames{}; }

}  // namespace

std::string as_typed(int argc, const char* const* argv) {
  std::string text = "vdb_offset";
  for (int i = 1; i < argc; ++i) text.append(1, ' ').append(shell_word(argv[i]));
  return text;
}

void write_page(const Job& job, const Outcome& outcome, const std::string& report) {
  io::Page page = page_of(job.request, job.source, report);
  const WallNames groups = groups_of(job.source);
  page.groups = &groups;
  if (outcome.inner) page.surfaces.push_back(surface_of("inner skin", *outcome.inner));
  page.surfaces.push_back(surface_of(outcome.inner ? "outer skin" : "offset", outcome.result));
  if (job.shell)
    page.remarks.emplace_back(outcome.inner ? "The solid's skins are shown as surfaces, without its rim."
                                            : "The solid's skins are the source and the offset; its rim is not shown.");
  if (outcome.result.face_faults.empty()) add_faults(outcome.result.statistics.limit.left, page.remarks);
  io::write_page(outcome.to.html, page);
}

void write_page(const Request& made, const Source& source) {
  io::Page page = page_of(made, source, "");
  const WallNames groups = groups_of(source);
  page.groups = &groups;
  io::write_page(made.html, page);
}

void write_page(const Request& made, const Source& source, PolygonView result, const std::string& remark) {
  io::Page page = page_of(made, source, "");
  const WallNames groups = groups_of(source);
  page.groups = &groups;
  page.remarks.push_back(remark);
  io::PageSurface surface;
  surface.name = name_of(made.output);
  surface.own = result;
  page.surfaces.push_back(surface);
  io::write_page(made.html, page);
}

void write_page(const Request& made, const Source& source, std::span<const Vec3d> positions, const CheckResult& result,
                const io::ResultFaces& faces) {
  io::Page page = page_of(
      made, source,
      check_json(result, made.input, made.output, summary_of(made, result, source.curves.has_value()).for_report()));
  page.title = name_of(made.output);
  page.groups = faces.groups;
  io::PageSurface surface;
  surface.name = "offset";
  surface.position = [positions](std::size_t v) { return positions[v]; };
  surface.states = result.states;
  surface.achieved = result.achieved;
  surface.target = &result.distances;
  surface.face_errors = result.face_errors;
  surface.face_faults = result.face_faults;
  page.surfaces.push_back(surface);
  if (result.face_faults.empty()) add_faults(result.faults, page.remarks);
  io::write_page(made.html, page);
}

void write_page(const Job& job, std::optional<PolygonView> wall, const LayersResult& layers, const WallNames& names,
                std::span<const float> quality, const std::string& report) {
  io::Page page = page_of(job.request, job.source, report);
  if (wall) page.source = *wall;
  page.are_layers = true;
  page.groups = &names;
  page.cell_quality = quality;
  for (std::size_t k = 1; k <= layers.count(); ++k) {
    io::PageSurface surface;
    surface.name = fmt::format("layer {}", k);
    surface.position = [&layers, k](std::size_t v) { return layers.stacks.of(v)[k]; };
    surface.states = layers.states;
    surface.target = &layers.heights[k - 1];
    surface.share = layers.share;
    if (k == layers.count()) surface.achieved = layers.achieved;
    else if (k == 1) surface.achieved = layers.first_achieved;
    page.surfaces.push_back(surface);
  }
  if (layers.count() > 2)
    page.remarks.emplace_back(
        "Distances are measured of the first and the outermost surface; of those between, the page shows what share of "
        "its heights a vertex keeps.");
  page.remarks.emplace_back("States are those of the outermost surface.");
  add_faults(layers.statistics.limit.left, page.remarks);
  io::write_page(job.request.html, page);
}

}  // namespace vdb_offset::tool
