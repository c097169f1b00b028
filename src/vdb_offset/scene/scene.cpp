#include "vdb_offset/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "vdb_offset/base/memory.h"
#include "vdb_offset/decimal.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/base/scanner.h"
#include "vdb_offset/io/file_bytes.h"
#include "vdb_offset/shapes.h"

namespace vdb_offset::scene {
namespace {

using nlohmann::json;

/// An object of the scene. Every key must be asked for by the time finish() is called, so that a mistyped one is
/// told and not ignored.
class Reader {
 public:
  Reader(const std::string& path, std::string where, const json& object)
      : path_(path), where_(std::move(where)), object_(object) {
    if (!object.is_object()) fail("an object");
  }
  const std::string& path() const { return path_; }
  [[noreturn]] void fail(const std::string& expected) const {
    throw InvalidInput(fmt::format("{}: expected {} at '{}'", path_, expected, where_));
  }
  const json* find(const char* key) {
    asked_.insert(key);
    const auto at = object_.find(key);
    return at == object_.end() ? nullptr : &*at;
  }
  Reader object(const char* key) {
    const json* value = find(key);
    return {path_, below(key), value ? *value : fail_missing(key, "an object")};
  }
  double number(const char* key) {
    const json* value = find(key);
    if (!value || !value->is_number()) fail_missing(key, "a number");
    return value->get<double>();
  }
  double number(const char* key, double otherwise) { return find(key) ? number(key) : otherwise; }
  std::optional<double> optional_number(const char* key) {
    return find(key) ? std::optional(number(key)) : std::nullopt;
  }
  int count(const char* key) {
    const json* value = find(key);
    if (!value || !value->is_number_integer()) fail_missing(key, "a whole number");
    const auto wide = value->get<std::int64_t>();
    if (wide < 0 || wide > 1000000000) fail_missing(key, "a whole number from 0 to 1e9");
    return static_cast<int>(wide);
  }
  std::string text(const char* key) {
    const json* value = find(key);
    if (!value || !value->is_string()) fail_missing(key, "a text");
    return value->get<std::string>();
  }
  bool flag(const char* key, bool otherwise) {
    const json* value = find(key);
    if (!value) return otherwise;
    if (!value->is_boolean()) fail_missing(key, "true or false");
    return value->get<bool>();
  }
  Vec3d vector(const char* key) {
    const json* value = find(key);
    if (!value || !value->is_array() || value->size() != 3) fail_missing(key, "three numbers");
    Vec3d v;
    for (int k = 0; k < 3; ++k) {
      if (!(*value)[static_cast<std::size_t>(k)].is_number()) fail_missing(key, "three numbers");
      v[k] = (*value)[static_cast<std::size_t>(k)].get<double>();
    }
    return v;
  }
  void finish() const {
    for (const auto& [key, value] : object_.items())
      if (!asked_.contains(key))
        throw InvalidInput(fmt::format("{}: expected no key '{}'", path_, below(io::in_short(key))));
  }
  [[noreturn]] const json& fail_missing(const std::string& key, const std::string& expected) const {
    throw InvalidInput(fmt::format("{}: expected {} at '{}'", path_, expected, below(key)));
  }

 private:
  std::string below(const std::string& key) const { return where_.empty() ? key : where_ + "." + key; }

  const std::string& path_;
  std::string where_;
  const json& object_;
  std::set<std::string, std::less<>> asked_;
};

Polygons make_shape(Reader shape) {
  static const std::map<std::string, std::function<Polygons(Reader&)>> kMakers = {
      {"icosphere", [](Reader& r) { return icosphere(r.number("radius"), r.count("subdivisions")); }},
      {"uv_sphere", [](Reader& r) { return uv_sphere(r.number("radius"), r.count("segments"), r.count("rings")); }},
      {"hemisphere", [](Reader& r) { return hemisphere(r.number("radius"), r.count("segments"), r.count("rings")); }},
      {"cube",
       [](Reader& r) { return box(Vec3d(r.number("side")), r.count("divisions"), r.flag("triangles", false)); }},
      {"torus",
       [](Reader& r) { return torus(r.number("major"), r.number("minor"), r.count("segments"), r.count("sides")); }},
      {"cylinder",
       [](Reader& r) {
         return cylinder(r.number("radius"), r.number("height"), r.count("segments"), r.count("stacks"),
                         r.count("rings"));
       }},
      {"socket",
       [](Reader& r) {
         return socket(r.number("radius"), r.number("depth"), r.number("wall"), r.count("segments"), r.count("stacks"));
       }},
      {"plates",
       [](Reader& r) {
         return plates(r.number("width"), r.number("thickness"), r.number("gap"), r.count("divisions"));
       }},
      {"wedge",
       [](Reader& r) { return wedge(r.number("angle"), r.number("length"), r.number("width"), r.count("divisions")); }},
      {"room_corner", [](Reader& r) { return room_corner(r.number("side"), r.count("divisions")); }},
      {"diffuser",
       [](Reader& r) {
         return diffuser(r.number("inlet"), r.number("outlet"), r.number("length"), r.count("divisions"));
       }},
      {"naca_wing",
       [](Reader& r) {
         return naca_wing(r.text("digits"), r.number("chord"), r.number("span"), r.count("points"), r.count("stacks"));
       }},
      {"gear",
       [](Reader& r) {
         return gear(r.count("teeth"), r.number("root_radius"), r.number("tip_radius"), r.number("bore_radius"),
                     r.number("thickness"), r.count("stacks"));
       }},
      {"bumpy_sphere",
       [](Reader& r) {
         return bumpy_sphere(r.number("radius"), r.number("amplitude"), r.number("frequency"),
                             static_cast<unsigned>(r.count("seed")), r.count("subdivisions"));
       }},
      {"hollow_box", [](Reader& r) { return hollow_box(r.number("side"), r.number("wall"), r.count("divisions")); }},
      {"patch", [](Reader& r) { return patch(r.number("side"), r.number("amplitude", 0), r.count("divisions")); }},
  };
  const std::string type = shape.text("type");
  const auto maker = kMakers.find(type);
  if (maker == kMakers.end()) {
    std::vector<std::string> names(kMakers.size());
    std::transform(kMakers.begin(), kMakers.end(), names.begin(), [](const auto& known) { return known.first; });
    shape.fail(fmt::format("a type among {}, not '{}',", fmt::join(names, ", "), io::in_short(type)));
  }
  Polygons mesh = maker->second(shape);
  shape.finish();
  return mesh;
}

Answer read_answer(Reader reader) {
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

Expectations read_expectations(Reader reader, bool shell, bool fits) {
  Expectations expect;
  expect.min_reached = reader.optional_number("min_reached");
  expect.max_reached = reader.optional_number("max_reached");
  expect.max_position_error = reader.optional_number("max_position_error");
  if (reader.find("answer")) expect.answer = read_answer(reader.object("answer"));
  if (expect.max_position_error && !expect.answer) reader.fail("an answer to measure 'max_position_error' against");
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

Distance read_distance(Reader& offset) {
  const json* value = offset.find("distance");
  try {
    if (value && value->is_string()) return parse_distance_or_expression(value->get<std::string>());
  } catch (const InvalidOption& error) {
    throw InvalidInput(fmt::format("{}: {}", offset.path(), error.what()));
  }
  return {offset.number("distance"), false, {}};
}

/// The faces that lie in a box, corners and all.
std::vector<std::uint8_t> faces_within(Reader box, PolygonView mesh) {
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

/// A mesh beside the scene's own, and how near they may be.
Polygons read_beside(Reader beside, double& clearance) {
  const Vec3d at = beside.vector("at");
  clearance = beside.number("clearance", 0);
  Polygons mesh = make_shape(beside.object("shape"));
  for (Vec3d& p : mesh.positions) p += at;
  beside.finish();
  return mesh;
}

void read_part_and_obstacle(Reader& offset, Scene& scene) {
  if (offset.find("only")) scene.only = faces_within(offset.object("only"), scene.shape.view());
  if (offset.find("border")) {
    const std::string border = offset.text("border");
    if (border != "slide" && border != "fixed" && border != "free") offset.fail("a border among slide, fixed, free");
    scene.border = border == "slide" ? Border::Slide : border == "fixed" ? Border::Fixed : Border::Free;
  }
  if (offset.find("obstacle")) scene.obstacle = read_beside(offset.object("obstacle"), scene.clearance);
}

/// How far the shape goes.
void read_ways(Reader& offset, Scene& scene) {
  if (!offset.find("fit")) {
    scene.distance = read_distance(offset);
    return;
  }
  for (const char* const other : {"distance", "obstacle", "shell", "collision"})
    if (offset.find(other)) offset.fail(fmt::format("'fit' without '{}'", other));
  scene.to_fit = read_beside(offset.object("fit"), scene.clearance);
  if (!(scene.clearance > 0)) offset.fail("'fit' with a 'clearance' above 0");
}

/// Refuses a key that an object has twice, one of which the parser would drop without a word.
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
  constexpr std::size_t kLongestError = 200;                               // the parser repeats what it has read
  constexpr std::size_t kMostPerByte = 32, kSmall = std::size_t{1} << 20;  // an array of digits, say
  const io::FileBytes bytes = io::FileBytes::open(path);
  if (bytes.view().size() > kSmall) require_memory(kMostPerByte * bytes.view().size(), path);
  try {
    return json::parse(bytes.view(), require_keys_once(path));
  } catch (const json::exception& error) {
    throw InvalidInput(fmt::format("{}: expected JSON: {}", path, io::in_short(error.what(), kLongestError)));
  }
}

}  // namespace

Distance parse_distance(const std::string& text) {
  Distance distance;
  std::string_view number = text;
  if (number.ends_with('%')) {
    distance.percent = true;
    number.remove_suffix(1);
  }
  const auto value = decimal<double>(number);
  if (!value)
    throw InvalidInput(
        fmt::format("distance: expected a number of world units, or of percent as in '1.5%', got '{}'", text));
  distance.value = *value;
  return distance;
}

Distance parse_distance_or_expression(const std::string& text) {
  try {
    return parse_distance(text);
  } catch (const InvalidInput&) {
    Distance distance;
    distance.expression.emplace(text);
    return distance;
  }
}

Distances distances_of(const Distance& distance, PolygonView mesh,
                       const std::function<std::vector<Vec3d>()>& normals_of,
                       const std::function<std::vector<Vec2d>()>& texture_of) {
  if (!distance.expression) {
    const double diagonal = distance.percent ? used_diagonal(mesh) : 0, length = distance.in_world_units(diagonal);
    if (length == 0 && distance.value != 0 && diagonal > 0)
      throw InvalidInput(
          fmt::format("distance: expected a share of the diagonal that is a number, got {:g} % of {:.3g} "
                      "(scale the model)",
                      distance.value, diagonal));
    return length;
  }
  const DistanceExpression& expression = *distance.expression;
  std::vector<Vec3d> normals;
  std::vector<Vec2d> texture;
  if (expression.uses_normals()) normals = normals_of();
  if (expression.uses_texture()) texture = texture_of();
  return Distances(expression({mesh.positions, normals, texture, expression.is_percent() ? used_diagonal(mesh) : 0}));
}

void Scene::set(OffsetOptions& options) const {
  options.grid = grid;
  options.solver = solver;
  options.collision = collision;
  options.only = only;
  options.border = border;
  options.obstacles = obstacle.view();
  options.clearance = clearance;
  options.off_source = shell;
}

Vec3d Answer::lifted(const Vec3d& source, double distance) const {
  const double x = std::abs(source[0]), y = std::abs(source[1]);
  constexpr double kOnEdge = 1e-9;
  if (std::max(x, y) > radius + kOnEdge) return source;
  if (std::max(x, y) < radius - kOnEdge) return source + Vec3d(0, 0, distance);
  Vec3d way(x < radius - kOnEdge ? 0.0 : std::copysign(shift[0], source[0]),
            y < radius - kOnEdge ? 0.0 : std::copysign(shift[1], source[1]), shift[2]);
  return way.lengthSqr() > 0 ? source + way.unit() * distance : source;
}

Vec3d Answer::operator()(const Vec3d& source, double distance) const {
  switch (form) {
    case Form::Sphere:
      return source.unit() * radius;
    case Form::Box: {
      Vec3d clamped;
      for (int k = 0; k < 3; ++k) clamped[k] = std::clamp(source[k], -half[k], half[k]);
      return clamped;
    }
    case Form::Torus: {
      const Vec3d centre = Vec3d(source[0], source[1], 0).unit() * major;
      return centre + (source - centre).unit() * minor;
    }
    case Form::Ray:
      return source + source.unit() * distance;
    case Form::Under: {
      const Vec3d end = source + source.unit() * distance;
      return end[2] <= shift[2] ? end : source + (end - source) * ((shift[2] - source[2]) / (end[2] - source[2]));
    }
    case Form::Lift:
      return lifted(source, distance);
    case Form::Shift:
      break;
  }
  return source + shift;
}

bool is_scene(const std::string& path) { return path.ends_with(".json") || path.ends_with(".JSON"); }

Scene read_scene(const std::string& path) {
  const json document = parse_file(path);
  Reader root(path, "", document);
  Scene scene;
  scene.path = path;
  if (root.find("description")) scene.description = root.text("description");
  if (root.find("file")) scene.mesh_path = (std::filesystem::path(path).parent_path() / root.text("file")).string();
  else scene.shape = make_shape(root.object("shape"));
  Reader offset = root.object("offset");
  read_ways(offset, scene);
  if (offset.find("collision")) {
    const std::string collision = offset.text("collision");
    if (collision != "limit" && collision != "merge") offset.fail("a collision among limit, merge");
    scene.collision = collision == "merge" ? Collision::Merge : Collision::Limit;
  }
  read_part_and_obstacle(offset, scene);
  scene.shell = offset.flag("shell", false);
  offset.finish();
  if (root.find("grid")) {
    Reader grid = root.object("grid");
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

std::vector<std::string> unmet(const Expectations& expect, PolygonView source, const OffsetResult& result) {
  std::size_t used = 0, reached = 0;
  double worst = 0;
  for (std::size_t v = 0; v < result.states.size(); ++v) {
    if (result.states[v] == VertexState::Unused) continue;
    ++used;
    const bool there = result.states[v] == VertexState::Reached;
    reached += there;
    // An obstacle's answer holds for those that it stops, too.
    if (expect.answer && (there || expect.answer->form == Answer::Form::Under))
      worst =
          std::max(worst, (result.positions[v] - (*expect.answer)(source.positions[v], result.distances[v])).length());
  }
  const double share = used ? static_cast<double>(reached) / static_cast<double>(used) : 0;
  std::vector<std::string> failed;
  if (expect.min_reached && share < *expect.min_reached)
    failed.push_back(fmt::format("expected a share reached of at least {}, got {:.6f}", *expect.min_reached, share));
  if (expect.max_reached && share > *expect.max_reached)
    failed.push_back(fmt::format("expected a share reached of at most {}, got {:.6f}", *expect.max_reached, share));
  if (expect.max_position_error && worst > *expect.max_position_error)
    failed.push_back(
        fmt::format("expected positions within {} of the answer, got {:.3g}", *expect.max_position_error, worst));
  if (const auto& fit = result.statistics.fit) {
    if (expect.min_gap && !(fit->gap >= *expect.min_gap))
      failed.push_back(fmt::format("expected a gap of at least {}, got {:.9g}", *expect.min_gap, fit->gap));
    if (expect.max_gap && !(fit->gap <= *expect.max_gap))
      failed.push_back(fmt::format("expected a gap of at most {}, got {:.9g}", *expect.max_gap, fit->gap));
  }
  return failed;
}

std::vector<std::string> unmet(const Expectations& expect, const ShellFacts& shell) {
  std::vector<std::string> failed;
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) failed.push_back("expected a shell " + what);
  };
  require(shell.closed && shell.border_edges_left == 0, "that is closed");
  require(shell.oriented, "whose faces agree about the outside");
  require(shell.non_manifold_edges == 0, fmt::format("without non-manifold edges, got {}", shell.non_manifold_edges));
  const std::size_t crossings = shell.crossings + shell.crossings_near_source + shell.source_crossings;
  require(crossings == 0, fmt::format("that does not cross itself, got {} pairs of triangles that meet", crossings));
  if (!expect.volume) return failed;
  const double error = std::abs(shell.volume - *expect.volume);
  require(error <= *expect.max_volume_error * *expect.volume,
          fmt::format("of volume {}, within a share of {}, got {:.9g}", *expect.volume, *expect.max_volume_error,
                      shell.volume));
  return failed;
}

double Distance::in_world_units(double diagonal) const { return percent ? value / 100 * diagonal : value; }

}  // namespace vdb_offset::scene
