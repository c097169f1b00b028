// SPDX-License-Identifier: Apache-2.0
// Makes a job of a request: settles what depends on the mesh or the scene.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "job.h"
#include "outputs.h"
#include "request/option_values.h"
#include "vdb_offset/curves.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/attributes.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/io/file_bytes.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/mesh_facts.h"

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
                                    {"--save-vdb", !request.vdb.empty()},
                                    {"--dry-run", request.dry_run}})
    if (given) throw InvalidOption(fmt::format("{}: expected a scene without a fit, or a --distance", name));
  job.to_fit = job.source.scene->to_fit.view();
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
  const scene::Distance& own = scene.distance;
  job.asked.push_back(
      {own.expression ? own.expression->text() : fmt::format("{}{}", own.value, own.percent ? "%" : ""), own, {}});
}

double clearance_of(const Job& job) {
  const scene::Distance& clearance = job.request.clearance;
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
    if (options.corners == Corners::Miter) throw InvalidOption("--fit: expected a scene without mitred corners");
    job.to_fit = source.to_fit->view();
    options.clearance = clearance_of(job);
  }
  if (source.obstacles.face_count() == 0) return;
  options.obstacles = source.obstacles.view();
  options.clearance = clearance_of(job);
}

Distances read_distances(const Source& source, const std::string& from) {
  if (names_property(from)) {
    if (!source.file)
      throw InvalidInput(
          fmt::format("expected a mesh from a file for '{}', as curves and scenes have no properties", from));
    const std::size_t kind = from.find(':') + 1;  // one is for PLY, the other for files that hold more than a mesh
    if (source.file->document.operator bool() != from.starts_with("vtk:"))
      throw InvalidInput(fmt::format("{}: expected 'ply:NAME' for a PLY file and 'vtk:NAME' for one of VTK's, got '{}'",
                                     source.file->path, from));
    return Distances(io::vertex_property(*source.file, from.substr(kind)));
  }
  return Distances(io::read_vertex_numbers(from, source.view().positions.size()));
}

Distances evaluate(const Job& job, const DistanceRequest& request) {
  const Source& source = job.source;
  if (!request.from.empty()) return read_distances(source, request.from);
  const auto texture_of = [&] {
    if (!source.file)
      throw InvalidInput(job.request.input +
                         ": expected texture coordinates (u, v), which a scene and curves have none of");
    return io::vertex_texture(*source.file);
  };
  const auto normals_of = [&] {
    return source.curves ? curve_normals(source.view())
                         : vertex_normals(source.view(), job.options.weld, job.options.orient);
  };
  return scene::distances_of(request.distance, source.view(), normals_of, texture_of);
}

/// Multiplies all distances by a factor.
Distances scaled(const Distances& distances, double factor) {
  if (distances.uniform()) return factor * distances[0];
  std::vector<double> each(distances.count());
  for (std::size_t v = 0; v < each.size(); ++v) each[v] = factor * distances[v];
  return Distances(std::move(each));
}

/// The heights of layers whose thickness grows by a factor from one to the next.
std::vector<Distances> geometric_heights(const Job& job) {
  const LayersRequest& layers = *job.request.layers;
  std::vector<double> factors;  // of each layer: its height as a multiple of the first layer's
  factors.reserve(layers.count);
  double sum = 0, step = 1;
  for (std::size_t k = 0; k < layers.count; ++k, step *= layers.growth) factors.push_back(sum += step);
  const Distances given = evaluate(job, layers.first ? *layers.first : *layers.total);
  std::vector<Distances> heights;
  heights.reserve(factors.size());
  for (const double factor : factors) heights.push_back(scaled(given, layers.first ? factor : factor / sum));
  return heights;
}

constexpr std::size_t kLongestHeight = 4096;  // bytes: twice the longest expression, or the longest path

/// Reads a file of heights: one a line; empty lines, and text behind a #, are ignored. Files that it names are looked
/// for in its own folder.
std::vector<Distances> read_heights(Job& job) {
  const LayersRequest& layers = *job.request.layers;
  const std::string& path = layers.heights;
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) throw ReadError(path + ": expected a file, got a folder");
  const io::FileBytes bytes = io::FileBytes::open(path);
  std::string_view rest = bytes.view();
  std::vector<Distances> heights;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::string_view whole = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(whole.size() + 1, rest.size()));
    std::string_view text = whole.substr(0, whole.find('#'));
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) continue;
    text = text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
    if (text.size() > kLongestHeight)
      throw InvalidInput(fmt::format("{}: line {}: expected a height of at most {} characters, got {}", path, number,
                                     kLongestHeight, text.size()));
    const std::string line(text);
    try {
      DistanceRequest request = parse_distance_request(line);
      if (line.starts_with('@')) {
        request.from = (std::filesystem::path(path).parent_path() / request.from).string();
        job.files_of_heights.push_back(request.from);
      }
      heights.push_back(evaluate(job, request));
    } catch (const Error& error) {
      throw InvalidInput(fmt::format("{}: line {}: {}", path, number, error.what()));
    }
  }
  if (heights.empty()) throw InvalidInput(path + ": expected a height on each line, got none");
  if (layers.count > 0 && heights.size() != layers.count)
    throw InvalidInput(fmt::format("{}: expected {} heights, got {}", path, layers.count, heights.size()));
  return heights;
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
  for (const DistanceRequest& each : job.asked) distances.push_back(evaluate(job, each));
  if (!request.inner) return distances;
  for (const Distances& outer : distances)
    if (outer.inward() > 0)
      throw InvalidInput("--distance: expected distances of 0 or more at all vertices with --inner");
  distances.push_back(scaled(evaluate(job, *request.inner), -1));
  if (distances.back().outward() > 0) throw InvalidInput("--inner: expected distances of 0 or more at all vertices");
  return distances;
}

/// The precision that the written files keep of positions.
Precision precision_of(const Job& job) {
  const Request& request = job.request;
  const bool cells =
      request.layers && (io::volume_format_of(request.output) || io::structured_format_of(request.output));
  if (cells || !(job.curves() || job.source.file)) return {};
  if (io::is_cad_output(request.output)) return {};
  const std::string path = request.layers ? name_of_layer(request.output, 1, job.distances.size()) : request.output;
  const io::WriteOptions writing = write_options(request, path);
  if (job.curves()) return io::precision_of_curves(writing);
  const bool makes_anew = job.shell || request.tolerance;
  return makes_anew ? io::precision_of_new(path, *job.source.file, writing)
                    : io::precision_of(path, *job.source.file, writing);
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
  if (io::is_cad_output(request.output) && !(source.file && io::is_cad(source.file->format)))
    throw InvalidInput(request.output + ": expected an input that is a CAD model, for an output that is one, got " +
                       request.input);
  if (source.file && !request.tolerance && request.fit.empty()) job.options.exact = source.file->exact.get();
  if (source.file && source.file->has_touching_objects && request.weld_text == "auto") job.options.weld.enabled = false;
  if (request.solver) job.options.solver = *request.solver;
  if (request.collision) job.options.collision = *request.collision;
  if (request.corners) job.options.corners = *request.corners;
  if (request.miter_limit) job.options.miter_limit = *request.miter_limit;
  if (request.miter_limit && job.options.corners != Corners::Miter)
    throw InvalidOption("--miter-limit needs --corners miter, or a scene with mitred corners");
  settle_surroundings(job);
  if (!request.layers) job.distances = distances_of(job);
  else job.distances = request.layers->heights.empty() ? geometric_heights(job) : read_heights(job);
  return job;
}

Job resolve(const Request& request, const Source& source) {
  Job job = resolve_options(request, source);
  if (request.tolerance && (job.shell || job.to_fit))
    throw InvalidOption("--tolerance: expected a scene without a shell or a fit");
  if (!request.iso) job.options.precision = precision_of(job);
  if (!request.layers) job.outputs = destinations(request, job.asked);
  return job;
}

}  // namespace vdb_offset::tool
