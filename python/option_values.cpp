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
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "distance_values.h"
#include "keywords.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/run.h"

namespace vdb_offset::python {
namespace {

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
    weld.join_hanging = weld.tolerance > 0;
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

/// The plane of all x with A x + B y + C z = D, if there is one.
std::optional<SymmetryPlane> plane_of(const std::array<double, 4>& factors) {
  const auto [a, b, c, d] = factors;
  const double length = std::hypot(a, b, c);
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(d)) return std::nullopt;
  return SymmetryPlane{Vec3d(a / length, b / length, c / length), d / length};
}

/// A plane as the command takes it: 'x=0', or 'A,B,C,D'.
std::optional<SymmetryPlane> plane_of(std::string_view text) {
  std::array<double, 4> factors{};
  if (text.size() > 2 && text[1] == '=' && text[0] >= 'x' && text[0] <= 'z') {
    const auto offset = decimal<double>(text.substr(2));
    if (!offset) return std::nullopt;
    factors[static_cast<std::size_t>(text[0] - 'x')] = 1;
    factors[3] = *offset;
    return plane_of(factors);
  }
  for (std::size_t k = 0; k < factors.size(); ++k) {
    const bool is_last = k + 1 == factors.size();
    const std::size_t end = is_last ? text.size() : text.find(',');
    const auto factor = end == std::string_view::npos ? std::nullopt : decimal<double>(text.substr(0, end));
    if (!factor) return std::nullopt;
    factors[k] = *factor;
    if (!is_last) text.remove_prefix(end + 1);
  }
  return plane_of(factors);
}

/// Takes a plane, as a text or as four numbers, or 'none'. Returns false for anything else.
bool take_plane(const py::object& given, SymmetryOptions& symmetry) {
  std::optional<SymmetryPlane> plane;
  if (py::isinstance<py::str>(given)) {
    const auto text = given.cast<std::string>();
    if (text == "none") {
      symmetry.find = false;
      return true;
    }
    plane = plane_of(std::string_view(text));
  } else {
    try {
      plane = plane_of(given.cast<std::array<double, 4>>());
    } catch (const py::cast_error&) {  // no four numbers
    }
  }
  if (plane) symmetry.planes.push_back(*plane);
  return plane.has_value();
}

/// True, False, a text, or a list of planes.
SymmetryOptions symmetry_of(const py::object& given) {
  SymmetryOptions symmetry;
  if (given.is_none()) return symmetry;
  if (is_truth(given)) {
    symmetry.find = PyObject_IsTrue(given.ptr()) == 1;
    return symmetry;
  }
  bool is_understood =
      py::isinstance<py::str>(given) ? take_plane(given, symmetry) : py::isinstance<py::iterable>(given);
  if (is_understood && !py::isinstance<py::str>(given))
    for (const py::handle each : given)
      is_understood = is_understood && take_plane(py::reinterpret_borrow<py::object>(each), symmetry);
  if (!is_understood)
    throw InvalidOption(
        "symmetry: expected True, False, 'none', or planes, each 'x=0' (or y, z), 'A,B,C,D' or four numbers for "
        "A x + B y + C z = D, got " +
        Keywords::text_of(given));
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
                                 std::pair{"fix-direction-only", Orient::FixDirectionOnly},
                                 std::pair{"fix-cavities", Orient::FixCavities}};

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
  constexpr std::size_t kInterpreterBytes = 48 << 20;  // with NumPy; measured
  options.bytes_held = kInterpreterBytes;
  keywords.read("threads", options.threads);
  constexpr int kMostThreads = 4096;  // as the command has it
  if (options.threads < 0 || options.threads > kMostThreads)
    throw InvalidOption("threads: expected a whole number, 0 to " + std::to_string(kMostThreads));
  options.weld = weld_of(keywords["weld"]);
  options.precision = precision_of(keywords["precision"]);
}

}  // namespace

double clearance_of(const py::object& given, PolygonView mesh) {
  if (const auto clearance = length_of(given); clearance && clearance->value >= 0)
    return clearance->in_world_units(clearance->percent ? used_diagonal(mesh) : 0);
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
  keywords.read(
      "corners", options.corners,
      std::array{std::pair{"miter", std::optional(Corners::Miter)}, std::pair{"round", std::optional(Corners::Round)},
                 std::pair{"arc", std::optional(Corners::Arc)}});
  keywords.read("solver", options.solver,
                std::array{std::pair{"closest", Solver::Closest}, std::pair{"eikonal", Solver::Eikonal}});
  keywords.read("border", options.border,
                std::array{std::pair{"slide", Border::Slide}, std::pair{"fixed", Border::Fixed},
                           std::pair{"free", Border::Free}});
  keywords.read("miter_limit", options.miter_limit);
  if (!(options.miter_limit >= 1) || !std::isfinite(options.miter_limit))
    throw InvalidOption("miter_limit: expected a number of 1 or more");
  if (given.contains("miter_limit") && options.corners.value_or(Corners::Miter) != Corners::Miter)
    throw InvalidOption("miter_limit needs corners='miter'");
  keywords.read("taper", options.taper);
  if (!(options.taper >= 0) || !std::isfinite(options.taper))
    throw InvalidOption("taper: expected a number of 0 or more");
  if (const py::object clearance = keywords["clearance"]; !clearance.is_none()) {
    options.clearance = clearance_of(clearance, mesh);
    if (!given.contains("obstacles")) throw InvalidOption("clearance needs obstacles");
  }
  keywords.read("paths", options.keep_paths);
  keywords.read("face_errors", options.keep_face_errors);
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
    if (asked.vdb.find('\0') != std::string::npos)
      throw InvalidOption("save_vdb: expected the name of a file, got one with a null character");
    options.keep_field = true;
  }
  return asked;
}

CheckOptions check_options(const AskedOptions& asked, const py::object& tolerance) {
  const OffsetOptions& options = asked.options;
  CheckOptions check;
  check.only = options.only;
  check.border = options.border;
  check.symmetry = options.symmetry;
  check.obstacles = options.obstacles;
  check.clearance = options.clearance;
  check.corners = options.corners;
  check.miter_limit = options.miter_limit;
  check.weld = options.weld;
  check.orient = options.orient;
  check.precision = options.precision;
  check.threads = options.threads;
  check.keep_face_errors = options.keep_face_errors;
  if (!tolerance.is_none()) std::tie(check.tolerance_share, check.tolerance_length) = tolerance_of(tolerance);
  return check;
}

IsoOptions iso_options(const py::dict& given) {
  const Keywords keywords(given);
  IsoOptions options;
  read_common(keywords, options);
  keywords.read("inside", options.use_winding, std::array{std::pair{"winding", true}, std::pair{"never", false}});
  keywords.read("adaptivity", options.adaptivity);
  keywords.read("keep_specks", options.keep_specks);
  return options;
}

}  // namespace vdb_offset::python
