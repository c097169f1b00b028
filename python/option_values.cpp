// SPDX-License-Identifier: Apache-2.0
#include "option_values.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>

#include "distance_values.h"
#include "keywords.h"
#include "vdb_offset/error.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::python {
namespace {

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

/// Bytes: a number, 0 for no limit, or a text with a unit, as the command takes it.
std::size_t size_of(const py::object& given) {
  static const std::map<std::string, double> kUnits = {
      {"", 1},         {"B", 1},       {"K", 0x1p10},   {"KB", 0x1p10}, {"KIB", 0x1p10},
      {"M", 0x1p20},   {"MB", 0x1p20}, {"MIB", 0x1p20}, {"G", 0x1p30},  {"GB", 0x1p30},
      {"GIB", 0x1p30}, {"T", 0x1p40},  {"TB", 0x1p40},  {"TIB", 0x1p40}};
  constexpr double kMost = 0x1p60;
  if (py::isinstance<py::str>(given)) {
    const auto text = given.cast<std::string>();
    const char* const last = text.data() + text.size();
    double value = 0;
    const auto [end, error] = std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0), last, value);
    std::string suffix;
    for (const char* c = end; c != last; ++c)
      if (*c != ' ') suffix += static_cast<char>(std::toupper(static_cast<unsigned char>(*c)));
    const auto unit = kUnits.find(suffix);
    if (error == std::errc() && unit != kUnits.end() && value > 0 && value * unit->second <= kMost)
      return std::max<std::size_t>(1, static_cast<std::size_t>(value * unit->second));
  } else if (!is_truth(given) && PyIndex_Check(given.ptr()) == 1) {
    try {
      return given.cast<std::size_t>();
    } catch (const py::cast_error&) {  // negative, or more than there can be
    }
  }
  throw InvalidOption("max_memory: expected a number of bytes, or a size such as '4G' or '512M', got " +
                      Keywords::text_of(given));
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
  if (const py::object size = keywords["max_memory"]; !size.is_none()) options.max_memory = size_of(size);
  keywords.read("threads", options.threads);
  if (options.threads < 0) throw InvalidOption("threads: expected a whole number, 0 or more");
  options.weld = weld_of(keywords["weld"]);
  options.precision = precision_of(keywords["precision"]);
}

}  // namespace

double clearance_of(const py::object& given, PolygonView mesh) {
  if (py::isinstance<py::str>(given)) {
    try {
      const scene::Distance clearance = scene::parse_distance(given.cast<std::string>());
      if (clearance.value >= 0) return clearance.in_world_units(clearance.percent ? used_diagonal(mesh) : 0);
    } catch (const InvalidInput&) {  // no number
    }
  } else if (!is_truth(given) && PyNumber_Check(given.ptr()) == 1) {
    const auto clearance = given.cast<double>();
    if (clearance >= 0 && std::isfinite(clearance)) return clearance;
  }
  throw InvalidOption("clearance: expected a number of world units, or a text with one or percent, 0 or more, got " +
                      Keywords::text_of(given));
}

AskedOptions asked_options(const py::dict& given, const Source& source) {
  const Keywords keywords(given);
  const PolygonView mesh = source.view();
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
  if (const py::object clearance = keywords["clearance"]; !clearance.is_none())
    options.clearance = clearance_of(clearance, mesh);
  keywords.read("paths", options.keep_paths);
  options.symmetry = symmetry_of(keywords["symmetry"]);
  if (const py::object only = keywords["only"]; !only.is_none()) options.only = marks_of(only, mesh.face_count());
  if (const py::object obstacles = keywords["obstacles"]; !obstacles.is_none()) {
    const py::tuple pair = py::isinstance<py::tuple>(obstacles) ? py::tuple(obstacles) : py::tuple();
    if (pair.size() != 2) throw InvalidOption("obstacles: expected a pair of vertices and faces");
    asked.obstacles.emplace(pair[0], pair[1]);
    options.obstacles = asked.obstacles->view();
  }
  if (const py::object texture = keywords["texture"]; !texture.is_none()) asked.texture = texture_of(texture, mesh);
  if (const py::object path = keywords["save_vdb"]; !path.is_none()) {
    asked.vdb = py::module_::import("os").attr("fsdecode")(path).cast<std::string>();
    if (asked.vdb.empty()) throw InvalidOption("save_vdb: expected the name of a file, got an empty one");
    options.keep_field = true;
  }
  return asked;
}

CheckOptions check_options(const AskedOptions& asked, const py::object& tolerance) {
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
  if (!tolerance.is_none()) std::tie(check.tolerance_share, check.tolerance_length) = tolerance_of(tolerance);
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

}  // namespace vdb_offset::python
