// SPDX-License-Identifier: Apache-2.0
// Reads the outlines of shapes from their attributes.
#include "svg/svg_outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>
#include <utility>

namespace vdb_offset::io {
namespace {

/// Draws a path by its commands.
class PathReader {
 public:
  PathReader(SvgValueScanner value, SvgPen& pen) : value_(std::move(value)), pen_(pen) {}

  void run() {
    while (!value_.at_end()) {
      if (!value_.at_number()) take_command();
      else if (command_ == 0 || command_ == 'z') value_.fail(fmt::format("one of the commands {}", kCommands));
      draw();
    }
    pen_.end(false);
  }

 private:
  static constexpr const char* kCommands = "M, L, H, V, C, S, Q, T, A and Z";

  void take_command() {
    SvgValueScanner ahead = value_;
    const char command = ahead.letter();
    if (std::string_view("MmLlHhVvCcSsQqTtAaZz").find(command) == std::string_view::npos)
      value_.fail(fmt::format("one of the commands {}", kCommands));
    if (command_ == 0 && command != 'M' && command != 'm') value_.fail("a path that begins with M");
    value_ = ahead;
    command_ = command;
  }

  void draw() {
    const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(command_)));
    if (kind == 'Z') return close();
    if (kind == 'M') return move();
    if (!drawing_) pen_.point(at_);
    drawing_ = true;
    if (kind == 'A') arc();
    else if (kind == 'C' || kind == 'S') cubic(kind == 'S');
    else if (kind == 'Q' || kind == 'T') quadratic(kind == 'T');
    else line(kind);
    // Only S and T look back: each at the curve of its own kind that comes right before it.
    if (kind != 'C' && kind != 'S') before_cubic_ = at_;
    if (kind != 'Q' && kind != 'T') before_quadratic_ = at_;
  }

  void close() {
    pen_.end(true);
    at_ = before_cubic_ = before_quadratic_ = start_;
    drawing_ = false;
    command_ = 'z';
  }

  void move() {
    pen_.end(false);
    at_ = start_ = before_cubic_ = before_quadratic_ = pair();
    pen_.point(at_);
    drawing_ = true;
    command_ = is_relative() ? 'l' : 'L';  // coordinates that follow without a command are lines
  }

  void line(char kind) {
    const Vec2d base = is_relative() ? at_ : Vec2d(0.0, 0.0);
    if (kind != 'V') at_[0] = base[0] + value_.number("a number for x");
    if (kind != 'H') at_[1] = base[1] + value_.number("a number for y");
    pen_.point(at_);
  }

  void cubic(bool smooth) {
    const Vec2d first = at_, second = smooth ? 2.0 * at_ - before_cubic_ : pair(), third = pair();
    at_ = pair();
    before_cubic_ = third;
    pen_.curve(SvgBezier{{first, second, third, at_}});
  }

  void quadratic(bool smooth) {
    const Vec2d first = at_, between = smooth ? 2.0 * at_ - before_quadratic_ : pair();
    at_ = pair();
    before_quadratic_ = between;
    pen_.curve(quadratic_curve(first, between, at_));
  }

  void arc() {
    const double rx = value_.number("a radius"), ry = value_.number("a radius"), turn = value_.number("an angle");
    const bool large = value_.flag(), sweep = value_.flag();
    const Vec2d first = at_;
    at_ = pair();
    if (first == at_) return;  // as SVG has it: nothing is drawn
    if (const auto curve = arc_between(first, at_, {rx, ry}, turn, large, sweep)) pen_.curve(*curve);
    else pen_.point(at_);
  }

  bool is_relative() const { return command_ >= 'a'; }

  /// The next two numbers as a point; those of relative commands count from the current point.
  Vec2d pair() {
    const double x = value_.number("a number for x"), y = value_.number("a number for y");
    return is_relative() ? Vec2d(at_[0] + x, at_[1] + y) : Vec2d(x, y);
  }

  SvgValueScanner value_;
  SvgPen& pen_;
  Vec2d at_{0.0, 0.0}, start_{0.0, 0.0};
  Vec2d before_cubic_{0.0, 0.0}, before_quadratic_{0.0, 0.0};  // what S and T reflect
  bool drawing_ = false;                                       // whether an outline has been begun
  char command_ = 0;
};

void draw_points(SvgValueScanner value, bool closed, SvgPen& pen) {
  while (!value.at_end()) {
    const double x = value.number("a number");
    pen.point({x, value.number("a number for y")});
  }
  pen.end(closed);
}

void draw_ellipse(const Vec2d& centre, const Vec2d& radii, SvgPen& pen) {
  if (!(radii[0] > 0 && radii[1] > 0)) return;
  pen.point({centre[0] + radii[0], centre[1]});
  for (int quarter = 0; quarter < 4; ++quarter)
    pen.curve(quarter_of_ellipse(centre, radii, quarter),
              quarter == 3 ? SvgPen::Ends::AtFirstPoint : SvgPen::Ends::There);
  pen.end(true);
}

void draw_rectangle(const Vec2d& corner, const Vec2d& size, const Vec2d& radii, SvgPen& pen) {
  if (!(size[0] > 0 && size[1] > 0)) return;
  const Vec2d far = corner + size;
  if (!(radii[0] > 0 && radii[1] > 0)) {
    for (const Vec2d& p : {corner, Vec2d(far[0], corner[1]), far, Vec2d(corner[0], far[1])}) pen.point(p);
    return pen.end(true);
  }
  const Vec2d inner = corner + radii, outer = far - radii;
  const bool is_wide = 2 * radii[0] < size[0], is_high = 2 * radii[1] < size[1];  // else sides have no straight part
  pen.point({inner[0], corner[1]});
  if (is_wide) pen.point({outer[0], corner[1]});
  pen.curve(quarter_of_ellipse({outer[0], inner[1]}, radii, 3));
  if (is_high) pen.point({far[0], outer[1]});
  pen.curve(quarter_of_ellipse(outer, radii, 0));
  if (is_wide) pen.point({inner[0], far[1]});
  pen.curve(quarter_of_ellipse({inner[0], outer[1]}, radii, 1));
  if (is_high) pen.point({corner[0], inner[1]});
  pen.curve(quarter_of_ellipse(inner, radii, 2), SvgPen::Ends::AtFirstPoint);
  pen.end(true);
}

/// A length that is 0 or more; none if the element has none, or 'auto'.
std::optional<double> size_of(const SvgDocument& document, const SvgElement& element, const char* name) {
  const std::string* const value = element.value(name);
  if (!value || *value == "auto") return std::nullopt;
  const double size = length_of(document, element, name);
  if (!(size >= 0))
    document.fail_at(element.begin, fmt::format("'{}' of 0 or more", name), fmt::format("'{}'", *value));
  return size;
}

/// The two radii of an element; one that it does not have is as the other one.
Vec2d radii_of(const SvgDocument& document, const SvgElement& element) {
  const auto rx = size_of(document, element, "rx"), ry = size_of(document, element, "ry");
  return {rx ? *rx : ry.value_or(0), ry ? *ry : rx.value_or(0)};
}

Vec2d lengths_of(const SvgDocument& document, const SvgElement& element, const char* first, const char* second) {
  const double x = length_of(document, element, first);
  return {x, length_of(document, element, second)};
}

}  // namespace

SvgValueScanner scan_value(const SvgDocument& document, const SvgElement& element, const std::string& value,
                           std::string what) {
  return {value, [&document, at = element.begin, what = std::move(what)](const std::string& expected,
                                                                         const std::string& found) {
            document.fail_at(at, expected, fmt::format("{} in {}", found, what));
          }};
}

double length_of(const SvgDocument& document, const SvgElement& element, const char* name) {
  const std::string* const value = element.value(name);
  return value ? scan_value(document, element, *value, fmt::format("'{}'", name)).length() : 0;
}

void draw_outline(const SvgDocument& document, const SvgElement& shape, SvgPen& pen) {
  const auto lengths = [&](const char* x, const char* y) { return lengths_of(document, shape, x, y); };
  switch (shape.kind) {
    case SvgKind::Path:
      if (const auto* const d = shape.value("d"))
        PathReader(scan_value(document, shape, *d, "a path's 'd'"), pen).run();
      return;
    case SvgKind::Polyline:
    case SvgKind::Polygon:
      if (const auto* const points = shape.value("points"))
        draw_points(scan_value(document, shape, *points, "a list of points"), shape.kind == SvgKind::Polygon, pen);
      return;
    case SvgKind::Line:
      pen.point(lengths("x1", "y1"));
      pen.point(lengths("x2", "y2"));
      return pen.end(false);
    case SvgKind::Rect: {
      const double width = size_of(document, shape, "width").value_or(0);
      const Vec2d size(width, size_of(document, shape, "height").value_or(0)), radii = radii_of(document, shape);
      return draw_rectangle(lengths("x", "y"), size, {std::min(radii[0], size[0] / 2), std::min(radii[1], size[1] / 2)},
                            pen);
    }
    case SvgKind::Circle: {
      const double radius = size_of(document, shape, "r").value_or(0);
      return draw_ellipse(lengths("cx", "cy"), {radius, radius}, pen);
    }
    case SvgKind::Ellipse:
      return draw_ellipse(lengths("cx", "cy"), radii_of(document, shape), pen);
    default:
      return;
  }
}

}  // namespace vdb_offset::io
