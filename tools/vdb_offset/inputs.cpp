#include "inputs.h"

#include <fmt/format.h>

#include <algorithm>

#include "vdb_offset/io/attributes.h"
#include "vdb_offset/io/vertex_numbers.h"

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

void settle_scene(Source& source, Arguments& args) {
  scene::Scene& scene = *source.scene;
  const GridOptions given = args.options.grid;
  scene.set(args.options);
  if (given.voxel_size || given.voxels_per_distance) args.options.grid = given;
  // What a scene expects holds for its own distance.
  if (!args.distances.empty() || !args.distance_from.empty()) {
    scene.expect = {};
    return;
  }
  const scene::Distance& own = scene.distance;
  args.distances.push_back(
      {own.expression ? own.expression->text() : fmt::format("{}{}", own.value, own.percent ? "%" : ""), own});
}

void settle_surroundings(const Source& source, Arguments& args) {
  OffsetOptions& options = args.options;
  if (!args.only.empty()) options.only = io::select_faces(*source.file, args.only);
  if (args.border) options.border = *args.border;
  options.off_source = args.shell;
  if (source.obstacles.face_count() == 0) return;
  options.obstacles = source.obstacles.view();
  options.clearance = args.clearance.in_world_units(args.clearance.percent ? used_diagonal(source.view()) : 0);
}

Distances read_distances(const Source& source, const std::string& from) {
  constexpr std::string_view kProperty = "ply:";
  if (from.starts_with(kProperty)) return Distances(io::vertex_property(*source.file, from.substr(kProperty.size())));
  return Distances(io::read_vertex_numbers(from, source.view().positions.size()));
}

Distances evaluate(const Source& source, const Arguments& args, const scene::Distance& distance) {
  const auto texture_of = [&] {
    if (!source.file)
      throw InvalidInput(args.input + ": expected texture coordinates (u, v), which a scene has none of");
    return io::vertex_texture(*source.file);
  };
  return scene::distances_of(distance, source.view(), args.options.weld, args.options.orient, texture_of);
}

/// The same to the other side.
Distances inward(const Distances& distances, std::size_t count) {
  if (distances.uniform()) return -distances[0];
  std::vector<double> each(count);
  for (std::size_t v = 0; v < count; ++v) each[v] = -distances[v];
  return Distances(std::move(each));
}

}  // namespace

Source read_source(const Arguments& args) {
  Source source;
  if (scene::is_scene(args.input)) source.scene = scene::read_scene(args.input);
  if (!source.scene) source.file = io::read_mesh(args.input, format_of(args.input, args));
  else if (!source.scene->mesh_path.empty()) source.file = io::read_mesh(source.scene->mesh_path);
  for (const std::string& path : args.obstacles)
    add(source.obstacles, io::read_mesh(path, format_of(path, args)).polygons);
  return source;
}

std::vector<Distances> settle_options(Source& source, Arguments& args) {
  if (source.scene) settle_scene(source, args);
  if (args.solver) args.options.solver = *args.solver;
  if (args.collision) args.options.collision = *args.collision;
  settle_surroundings(source, args);
  std::vector<Distances> distances;
  if (!args.distance_from.empty()) distances.push_back(read_distances(source, args.distance_from));
  for (const DistanceRequest& request : args.distances) distances.push_back(evaluate(source, args, request.distance));
  if (args.inner) {
    distances.push_back(inward(evaluate(source, args, args.inner->distance), source.view().positions.size()));
    if (distances.back().outward() > 0) throw InvalidInput("--inner: expected distances of 0 or more at all vertices");
  }
  return distances;
}

}  // namespace vdb_offset::tool
