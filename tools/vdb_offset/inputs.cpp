#include "inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "messages.h"
#include "vdb_offset/curves.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/error.h"
#include "vdb_offset/grid.h"
#include "vdb_offset/io/attributes.h"
#include "vdb_offset/io/file_bytes.h"
#include "vdb_offset/io/vertex_numbers.h"
#include "vdb_offset/memory_limit.h"
#include "vdb_offset/mesh_measures.h"
#include "vdb_offset/options.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::tool {
namespace {

/// Several meshes as one.
void add(Polygons& to, const Polygons& from) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
  for (std::size_t f = 0; f < from.face_count(); ++f) {
    for (const auto v : from.view().face(f)) to.corners.push_back(first + v);
    to.close_face();
  }
}

/// A scene's mesh to fit takes the place of a distance, with all that the command line may not ask for then.
void settle_fit_of_scene(Source& source, Arguments& args) {
  for (const auto& [name, given] : {std::pair{"--mode iso", args.iso.has_value()},
                                    {"--shell", args.shell},
                                    {"--obstacle", source.obstacles.face_count() > 0},
                                    {"--collision", args.collision.has_value()},
                                    {"--save-vdb", !args.vdb.empty()},
                                    {"--dry-run", args.dry_run}})
    if (given) throw InvalidOption(fmt::format("{}: expected a scene without a fit, or a --distance", name));
  source.to_fit = source.scene->to_fit;
  args.distances.push_back({"fit", {}, {}});
}

void settle_scene(Source& source, Arguments& args) {
  scene::Scene& scene = *source.scene;
  const GridOptions given = args.options.grid;
  scene.set(args.options);
  if (given.voxel_size || given.voxels_per_distance) args.options.grid = given;
  if (!args.layers && !args.iso) args.shell = args.shell || scene.shell;
  // What a scene expects holds for its own distance.
  if (args.layers || !args.distances.empty()) {
    scene.expect = {};
    return;
  }
  if (scene.to_fit.face_count() > 0) return settle_fit_of_scene(source, args);
  const scene::Distance& own = scene.distance;
  args.distances.push_back(
      {own.expression ? own.expression->text() : fmt::format("{}{}", own.value, own.percent ? "%" : ""), own, {}});
}

void settle_surroundings(const Source& source, Arguments& args) {
  OffsetOptions& options = args.options;
  if (!args.only.empty()) options.only = io::select_faces(*source.file, args.only);
  if (args.border) options.border = *args.border;
  options.off_source = args.shell;
  options.inner_skin_last = args.inner.has_value();
  if (!args.fit.empty()) {
    if (source.obstacles.face_count() > 0 || options.obstacles.face_count() > 0 || args.shell)
      throw InvalidOption("--fit: expected a scene without an obstacle or a shell");
    options.clearance = args.clearance.in_world_units(args.clearance.percent ? used_diagonal(source.view()) : 0);
  }
  if (source.obstacles.face_count() == 0) return;
  options.obstacles = source.obstacles.view();
  options.clearance = args.clearance.in_world_units(args.clearance.percent ? used_diagonal(source.view()) : 0);
}

Distances read_distances(const Source& source, const std::string& from) {
  constexpr std::string_view kProperty = "ply:";
  if (from.starts_with(kProperty)) return Distances(io::vertex_property(*source.file, from.substr(kProperty.size())));
  return Distances(io::read_vertex_numbers(from, source.view().positions.size()));
}

Distances evaluate(const Source& source, const Arguments& args, const DistanceRequest& request) {
  if (!request.from.empty()) return read_distances(source, request.from);
  const auto texture_of = [&] {
    if (!source.file)
      throw InvalidInput(args.input + ": expected texture coordinates (u, v), which a scene and curves have none of");
    return io::vertex_texture(*source.file);
  };
  const auto normals_of = [&] {
    return source.curves ? curve_normals(source.view())
                         : vertex_normals(source.view(), args.options.weld, args.options.orient);
  };
  return scene::distances_of(request.distance, source.view(), normals_of, texture_of);
}

/// So many times the distances of so many vertices.
Distances scaled(const Distances& distances, double factor) {
  if (distances.uniform()) return factor * distances[0];
  std::vector<double> each(distances.count());
  for (std::size_t v = 0; v < each.size(); ++v) each[v] = factor * distances[v];
  return Distances(std::move(each));
}

void settle_all_but_distances(Source& source, Arguments& args) {
  if (source.scene) settle_scene(source, args);
  if (args.solver) args.options.solver = *args.solver;
  if (args.collision) args.options.collision = *args.collision;
  settle_surroundings(source, args);
}

/// Heights of layers that grow from one to the next.
std::vector<Distances> geometric_heights(const Source& source, const Arguments& args) {
  const LayersRequest& layers = *args.layers;
  std::vector<double> factors;  // of the first layer's height
  factors.reserve(layers.count);
  double sum = 0, step = 1;
  for (std::size_t k = 0; k < layers.count; ++k, step *= layers.growth) factors.push_back(sum += step);
  const Distances given = evaluate(source, args, layers.first ? *layers.first : *layers.total);
  std::vector<Distances> heights;
  heights.reserve(factors.size());
  for (const double factor : factors) heights.push_back(scaled(given, layers.first ? factor : factor / sum));
  return heights;
}

constexpr std::size_t kLongestHeight = 4096;

/// One height a line; empty lines and what is behind a # do not count. Other files are looked for beside this one.
std::vector<Distances> read_heights(const Source& source, Arguments& args) {
  const std::string& path = args.layers->heights;
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
      DistanceRequest request = parse_request(line);
      if (line.starts_with('@')) {
        request.from = (std::filesystem::path(path).parent_path() / request.from).string();
        args.layers->files_of_heights.push_back(request.from);
      }
      heights.push_back(evaluate(source, args, request));
    } catch (const Error& error) {
      throw InvalidInput(fmt::format("{}: line {}: {}", path, number, error.what()));
    }
  }
  if (heights.empty()) throw InvalidInput(path + ": expected a height on each line, got none");
  if (args.layers->count > 0 && heights.size() != args.layers->count)
    throw InvalidInput(fmt::format("{}: expected {} heights, got {}", path, args.layers->count, heights.size()));
  return heights;
}

/// \throw InvalidInput if there are open curves, but none whose ends are near each other
void close_curves(const Arguments& args, Source& source) {
  Curves curves = source.curves->file.polygons;
  const std::vector<OpenCurve> open = open_curves(curves.view());
  source.closed = vdb_offset::close_curves(curves);
  if (!source.closed.empty()) source.as_closed = std::move(curves);
  else if (!open.empty())
    throw InvalidInput(
        fmt::format("{}: --close: expected a curve whose ends are nearer to each other than {:g} of its "
                    "length, got {:.6g} of {:.6g}",
                    args.input, OpenCurve::kNearlyClosed, open.front().gap, open.front().length));
}

}  // namespace

void write_curves(const std::string& path, const Source& source, std::span<const Vec3d> positions,
                  const io::WriteOptions& options) {
  if (source.as_closed && io::curve_format_of(path) != source.curves->format)
    io::write_curves(path, CurvesView{positions, source.as_closed->corners, source.as_closed->face_begin}, options);
  else io::write_curves(path, *source.curves, positions, options);
}

void tell_remarks(const io::MeshFile& file) {
  for (const std::string& remark : file.remarks) tell(fmt::format("{}: {}", file.path, remark));
}

Source read_source(const Arguments& args) {
  set_memory_limit(args.options.max_memory);
  Source source;
  if (args.curves) {
    source.curves = io::read_curves(args.input);
    if (args.close) close_curves(args, source);
    return source;
  }
  if (scene::is_scene(args.input)) source.scene = scene::read_scene(args.input);
  if (!source.scene) source.file = io::read_mesh(args.input, format_of(args.input, args));
  else if (!source.scene->mesh_path.empty()) source.file = io::read_mesh(source.scene->mesh_path);
  if (source.file && !args.quiet) tell_remarks(*source.file);
  for (const std::string& path : args.obstacles) {
    const io::MeshFile obstacle = io::read_mesh(path, format_of(path, args));
    if (!args.quiet) tell_remarks(obstacle);
    add(source.obstacles, obstacle.polygons);
  }
  if (!args.fit.empty()) {
    const io::MeshFile to_fit = io::read_mesh(args.fit, format_of(args.fit, args));
    if (!args.quiet) tell_remarks(to_fit);
    source.to_fit = to_fit.polygons;
  }
  return source;
}

std::vector<Distances> settle_options(Source& source, Arguments& args) {
  settle_all_but_distances(source, args);
  std::vector<Distances> distances;
  if (args.axes) {
    if (args.options.obstacles.face_count() > 0 || args.shell)
      throw InvalidOption("--distance-xy: expected a scene without an obstacle or a shell");
    const auto [metric, distance] = settle_axes(*args.axes, source.view());
    args.options.metric = metric;
    return {distance};
  }
  for (const DistanceRequest& request : args.distances) distances.push_back(evaluate(source, args, request));
  if (args.inner) {
    for (const Distances& outer : distances)
      if (outer.inward() > 0)
        throw InvalidInput("--distance: expected distances of 0 or more at all vertices with --inner");
    distances.push_back(scaled(evaluate(source, args, *args.inner), -1));
    if (distances.back().outward() > 0) throw InvalidInput("--inner: expected distances of 0 or more at all vertices");
  }
  return distances;
}

std::vector<Distances> settle_layers(Source& source, Arguments& args) {
  settle_all_but_distances(source, args);
  return args.layers->heights.empty() ? geometric_heights(source, args) : read_heights(source, args);
}

}  // namespace vdb_offset::tool
