// SPDX-License-Identifier: Apache-2.0
#pragma once

// Values of the attributes of an SVG drawing, and the transforms among them.

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "bytes/line_records.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// What a transform of SVG does to a point: x' = a x + c y + e, y' = b x + d y + f.
using SvgMatrix = std::array<double, 6>;
inline constexpr SvgMatrix kSvgIdentity = {1, 0, 0, 1, 0, 0};

/// The transform that applies `inner` first, then `outer`.
SvgMatrix product(const SvgMatrix& outer, const SvgMatrix& inner);

/// Whether a transform can be undone in doubles.
bool has_inverse(const SvgMatrix& m);

Vec3d transformed(const SvgMatrix& m, const Vec2d& p);
Vec2d transformed_back(const SvgMatrix& m, const Vec3d& p);

/// An absolute unit of CSS.
struct SvgUnit {
  std::string_view name;
  double pixels;       ///< 96 are an inch. In a drawing, its units.
  double micrometres;  ///< Beside the pixels, so that whole ones are exact.
};
inline constexpr SvgUnit kSvgUnits[] = {
    {"px", 1, 25400. / 96},        {"in", 96, 25400},      {"cm", 96 / 2.54, 10000}, {"mm", 96 / 25.4, 1000},
    {"pt", 96. / 72, 25400. / 72}, {"pc", 16, 25400. / 6}, {"Q", 96 / 101.6, 250}};

/// Whether a character is white space in XML and in attributes of SVG.
inline bool is_svg_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }

/// Walks over the value of an attribute: numbers, commands and functions.
class SvgValueScanner {
 public:
  /// `fail(expected, found)` throws.
  SvgValueScanner(std::string_view value, std::function<void(const std::string&, const std::string&)> fail)
      : value_(value), fail_(std::move(fail)) {}

  bool at_end() {
    while (at_ < value_.size() && (is_svg_space(value_[at_]) || value_[at_] == ',')) ++at_;
    return at_ == value_.size();
  }
  bool at_number() {
    return !at_end() && (is_digit(value_[at_]) || std::string_view("+-.").find(value_[at_]) != std::string_view::npos);
  }

  double number(const char* expected) {
    if (!at_number()) fail(expected);
    const char* const first = value_.data() + at_ + (value_[at_] == '+');
    if (value_[at_] == '+' && value_.substr(at_ + 1).starts_with('-')) fail(expected);
    double number = 0;
    const auto [end, error] = std::from_chars(first, value_.data() + value_.size(), number);
    if (error != std::errc() || !std::isfinite(number) || static_cast<std::size_t>(end - first) > kLongestNumber)
      fail(expected);
    at_ = static_cast<std::size_t>(end - value_.data());
    return number;
  }

  char letter() { return value_[at_++]; }

  /// One of an arc's two flags: a single 0 or 1, which the next number may follow without anything between them.
  bool flag() {
    if (at_end() || (value_[at_] != '0' && value_[at_] != '1')) fail("a flag of an arc, 0 or 1");
    return value_[at_++] == '1';
  }

  /// A length that is the whole value, in the units of the drawing: a number, or one with an absolute unit of CSS.
  double length() {
    const std::string_view whole = value_.substr(at_);
    const double number = this->number("a length");
    std::string_view unit = value_.substr(at_);
    while (!unit.empty() && is_svg_space(unit.back())) unit.remove_suffix(1);
    if (unit.empty()) return number;
    for (const SvgUnit& each : kSvgUnits)
      if (unit == each.name) return number * each.pixels;
    fail_("a number, alone or with px, mm, cm, in, pt, pc or Q behind it", fmt::format("'{}'", whole.substr(0, 20)));
    std::terminate();  // fail_ has thrown
  }

  /// Skips the name of a function and "(". Returns the name.
  std::string_view function_name() {
    const std::size_t open = value_.find('(', at_);
    if (open == std::string_view::npos) fail("a transform such as 'translate(1 2)'");
    std::string_view name = value_.substr(at_, open - at_);
    while (!name.empty() && is_svg_space(name.back())) name.remove_suffix(1);
    at_ = open + 1;
    return name;
  }
  bool close() {
    if (at_end() || value_[at_] != ')') return false;
    ++at_;
    return true;
  }

  [[noreturn]] void fail(const std::string& expected) {
    const bool end = at_end();
    fail_(expected, end ? "its end" : fmt::format("'{}'", value_.substr(at_, 20)));
    std::terminate();  // fail_ has thrown
  }

 private:
  static bool is_digit(char c) { return c >= '0' && c <= '9'; }

  std::string_view value_;
  std::size_t at_ = 0;
  std::function<void(const std::string&, const std::string&)> fail_;
};

/// The product of the transforms in a `transform` attribute.
SvgMatrix parse_transform(SvgValueScanner value);

/// A property and its value in a list of CSS declarations.
struct SvgDeclaration {
  std::string_view name, value;
};

/// The last declaration in a list of these of one of the properties that `names` holds: the one that counts.
std::optional<SvgDeclaration> declared_in(std::string_view style, std::string_view names);

/// Whether `names`, which single blanks separate, hold a name.
bool holds_name(std::string_view names, std::string_view name);

}  // namespace vdb_offset::io
