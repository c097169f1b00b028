// SPDX-License-Identifier: Apache-2.0
// Reads a scene from JSON: a shape or the name of a mesh file, how that is offset, and what is expected of the result.
// Objects are asked key by key, and a key that is not known, one that an object has twice, or a value of the wrong kind
// is refused with its place; so are keys that exclude each other, as a distance and a fit, and expectations without
// what they are about. The faces of a part are those that lie in a box with all of their corners. Memory for a large
// text is asked for before it is parsed. Shapes are made in make_shape.cpp. A mesh file is named and not opened here,
// and expectations are read but compared elsewhere (expectations.cpp).
#include "vdb_offset/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "bytes/scanner.h"
#include "ground/system/memory.h"
#include "scene/json_object.h"
#include "vdb_offset/io/file_bytes.h"
#include "vdb_offset/run.h"

namespace vdb_offset::scene {
namespace {

Answer read_answer(JsonObject reader) {
  const std::string form = reader.text("form");
  Answer answer;
  if (form == "sphere") {
    answer.form = Answer::Form::Sphere;
    answer.radius = reader.number("radius");
  } else if (form == "box") {
    answer.form = Answer::Form::Box;
    answer.half = reader.vector("half");
  } else if (form == "torus") {
    answer.form = Answer::Form::Torus;
    answer.major = reader.number("major");
    answer.minor = reader.number("minor");
  } else if (form == "shift") {
    answer.form = Answer::Form::Shift;
    answer.shift = reader.vector("shift");
  } else if (form == "ray") {
    answer.form = Answer::Form::Ray;
  } else if (form == "under") {
    answer.form = Answer::Form::Under;
    answer.shift[2] = reader.number("height");
  } else if (form == "lift") {
    answer.form = Answer::Form::Lift;
    answer.radius = reader.number("half");
    answer.shift = reader.vector("border");
  } else {
    reader.fail("a form among sphere, box, torus, shift, ray, under, lift");
  }
  reader.finish();
  return answer;
}

Expectations read_expectations(JsonObject reader, bool shell, bool fits) {
  Expectations expect;
  expect.min_reached = reader.optional_number("min_reached");
  expect.max_reached = reader.optional_number("max_reached");
  expect.max_position_error = reader.optional_number("max_position_error");
  if (reader.find("answer")) expect.answer = read_answer(reader.object("answer"));
  if (expect.max_position_error && !expect.answer) reader.fail("an answer to measure 'max_position_error' against");
  expect.max_face_error = reader.optional_number("max_face_error");
  expect.min_gap = reader.optional_number("min_gap");
  expect.max_gap = reader.optional_number("max_gap");
  if ((expect.min_gap || expect.max_gap) && !fits) reader.fail("'offset.fit' where there is a gap");
  expect.volume = reader.optional_number("volume");
  expect.max_volume_error = reader.optional_number("max_volume_error");
  if (expect.volume.has_value() != expect.max_volume_error.has_value())
    reader.fail("'volume' and 'max_volume_error', or neither");
  if (expect.volume && !shell) reader.fail("'offset.shell' to be true where there is a 'volume'");
  reader.finish();
  return expect;
}

GivenDistance read_distance(JsonObject& offset) {
  const json* value = offset.find("distance");
  try {
    if (value && value->is_string()) return parse_distance_or_expression(value->get<std::string>());
  } catch (const InvalidOption& error) {
    throw InvalidInput(fmt::format("{}: {}", offset.path(), error.what()));
  }
  return {offset.number("distance"), false, {}};
}

/// Marks the faces that lie in a box with all of their corners.
std::vector<std::uint8_t> faces_within(JsonObject box, PolygonView mesh) {
  const Vec3d lower = box.vector("lower"), upper = box.vector("upper");
  box.finish();
  std::vector<std::uint8_t> marks(mesh.face_count());
  for (std::size_t f = 0; f < marks.size(); ++f) {
    const auto face = mesh.face(f);
    marks[f] = std::all_of(face.begin(), face.end(), [&](std::uint32_t v) {
      const Vec3d& p = mesh.positions[v];
      return p == openvdb::math::maxComponent(lower, openvdb::math::minComponent(upper, p));
    });
  }
  return marks;
}

/// Reads a mesh beside the scene's own, and the clearance to it.
Polygons read_beside(JsonObject beside, double& clearance) {
  const Vec3d at = beside.vector("at");
  clearance = beside.number("clearance", 0);
  Polygons mesh = make_shape(beside.object("shape"));
  for (Vec3d& p : mesh.positions) p += at;
  beside.finish();
  return mesh;
}

void read_collision_and_corners(JsonObject& offset, Scene& scene) {
  if (offset.find("collision")) {
    const std::string collision = offset.text("collision");
    if (collision != "limit" && collision != "merge") offset.fail("a collision among limit, merge");
    scene.collision = collision == "merge" ? Collision::Merge : Collision::Limit;
  }
  if (offset.find("corners")) {
    const std::string corners = offset.text("corners");
    if (corners != "round" && corners != "miter") offset.fail("corners among round, miter");
    scene.corners = corners == "miter" ? Corners::Miter : Corners::Round;
  }
  scene.miter_limit = offset.optional_number("miter_limit");
  if (scene.miter_limit && scene.corners == Corners::Round) offset.fail("no 'miter_limit' where 'corners' are round");
  if (scene.miter_limit && !(*scene.miter_limit >= 1)) offset.fail("a 'miter_limit' of 1 or more");
  scene.taper = offset.optional_number("taper");
  if (scene.taper && !(*scene.taper >= 0)) offset.fail("a 'taper' of 0 or more");
}

void read_part_and_obstacle(JsonObject& offset, Scene& scene) {
  if (offset.find("only")) scene.only = faces_within(offset.object("only"), scene.shape.view());
  if (offset.find("border")) {
    const std::string border = offset.text("border");
    if (border != "slide" && border != "fixed" && border != "free") offset.fail("a border among slide, fixed, free");
    scene.border = border == "slide" ? Border::Slide : border == "fixed" ? Border::Fixed : Border::Free;
  }
  if (offset.find("obstacle")) scene.obstacle = read_beside(offset.object("obstacle"), scene.clearance);
}

/// Reads how far the shape is offset: a distance, or a mesh to fit.
void read_distances(JsonObject& offset, Scene& scene) {
  if (!offset.find("fit")) {
    scene.distance = read_distance(offset);
    return;
  }
  for (const char* const other : {"distance", "obstacle", "shell", "collision", "corners", "taper"})
    if (offset.find(other)) offset.fail(fmt::format("'fit' without '{}'", other));
  scene.to_fit = read_beside(offset.object("fit"), scene.clearance);
  if (!(scene.clearance > 0)) offset.fail("'fit' with a 'clearance' above 0");
}

/// Refuses a key that an object has twice, since the parser would silently drop one of the two.
json::parser_callback_t require_keys_once(const std::string& path) {
  return [&path, keys = std::vector<std::set<std::string>>()](int, json::parse_event_t event, json& parsed) mutable {
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    else if (event == json::parse_event_t::object_end) keys.pop_back();
    else if (event == json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      throw InvalidInput(fmt::format("{}: expected the key '{}' once, got it twice in an object", path,
                                     io::in_short(parsed.get<std::string>())));
    return true;
  };
}

json parse_file(const std::string& path) {
  constexpr std::size_t kLongestError = 200;  // bytes; the parser's message repeats what it has read
  // kMostPerByte: bytes in memory for a byte of text, as in an array of digits. kSmall: bytes; smaller texts are not
  // worth asking the system for the memory in use.
  constexpr std::size_t kMostPerByte = 32, kSmall = std::size_t{1} << 20;
  const io::FileBytes bytes = io::FileBytes::open(path);
  if (bytes.view().size() > kSmall) require_memory(kMostPerByte * bytes.view().size(), path);
  try {
    return json::parse(bytes.view(), require_keys_once(path));
  } catch (const json::exception& error) {
    throw InvalidInput(fmt::format("{}: expected JSON: {}", path, io::in_short(error.what(), kLongestError)));
  }
}

}  // namespace

void Scene::set(OffsetOptions& options) const {
  options.grid = grid;
  options.solver = solver;
  options.collision = collision;
  options.corners = corners;
  if (miter_limit) options.miter_limit = *miter_limit;
  if (taper) options.taper = *taper;
  options.only = only;
  options.border = border;
  options.obstacles = obstacle.view();
  options.clearance = clearance;
  options.off_source = shell;
}

bool is_scene(const std::string& path) { return path.ends_with(".json") || path.ends_with(".JSON"); }

Scene read_scene(const std::string& path) {
  const json document = parse_file(path);
  JsonObject root(path, "", document);
  Scene scene;
  scene.path = path;
  if (root.find("description")) scene.description = root.text("description");
  if (root.find("file")) scene.mesh_path = (std::filesystem::path(path).parent_path() / root.text("file")).string();
  else scene.shape = make_shape(root.object("shape"));
  JsonObject offset = root.object("offset");
  read_distances(offset, scene);
  read_collision_and_corners(offset, scene);
  read_part_and_obstacle(offset, scene);
  scene.shell = offset.flag("shell", false);
  offset.finish();
  if (root.find("grid")) {
    JsonObject grid = root.object("grid");
    scene.grid.voxel_size = grid.optional_number("voxel_size");
    scene.grid.voxels_per_distance = grid.optional_number("voxels_per_distance");
    if (grid.find("solver")) {
      const std::string solver = grid.text("solver");
      if (solver != "closest" && solver != "eikonal") grid.fail("a solver among closest, eikonal");
      scene.solver = solver == "eikonal" ? Solver::Eikonal : Solver::Closest;
    }
    grid.finish();
  }
  if (root.find("expect"))
    scene.expect = read_expectations(root.object("expect"), scene.shell, scene.to_fit.face_count() > 0);
  root.finish();
  return scene;
}

}  // namespace vdb_offset::scene
