// SPDX-License-Identifier: Apache-2.0
// Makes a job of a request: settles what depends on the mesh or the scene.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "distances/evaluate.h"
#include "distances/heights.h"
#include "distances/part_distances.h"
#include "job.h"
#include "request/option_values.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

OffsetOptions options_of(const Request& request) {
  OffsetOptions options;
  options.grid = request.grid;
  options.symmetry = request.symmetry;
  options.weld = request.weld;
  options.orient = request.orient;
  options.threads = request.threads;
  options.max_memory = request.max_memory;
  options.keep_field = !request.vdb.empty() && !request.dry_run;
  const bool shows_faces = request.states.ends_with(".vtp") || !request.html.empty();
  options.keep_face_errors = shows_faces && !request.dry_run && !request.tolerance;
  options.keep_paths = !request.paths.empty() && !request.dry_run;
  return options;
}

/// Takes a scene's mesh to fit, which replaces a distance, and refuses the options that the command line may not have
/// then.
void settle_fit_of_scene(Job& job) {
  const Request& request = job.request;
  for (const auto& [name, given] : {std::pair{"--mode iso", request.iso.has_value()},
                                    {"--shell", job.shell},
                                    {"--obstacle", job.source.obstacles.face_count() > 0},
                                    {"--collision", request.collision.has_value()},
                                    {"--corners", request.corners.has_value()},
                                    {"--taper", request.taper.has_value()},
                                    {"--save-vdb", !request.vdb.empty()}})
    if (given) throw InvalidOption(fmt::format("{}: expected a scene without a fit, or a --distance", name));
  job.to_fit = job.source.scene->to_fit.view();
  job.options.corners = Corners::Miter;  // as fits have
  job.asked.push_back({"fit", {}, {}});
}

void settle_scene(Job& job) {
  const scene::Scene& scene = *job.source.scene;
  const GridOptions given = job.options.grid;
  scene.set(job.options);
  if (given.voxel_size || given.voxels_per_distance) job.options.grid = given;
  if (!job.request.layers && !job.request.iso) job.shell = job.shell || scene.shell;
  // A scene's expectations hold for its own distance alone.
  if (job.request.layers || !job.asked.empty()) return;
  job.expect = scene.expect;
  if (scene.to_fit.face_count() > 0) return settle_fit_of_scene(job);
  const GivenDistance& own = scene.distance;
  job.asked.push_back(
      {own.expression ? own.expression->text() : fmt::format("{}{}", own.value, own.percent ? "%" : ""), own, {}});
}

double clearance_of(const Job& job) {
  const GivenDistance& clearance = job.request.clearance;
  return clearance.in_world_units(clearance.percent ? used_diagonal(job.source.view()) : 0);
}

void settle_surroundings(Job& job) {
  const Request& request = job.request;
  const Source& source = job.source;
  OffsetOptions& options = job.options;
  if (!request.only.empty()) options.only = io::select_faces(*source.file, request.only);
  if (request.border) options.border = *request.border;
  options.off_source = job.shell;
  options.inner_skin_last = request.inner.has_value();
  if (source.to_fit) {
    if (source.obstacles.face_count() > 0 || options.obstacles.face_count() > 0 || job.shell)
      throw InvalidOption("--fit: expected a scene without an obstacle or a shell");
    job.to_fit = source.to_fit->view();
    options.corners = Corners::Miter;  // as fits have
    options.clearance = clearance_of(job);
  }
  if (source.obstacles.face_count() == 0) return;
  options.obstacles = source.obstacles.view();
  options.clearance = clearance_of(job);
}

/// The distances of all outputs, then those of the inner skin.
std::vector<Distances> distances_of(Job& job) {
  const Request& request = job.request;
  if (request.axes) {
    if (job.options.obstacles.face_count() > 0 || job.shell)
      throw InvalidOption("--distance-xy: expected a scene without an obstacle or a shell");
    const auto [metric, distance] = settle_axes(*request.axes, job.source.view());
    job.options.metric = metric;
    return {distance};
  }
  std::vector<Distances> distances;
  if (request.blend.value > 0 && std::none_of(job.asked.begin(), job.asked.end(),
                                              [&](const DistanceRequest& each) { return are_of_parts(job, each); }))
    throw InvalidOption("--blend: expected --distance-of, or a CAD model and a distance in u and v");
  for (const DistanceRequest& each : job.asked)
    distances.push_back(are_of_parts(job, each) ? distances_of_parts(job, each) : evaluate(job, each));
  // Where faces are split, their corners are others.
  if (request.tolerance)
    for (Distances& each : distances) each = each.of_vertices();
  if (!request.inner) return distances;
  for (const Distances& outer : distances)
    if (outer.inward() > 0)
      throw InvalidInput("--distance: expected distances of 0 or more at all vertices with --inner");
  distances.push_back(scaled(evaluate(job, *request.inner), -1));
  if (distances.back().outward() > 0) throw InvalidInput("--inner: expected distances of 0 or more at all vertices");
  return distances;
}

/// Has distances go to the side that a point is on.
void turn_to_side(Job& job) {
  if (job.curves()) throw InvalidOption("--side-of: expected a mesh, got curves");
  for (const Distances& each : job.distances)
    if (each.inward() > 0)
      throw InvalidOption("--side-of: expected distances of 0 or more, as the point says their sign");
  if (side_of_point(job.source.view(), *job.request.side_of, job.options.weld, job.options.orient) > 0) return;
  for (Distances& each : job.distances) each = scaled(each, -1);
}

/// The meshes that are written, but for their names.
std::optional<io::Target> target_of(const Job& job) {
  const Request& request = job.request;
  const bool cells =
      request.layers && (io::volume_format_of(request.output) || io::structured_format_of(request.output));
  if (cells || job.curves() || is_cad_output(request.output, request) || is_level_set_output(request.output, request))
    return std::nullopt;
  const io::WriteOptions writing = write_options(request, request.output);
  if (request.iso || !job.source.file) return io::target_of(request.output, writing);
  const io::Faces faces = job.shell ? io::Faces::Shell : request.tolerance ? io::Faces::Pieces : io::Faces::Same;
  return io::target_of(request.output, *job.source.file, writing, faces);
}

// Bytes for each byte of a file: its text, what is noted of it to write it again, and the text written; and for that of
// a shell, which has two skins. Measured.
constexpr double kBytesOfFileByte = 4.2, kShellBytesOfFileByte = 5.5;
// Bytes for each cell while a folder of OpenFOAM's is made, with the faces between cells, or a CGNS file. Measured.
constexpr std::size_t kFoamCellBytes = 66, kCgnsCellBytes = 30;

/// What the command holds beside the offset itself.
std::size_t bytes_held(const Job& job) {
  const std::size_t size = job.source.file ? job.source.file->text().size() : 0;
  const auto of_file =
      static_cast<std::size_t>((job.shell ? kShellBytesOfFileByte : kBytesOfFileByte) * static_cast<double>(size));
  if (!job.request.layers || job.curves()) return of_file;
  const auto format = io::volume_format_of(job.request.output);
  const std::size_t of_cell = format == io::VolumeFormat::Foam   ? kFoamCellBytes
                              : format == io::VolumeFormat::Cgns ? kCgnsCellBytes
                                                                 : 0;
  return of_file + of_cell * job.distances.size() * job.source.view().face_count();
}

}  // namespace

Job resolve_options(const Request& request, const Source& source) {
  Job job{.request = request,
          .source = source,
          .options = options_of(request),
          .shell = request.shell,
          .asked = request.distances};
  if (source.scene) settle_scene(job);
  // With a tolerance faces are split, and fitting goes by rounds of distances: both by the triangles alone.
  if (is_cad_output(request.output, request) && !(source.file && io::is_cad(source.file->format)))
    throw InvalidInput(request.output + ": expected an input that is a CAD model, for an output that is one, got " +
                       request.input);
  if (source.file && !request.tolerance && request.fit.empty()) job.options.exact = source.file->exact.get();
  if (source.file && source.file->has_touching_objects && request.weld_text == "auto") job.options.weld.enabled = false;
  if (request.solver) job.options.solver = *request.solver;
  if (request.collision) job.options.collision = *request.collision;
  if (request.corners) job.options.corners = *request.corners;
  if (request.miter_limit) job.options.miter_limit = *request.miter_limit;
  if (request.taper) job.options.taper = *request.taper;
  if (request.miter_limit && job.corners() != Corners::Miter)
    throw InvalidOption("--miter-limit needs --corners miter, and the scene has round corners");
  settle_surroundings(job);
  if (!request.layers) job.distances = distances_of(job);
  else job.distances = heights_of_layers(job);
  if (request.side_of) turn_to_side(job);
  job.options.bytes_held = bytes_held(job);
  return job;
}

Precision precision_of_refined(const Job& job) {
  const std::string& path = job.request.tolerance->refined_source;
  io::WriteOptions all_digits;
  if (!path.empty()) all_digits.format = format_of(path, job.request);
  if (!job.source.file) return path.empty() ? Precision{} : io::target_of(path, all_digits).precision;
  const io::MeshFile& file = *job.source.file;
  // A document whose faces are split becomes a file that keeps all digits (io/derived_file.h).
  const bool is_double = !io::has_rows(file) || file.precision.kind == Precision::Kind::Double;
  if (is_double && !path.empty()) return io::target_of(path, file, all_digits, io::Faces::Pieces).precision;
  return io::has_rows(file) ? file.precision : Precision{};
}

Job resolve(const Request& request, const Source& source) {
  Job job = resolve_options(request, source);
  if (request.tolerance && (job.shell || job.to_fit))
    throw InvalidOption("--tolerance: expected a scene without a shell or a fit");
  job.target = target_of(job);
  if (job.target) job.options.precision = job.target->precision;
  else if (job.curves())
    job.options.precision =
        io::precision_of_curves(request.output, *source.curves, write_options(request, request.output));
  job.files = plan_files(job);
  return job;
}

}  // namespace vdb_offset::tool
