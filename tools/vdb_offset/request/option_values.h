// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

#include "request/request.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/polygons.h"

// What the texts of single options say. Each throws UsageError, with the option and what it takes, for another text.

namespace vdb_offset::tool {

// More threads than any machine has: a mistyped number is not to ask the system for them. Not measured.
constexpr int kMostThreads = 4096;
// Significant digits with which every double reads back to itself.
constexpr int kMostDigits = 17;

/// \throw UsageError with the message unless the condition holds.
inline void require(bool holds, const std::string& message) {
  if (!holds) throw UsageError(message);
}

/// Which of some words a text is, counted from 0.
std::size_t parse_word(const char* option, const std::string& text, std::initializer_list<const char*> words);

/// A number above one bound and up to another. `expected` says in words which numbers these are.
double parse_number(const char* option, const std::string& text, const char* expected, double above, double most);

/// Parses such numbers.
inline auto number_between(const char* option, const char* expected, double above, double most) {
  return [=](const std::string& text) { return parse_number(option, text, expected, above, most); };
}

/// A whole number, in decimal digits.
int parse_count(const char* option, const std::string& text, int least, int most);
/// Parses such numbers.
inline auto count_between(const char* option, int least, int most) {
  return [=](const std::string& text) { return parse_count(option, text, least, most); };
}

/// Bytes with an optional suffix K, M, G or T (binary), as in "4G" or "1.5 GiB".
std::size_t parse_size(const std::string& text);

/// Whether a text is ply:NAME or vtk:NAME.
bool names_property(const std::string& text);
/// A distance, an expression, @FILE, ply:NAME or vtk:NAME. \throw InvalidOption
DistanceRequest parse_distance_request(const std::string& text);
/// A distance, an expression, @FILE, ply:NAME or vtk:NAME that an option of this request was given.
DistanceRequest parse_distance_of(const char* option, const std::string& text, const Request& request);
/// The file, ply:NAME or vtk:NAME that --distance-from was given.
DistanceRequest parse_distance_from(const std::string& text, const Request& request);
/// PART:D of an option, --distance-of or --layers-of.
PartDistance parse_distance_of_part(const char* option, const std::string& text, const Request& request);
/// Three numbers, as in 1,0,0.
Vec3d parse_vector(const char* option, const std::string& text);
/// The distance of an inner skin, above 0 if it is one for all vertices.
DistanceRequest parse_inner(const std::string& text, const Request& request);

/// The values of --distance-xy and --distance-z; both or none are given.
std::optional<AxisDistances> parse_axes(const std::string& xy, const std::string& z);
/// The metric in which distances by axis are one distance, and that distance, world units.
std::pair<Metric, double> settle_axes(const AxisDistances& axes, PolygonView mesh);

/// --deflection: a length above 0, or a percentage.
GivenDistance parse_deflection(const std::string& text);
/// --fill-max: a length above 0, or a percentage.
GivenDistance parse_fill_max(const std::string& text);
/// --blend: a length above 0, or a percentage.
GivenDistance parse_blend(const std::string& text);
/// group=NAME, material=NAME, faces=FILE, and of CAD models face=N, name=NAME or color=RRGGBB.
io::Selector parse_part(const char* option, const std::string& text);

/// 'slide', 'fixed' or 'free'.
Border parse_border(const std::string& text);

/// 'round' or 'miter'.
Corners parse_corners(const std::string& text);
/// A number of at least 1.
double parse_miter_limit(const std::string& text);
/// A number of at least 0.
double parse_taper(const std::string& text);

/// Percent, 0 or more.
double parse_strict_faces(const std::string& text);
/// A percentage, with or without its sign.
double parse_strict_certified(const std::string& text);

/// A length in world units, or percent of the distance.
Tolerance parse_tolerance(const std::string& text);

/// World units or percent, 0 or more.
GivenDistance parse_clearance(const std::string& text);

/// World units or percent, above 0.
GivenDistance parse_flatten(const std::string& text);

/// 'auto', 'exact', 'none' or a tolerance.
WeldOptions parse_weld(const std::string& text);

/// 'keep', 'fix-direction-only' or 'fix-cavities'.
Orient parse_orient(const std::string& text);

/// 'x=0', or another axis and number, or 'A,B,C,D' for A x + B y + C z = D.
SymmetryPlane parse_plane(const std::string& text);

/// A format that is written, by its ending without a point.
io::Format parse_format(const std::string& text);

/// 'uv', 'color' and 'material', separated by commas, or 'none', of --transport.
io::TransportRequest parse_transport(const std::string& text);

}  // namespace vdb_offset::tool
