// SPDX-License-Identifier: Apache-2.0
// Reads the values of single options.
#include "request/option_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <vector>

#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/run.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::tool {

std::size_t parse_word(const char* option, const std::string& text, std::initializer_list<const char*> words) {
  const auto word = std::find(words.begin(), words.end(), text);
  if (word != words.end()) return static_cast<std::size_t>(word - words.begin());
  std::string expected;  // in words: 'A', 'B' or 'C'
  for (auto each = words.begin(); each != words.end(); ++each)
    expected += fmt::format("{}'{}'", each == words.begin() ? "" : each + 1 == words.end() ? " or " : ", ", *each);
  throw UsageError(fmt::format("{}: expected {}, got '{}'", option, expected, text));
}

double parse_number(const char* option, const std::string& text, const char* expected, double above, double most) {
  const auto value = decimal<double>(text);
  require(value && *value > above && *value <= most, fmt::format("{}: expected {}, got '{}'", option, expected, text));
  return *value;
}

std::size_t parse_size(const std::string& text) {
  double value = 0;
  const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  std::string suffix;
  for (const char* c = end; c != text.data() + text.size(); ++c)
    if (*c != ' ') suffix += static_cast<char>(std::toupper(static_cast<unsigned char>(*c)));
  static const std::map<std::string, double> kUnits = {
      {"", 1},         {"B", 1},       {"K", 0x1p10},   {"KB", 0x1p10}, {"KIB", 0x1p10},
      {"M", 0x1p20},   {"MB", 0x1p20}, {"MIB", 0x1p20}, {"G", 0x1p30},  {"GB", 0x1p30},
      {"GIB", 0x1p30}, {"T", 0x1p40},  {"TB", 0x1p40},  {"TIB", 0x1p40}};
  const auto unit = kUnits.find(suffix);
  if (error != std::errc() || unit == kUnits.end() || !(value > 0) || value * unit->second > 0x1p60)
    throw UsageError(fmt::format("--max-memory: expected a size such as 4G or 512M, got '{}'", text));
  return std::max<std::size_t>(1, static_cast<std::size_t>(value * unit->second));
}

int parse_count(const char* option, const std::string& text, int least, int most) {
  const auto value = decimal<int>(text);
  require(value && *value >= least && *value <= most,
          fmt::format("{}: expected {} to {}, got '{}'", option, least, most, text));
  return *value;
}

bool names_property(const std::string& text) { return text.starts_with("ply:") || text.starts_with("vtk:"); }

DistanceRequest parse_distance_request(const std::string& text) {
  if (names_property(text)) return {text, {}, text};
  if (text.starts_with('@')) {
    if (text.size() == 1) throw InvalidOption("expected a file's name behind the '@'");
    return {text.substr(1), {}, text.substr(1)};
  }
  return {text, parse_distance_or_expression(text), {}};
}

DistanceRequest parse_distance_of(const char* option, const std::string& text, const Request& request) {
  try {
    DistanceRequest distance = parse_distance_request(text);
    require(!names_property(distance.from) || !scene::is_scene(request.input),
            fmt::format("{}: expected a file, as a scene has no properties", option));
    return distance;
  } catch (const InvalidOption& error) {
    throw UsageError(fmt::format("{}: {}", option, error.what()));
  }
}

DistanceRequest parse_distance_from(const std::string& text, const Request& request) {
  return parse_distance_of("--distance-from", names_property(text) ? text : "@" + text, request);
}

PartDistance parse_distance_of_part(const char* option, const std::string& text, const Request& request) {
  // Names may have colons, and so may expressions: of all colons, the first behind which there is a distance.
  std::optional<UsageError> first_error;
  for (std::size_t at = text.find(':'); at != std::string::npos; at = text.find(':', at + 1)) try {
      DistanceRequest distance = parse_distance_of(option, text.substr(at + 1), request);
      return {parse_part(option, text.substr(0, at)), std::move(distance)};
    } catch (const UsageError& error) {
      if (!first_error) first_error = error;
    } catch (const Error& error) {
      if (!first_error) first_error = UsageError(fmt::format("{}: {}", option, error.what()));
    }
  if (first_error) throw *first_error;
  throw UsageError(fmt::format("{}: expected a part and its distance, as in face=3:0.4, got '{}'", option, text));
}

Vec3d parse_vector(const char* option, const std::string& text) {
  Vec3d vector(0.0);
  std::size_t at = 0;
  int count = 0;
  for (; at <= text.size() && count < 3; ++count) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const auto number = decimal<double>(text.substr(at, comma - at));
    if (!number) break;
    vector[count] = *number;
    at = comma + 1;
  }
  require(count == 3 && at == text.size() + 1,
          fmt::format("{}: expected three numbers as in 1,0,0, got '{}'", option, text));
  return vector;
}

DistanceRequest parse_inner(const std::string& text, const Request& request) {
  DistanceRequest inner = parse_distance_of("--inner", text, request);
  require(inner.distance.expression || !inner.from.empty() || inner.distance.value > 0,
          fmt::format("--inner: expected a distance above 0, got '{}'", text));
  return inner;
}

io::Format parse_format(const std::string& text) {
  const auto format = io::format_of("." + text);
  require(format && (io::is_written(*format) || io::is_cad(*format)) && text.find('.') == std::string::npos,
          fmt::format("--format: expected 'obj', 'ply', 'stl', 'off', '3mf', 'glb', 'gltf', 'vtp', 'vtk', 'vtu', "
                      "'step', 'iges' or 'brep', got '{}'",
                      text));
  return *format;
}

io::TransportRequest parse_transport(const std::string& text) {
  io::TransportRequest request{false, false, false, true};
  if (text == "none") return request;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    bool* const wanted = word == "uv"         ? &request.texture
                         : word == "color"    ? &request.colours
                         : word == "material" ? &request.materials
                                              : nullptr;
    require(wanted != nullptr,
            fmt::format("--transport: expected 'uv', 'color' and 'material', separated by commas, or 'none', got '{}'",
                        text));
    *wanted = true;
    begin = end + 1;
  }
  return request;
}

io::Selector parse_part(const char* option, const std::string& text) {
  try {
    return io::parse_selector(text);
  } catch (const InvalidOption& error) {
    throw UsageError(fmt::format("{}: {}", option, error.what()));
  }
}

Border parse_border(const std::string& text) {
  constexpr Border kBorders[] = {Border::Slide, Border::Fixed, Border::Free};
  return kBorders[parse_word("--border", text, {"slide", "fixed", "free"})];
}

Corners parse_corners(const std::string& text) {
  if (text == "mitre") return Corners::Miter;
  constexpr Corners kCorners[] = {Corners::Miter, Corners::Round, Corners::Arc};
  return kCorners[parse_word("--corners", text, {"miter", "round", "arc"})];
}

double parse_miter_limit(const std::string& text) {
  return parse_number("--miter-limit", text, "a number of at least 1", std::nextafter(1.0, 0.0),
                      std::numeric_limits<double>::max());
}

double parse_taper(const std::string& text) {
  return parse_number("--taper", text, "a number of at least 0", -std::numeric_limits<double>::denorm_min(),
                      std::numeric_limits<double>::max());
}

double parse_strict_faces(const std::string& text) {
  return parse_number("--strict-faces", text.ends_with('%') ? text.substr(0, text.size() - 1) : text,
                      "a percentage of 0 or more", -std::numeric_limits<double>::denorm_min(),
                      std::numeric_limits<double>::max());
}

double parse_strict_certified(const std::string& text) {
  constexpr const char* kExpected = "a percentage from 1 to 100";
  const double percent = parse_number("--strict-certified",
                                      text.ends_with('%') ? text.substr(0, text.size() - 1) : text, kExpected, 0, 100);
  // A share, as 0.99, is meant by what is below: nobody asks for less than a hundredth.
  require(percent >= 1, fmt::format("--strict-certified: expected {}, got '{}'", kExpected, text));
  return percent;
}

Tolerance parse_tolerance(const std::string& text) {
  constexpr double kLeast = 0.001, kBelow = 100;  // percent: what offset_to_tolerance() takes
  const bool percent = text.ends_with('%');
  const auto value = decimal<double>(std::string_view(text).substr(0, text.size() - (percent ? 1 : 0)));
  require(value && (percent ? *value >= kLeast && *value < kBelow : *value > 0),
          fmt::format("--tolerance: expected a length above 0, or a percentage of the distance from {}% to below {}%, "
                      "got '{}'",
                      kLeast, kBelow, text));
  Tolerance tolerance;
  if (percent) tolerance.share = *value / 100;
  else tolerance.length = *value;
  return tolerance;
}

GivenDistance parse_clearance(const std::string& text) {
  GivenDistance clearance;
  try {
    clearance = parse_distance(text);
  } catch (const InvalidInput&) {
    clearance.value = -1;
  }
  require(clearance.value >= 0,
          fmt::format("--clearance: expected a number of world units or percent, 0 or more, got '{}'", text));
  return clearance;
}

namespace {

/// A length above 0, or a percentage.
GivenDistance parse_fineness(const char* option, const std::string& text) {
  GivenDistance fineness;
  try {
    fineness = parse_distance(text);
  } catch (const InvalidInput&) {
    fineness.value = 0;
  }
  require(fineness.value > 0 && !fineness.expression,
          fmt::format("{}: expected a number of world units or percent, above 0, got '{}'", option, text));
  return fineness;
}

}  // namespace

GivenDistance parse_flatten(const std::string& text) { return parse_fineness("--flatten", text); }

GivenDistance parse_blend(const std::string& text) { return parse_fineness("--blend", text); }

GivenDistance parse_deflection(const std::string& text) { return parse_fineness("--deflection", text); }

GivenDistance parse_fill_max(const std::string& text) { return parse_fineness("--fill-max", text); }

WeldOptions parse_weld(const std::string& text) {
  WeldOptions weld;
  if (text == "auto") return WeldOptions::automatic();
  if (text == "exact") return weld;
  if (text == "none") {
    weld.enabled = false;
    return weld;
  }
  const auto tolerance = decimal<double>(text);
  require(tolerance && *tolerance >= 0,
          fmt::format("--weld: expected 'auto', 'exact', 'none' or a tolerance >= 0 in world units, got '{}'", text));
  weld.tolerance = *tolerance;
  weld.join_hanging = *tolerance > 0;
  return weld;
}

Orient parse_orient(const std::string& text) {
  constexpr std::array kOrients = {Orient::Keep, Orient::FixDirectionOnly, Orient::FixCavities};
  return kOrients[parse_word("--orient", text, {"keep", "fix-direction-only", "fix-cavities"})];
}

SymmetryPlane parse_plane(const std::string& text) {
  const auto number = [&](std::string_view word) {
    const auto value = decimal<double>(word);
    require(value.has_value(),
            fmt::format("--symmetry: expected 'x=0' (or y, z), 'A,B,C,D' for A x + B y + C z = D, or 'none', got '{}'",
                        text));
    return *value;
  };
  SymmetryPlane plane;
  const std::string_view given = text;
  if (given.size() > 2 && given[1] == '=' && given[0] >= 'x' && given[0] <= 'z') {
    plane.normal[given[0] - 'x'] = 1;
    plane.offset = number(given.substr(2));
    return plane;
  }
  std::vector<double> factors;
  for (std::size_t begin = 0; begin <= given.size();) {
    const std::size_t end = std::min(given.find(',', begin), given.size());
    factors.push_back(number(given.substr(begin, end - begin)));
    begin = end + 1;
  }
  factors.resize(factors.size() == 4 ? 4 : 0);
  const double length = factors.empty() ? 0 : std::hypot(factors[0], factors[1], factors[2]);
  if (!(length > 0)) number("");
  for (int k = 0; k < 3; ++k) plane.normal[k] = factors[static_cast<std::size_t>(k)] / length;
  plane.offset = factors[3] / length;
  return plane;
}

}  // namespace vdb_offset::tool
