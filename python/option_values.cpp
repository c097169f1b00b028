// SPDX-License-Identifier: Apache-2.0
#include "option_values.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "vdb_offset/curves.h"
#include "vdb_offset/error.h"
#include "vdb_offset/run.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::python {
namespace {

/// Reads keywords one by one, and leaves those alone that were not given.
class Keywords {
 public:
  explicit Keywords(const py::dict& given) : given_(given) {}

  py::object operator[](const char* name) const {
    return given_.contains(name) ? py::reinterpret_borrow<py::object>(given_[name]) : py::none();
  }

  template <class Value>
  void read(const char* name, Value& value) const {
    const py::object given = (*this)[name];
    if (given.is_none()) return;
    try {
      value = given.cast<Value>();
    } catch (const py::cast_error&) {
      throw InvalidOption(std::string(name) + ": expected " + what<Value>() + ", got " + text_of(given));
    }
  }
  template <class Value>
  void read(const char* name, std::optional<Value>& value) const {
    Value given{};
    if ((*this)[name].is_none()) return;
    read(name, given);
    value = given;
  }
  /// One of some words.
  template <class Value, std::size_t kCount>
  void read(const char* name, Value& value, const std::array<std::pair<const char*, Value>, kCount>& words) const {
    const py::object given = (*this)[name];
    if (given.is_none()) return;
    std::string expected;
    for (const auto& [word, meaning] : words) {
      if (py::isinstance<py::str>(given) && given.cast<std::string>() == word) {
        value = meaning;
        return;
      }
      expected += (expected.empty() ? "'" : " or '") + std::string(word) + "'";
    }
    throw InvalidOption(std::string(name) + ": expected " + expected + ", got " + text_of(given));
  }

  static std::string text_of(const py::object& given) { return py::repr(given).cast<std::string>(); }

 private:
  template <class Value>
  static const char* what() {
    if constexpr (std::is_same_v<Value, bool>) return "True or False";
    else if constexpr (std::is_integral_v<Value>) return "a whole number, 0 or more";
    else return "a number";
  }

  const py::dict& given_;
};

/// Whether it is True or False, Python's own or NumPy's, which are numbers to Python.
bool is_truth(const py::object& given) {
  return py::isinstance<py::bool_>(given) || py::type::of(given).attr("__name__").cast<std::string>() == "bool_";
}

WeldOptions weld_of(const py::object& given) {
  if (given.is_none()) return WeldOptions::automatic();
  WeldOptions weld;
  if (py::isinstance<py::str>(given)) {
    const auto word = given.cast<std::string>();
    if (word == "auto") return WeldOptions::automatic();
    if (word == "exact") return weld;
    if (word == "none") {
      weld.enabled = false;
      return weld;
    }
  } else if (!is_truth(given) && PyNumber_Check(given.ptr()) == 1) {
    weld.tolerance = given.cast<double>();
    if (weld.tolerance >= 0) return weld;
  }
  throw InvalidOption("weld: expected 'auto', 'exact', 'none' or a tolerance >= 0 in world units, got " +
                      Keywords::text_of(given));
}

Precision precision_of(const py::object& given) {
  if (given.is_none()) return {};
  if (py::isinstance<py::str>(given)) {
    const auto word = given.cast<std::string>();
    if (word == "double") return {};
    if (word == "single") return {.kind = Precision::Kind::Single};
  } else if (!is_truth(given) && PyIndex_Check(given.ptr()) == 1) {
    const auto digits = given.cast<long long>();
    if (digits >= 1 && digits <= 17) return {.kind = Precision::Kind::Digits, .digits = static_cast<int>(digits)};
  }
  throw InvalidOption("precision: expected 'double', 'single' or 1 to 17 digits, got " + Keywords::text_of(given));
}

/// True, False, or a list of planes (A, B, C, D): all x with A x + B y + C z = D.
SymmetryOptions symmetry_of(const py::object& given) {
  SymmetryOptions symmetry;
  if (given.is_none()) return symmetry;
  if (is_truth(given)) {
    symmetry.find = PyObject_IsTrue(given.ptr()) == 1;
    return symmetry;
  }
  try {
    for (const auto& plane : given.cast<std::vector<std::array<double, 4>>>()) {
      const Vec3d normal(plane[0], plane[1], plane[2]);
      const double length = normal.length();
      if (!(length > 0) || !std::isfinite(length))
        throw InvalidOption("symmetry: expected planes with a normal that is not 0");
      symmetry.planes.push_back({normal / length, plane[3] / length});
    }
  } catch (const py::cast_error&) {
    throw InvalidOption("symmetry: expected True, False, or planes of four numbers each, got " +
                        Keywords::text_of(given));
  }
  return symmetry;
}

constexpr std::array kOrients = {std::pair{"keep", Orient::Keep},
                                 std::pair{"fix-direction-only", Orient::FixDirectionOnly}};

/// What all surfaces and offsets have in common.
template <class Options>
void read_common(const Keywords& keywords, Options& options) {
  keywords.read("voxel_size", options.grid.voxel_size);
  keywords.read("voxels_per_distance", options.grid.voxels_per_distance);
  keywords.read("orient", options.orient, kOrients);
  // What the command takes without being asked.
  constexpr double kMemoryShare = 0.8;
  options.max_memory = static_cast<std::size_t>(kMemoryShare * static_cast<double>(available_memory()));
  keywords.read("max_memory", options.max_memory);
  keywords.read("threads", options.threads);
  if (options.threads < 0) throw InvalidOption("threads: expected a whole number, 0 or more");
  options.weld = weld_of(keywords["weld"]);
  options.precision = precision_of(keywords["precision"]);
}

}  // namespace

AskedOptions asked_options(const py::dict& given, const MeshArrays& mesh) {
  const Keywords keywords(given);
  AskedOptions asked;
  OffsetOptions& options = asked.options;
  read_common(keywords, options);
  keywords.read("collision", options.collision,
                std::array{std::pair{"limit", Collision::Limit}, std::pair{"merge", Collision::Merge}});
  keywords.read("corners", options.corners,
                std::array{std::pair{"round", Corners::Round}, std::pair{"miter", Corners::Miter}});
  keywords.read("solver", options.solver,
                std::array{std::pair{"closest", Solver::Closest}, std::pair{"eikonal", Solver::Eikonal}});
  keywords.read("border", options.border,
                std::array{std::pair{"slide", Border::Slide}, std::pair{"fixed", Border::Fixed},
                           std::pair{"free", Border::Free}});
  keywords.read("miter_limit", options.miter_limit);
  if (!(options.miter_limit >= 1)) throw InvalidOption("miter_limit: expected a number of 1 or more");
  keywords.read("clearance", options.clearance);
  keywords.read("paths", options.keep_paths);
  options.symmetry = symmetry_of(keywords["symmetry"]);
  if (const py::object only = keywords["only"]; !only.is_none())
    options.only = marks_of(only, mesh.view().face_count());
  if (const py::object obstacles = keywords["obstacles"]; !obstacles.is_none()) {
    const py::tuple pair = py::isinstance<py::tuple>(obstacles) ? py::tuple(obstacles) : py::tuple();
    if (pair.size() != 2) throw InvalidOption("obstacles: expected a pair of vertices and faces");
    asked.obstacles.emplace(pair[0], pair[1]);
    options.obstacles = asked.obstacles->view();
  }
  return asked;
}

std::pair<double, double> tolerance_of(const py::object& tolerance) {
  const scene::Distance asked = scene::parse_distance(py::str(tolerance).cast<std::string>());
  return asked.percent ? std::pair(asked.value / 100, 0.0) : std::pair(0.0, asked.value);
}

CheckOptions check_options(const AskedOptions& asked, const py::dict& given) {
  const OffsetOptions& options = asked.options;
  CheckOptions check;
  check.only = options.only;
  check.border = options.border;
  check.obstacles = options.obstacles;
  check.clearance = options.clearance;
  check.corners = options.corners;
  check.miter_limit = options.miter_limit;
  check.weld = options.weld;
  check.orient = options.orient;
  check.precision = options.precision;
  check.threads = options.threads;
  if (const py::object tolerance = Keywords(given)["tolerance"]; !tolerance.is_none()) {
    std::tie(check.tolerance_share, check.tolerance_length) = tolerance_of(tolerance);
  }
  return check;
}

IsoOptions iso_options(const py::dict& given) {
  const Keywords keywords(given);
  IsoOptions options;
  read_common(keywords, options);
  keywords.read("use_winding", options.use_winding);
  keywords.read("adaptivity", options.adaptivity);
  keywords.read("keep_specks", options.keep_specks);
  return options;
}

Distances distances_of(const py::object& distance, PolygonView mesh, bool curves, const OffsetOptions& options) {
  if (py::isinstance<py::str>(distance)) {
    const auto normals = [&] {
      return curves ? curve_normals(mesh) : vertex_normals(mesh, options.weld, options.orient);
    };
    const auto texture = []() -> std::vector<Vec2d> {
      throw InvalidInput("distance: expected an expression without u and v: arrays have no texture coordinates");
    };
    return scene::distances_of(scene::parse_distance_or_expression(distance.cast<std::string>()), mesh, normals,
                               texture);
  }
  const auto numbers = [&]() -> py::array_t<double, py::array::c_style | py::array::forcecast> {
    try {
      return {distance};
    } catch (const py::error_already_set& error) {
      if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError)) throw;
      throw InvalidOption("distance: expected a number, an array or a text, got " + Keywords::text_of(distance));
    }
  }();
  if (numbers.ndim() == 0) {
    if (!std::isfinite(*numbers.data()))
      throw InvalidOption("distance: expected a finite number, got " + Keywords::text_of(distance));
    return *numbers.data();
  }
  if (numbers.ndim() != 1 || static_cast<std::size_t>(numbers.size()) != mesh.positions.size())
    throw InvalidInput("distance: expected one for each of " + std::to_string(mesh.positions.size()) +
                       " vertices, got an array of the shape " + shape_of(numbers));
  return Distances(std::vector<double>(numbers.data(), numbers.data() + numbers.size()));
}

void measure_by_axis(const py::dict& keywords, const Distances& distance, PolygonView mesh, Metric& metric) {
  // Beyond this ratio the lesser distance drowns in the rounding of the larger one, as the command says.
  constexpr double kMostRatio = 1000;
  const py::object given = Keywords(keywords)["distance_z"];
  if (given.is_none()) return;
  const Distances z = distances_of(given, mesh, false, {});
  const double ratio = distance[0] / z[0];
  if (!distance.uniform() || !z.uniform() || !(std::max(ratio, 1 / ratio) <= kMostRatio && ratio > 0))
    throw InvalidOption("distance_z: expected one number beside one distance, of its sign and within " +
                        std::to_string(static_cast<int>(kMostRatio)) + " times it, either way, got " +
                        Keywords::text_of(given));
  metric = Metric::of_half_axes(distance[0], z[0]);
}

}  // namespace vdb_offset::python
