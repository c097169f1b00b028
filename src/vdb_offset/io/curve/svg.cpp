// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/curve/svg.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <utility>

#include "vdb_offset/base/assert.h"
#include "vdb_offset/base/memory.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/base/append_number.h"
#include "vdb_offset/io/base/line_records.h"
#include "vdb_offset/io/base/scanner.h"
#include "vdb_offset/io/curve/svg_transform.h"

namespace vdb_offset::io {
namespace {

/// Reads a drawing, called by expat for the beginning and the end of each element.
class SvgReader {
 public:
  SvgReader(const std::string& path, std::string_view text)
      : path_(path), text_(text), parser_(XML_ParserCreateNS(nullptr, kNamespaceEnd), XML_ParserFree) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const char* name, const char** attributes) {
          static_cast<SvgReader*>(self)->guarded([&](SvgReader& reader) { reader.begin(name, attributes); });
        },
        [](void* self, const char*) { static_cast<SvgReader*>(self)->end(); });
  }

  SvgLines run() {
    for (const char* const mark : {"\xff\xfe", "\xfe\xff"})
      if (text_.starts_with(mark)) fail_at(0, "a drawing in UTF-8", "UTF-16");
    constexpr std::size_t kChunk = 1 << 26;  // bytes that expat gets at a time: it counts them in an int
    for (std::size_t at = 0; at < text_.size() || at == 0; at += kChunk) {
      const std::string_view chunk = text_.substr(at, kChunk);
      const bool last = at + kChunk >= text_.size();
      if (XML_Parse(parser_.get(), chunk.data(), static_cast<int>(chunk.size()), last) == XML_STATUS_OK) continue;
      if (thrown_) std::rethrow_exception(thrown_);
      fail_at(here(), "XML", fmt::format("'{}'", XML_ErrorString(XML_GetErrorCode(parser_.get()))));
    }
    if (lines_.curves.face_count() == 0)
      fail_at(text_.size(), "a path, polyline or polygon with two points", "none in the drawing");
    return std::move(lines_);
  }

 private:
  struct Element {
    SvgMatrix to_drawing;
    bool shown;
  };
  // What expat puts between the namespace of an element and its name.
  static constexpr char kNamespaceEnd = '|';

  /// Calls act() and keeps what it throws: no exception may pass through expat, which is C.
  template <class Do>
  void guarded(Do&& act) {
    try {
      act(*this);
    } catch (...) {
      thrown_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  std::size_t here() const { return static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_.get())); }

  [[noreturn]] void fail_at(std::size_t at, const std::string& expected, const std::string& found) const {
    Scanner(path_, text_).fail_with(expected, found, std::min(at, text_.size()));
  }

  SvgValueScanner scan(const char* value, const char* what) const {
    return {value, [this, what](const std::string& expected, const std::string& found) {
              fail_at(here(), expected, fmt::format("{} in {}", found, what));
            }};
  }

  void begin(std::string_view name, const char** attributes) {
    Element element = open_.empty() ? Element{kSvgIdentity, true} : open_.back();
    if (const std::size_t end = name.rfind(kNamespaceEnd); end != std::string_view::npos) {
      element.shown = element.shown && name.substr(0, end) == "http://www.w3.org/2000/svg";
      name.remove_prefix(end + 1);
    }
    const auto value_of = [&](std::string_view wanted) -> const char* {
      for (const char** a = attributes; *a; a += 2)
        if (*a == wanted && std::string_view(a[1]) != "none") return a[1];
      return nullptr;
    };
    if (open_.empty() && (name != "svg" || !element.shown))
      fail_at(here(), "an element 'svg'", fmt::format("'{}'", name));
    for (const char* const hidden : {"defs", "clipPath", "mask", "marker", "pattern", "symbol"})
      element.shown = element.shown && name != hidden;
    if (const char* const transform = value_of("transform"); transform && element.shown)
      element.to_drawing = product(element.to_drawing, parse_transform(scan(transform, "a transform")));
    if (const char* const style = value_of("style"); style && element.shown && has_transform(style))
      fail_at(here(), "transforms that are attributes", "one in a style");
    if (element.shown) look_at(name, element.to_drawing, value_of);
    open_.push_back(element);
  }

  template <class ValueOf>
  void look_at(std::string_view name, const SvgMatrix& to_drawing, const ValueOf& value_of) {
    for (const char* const other : {"line", "rect", "circle", "ellipse", "use"})
      if (name == other) fail_at(here(), "paths, polylines and polygons alone", fmt::format("an element '{}'", name));
    if (name == "svg" && !open_.empty()) fail_at(here(), "one element 'svg'", "another one in it");
    const bool path = name == "path";
    if (!path && name != "polyline" && name != "polygon") return;
    const char* const attribute = path ? "d" : "points";
    const char* const value = value_of(attribute);
    if (!value) return;
    if (!has_inverse(to_drawing)) fail_at(here(), "a transform that can be undone", "one that flattens");
    const auto [first, last] = find_value(attribute);
    const std::size_t before = lines_.curves.face_count();
    to_drawing_ = to_drawing;
    if (path) read_path(scan(value, "a path's 'd'"));
    else read_points(scan(value, "a list of points"), name == "polygon");
    lines_.shapes.push_back({first, last, path, to_drawing, lines_.curves.face_count() - before});
  }

  /// Ends an element. expat also calls it for an empty element for which begin() has failed.
  void end() {
    if (!thrown_) open_.pop_back();
  }

  /// Where the value of an attribute begins and ends, in the tag that expat is at. expat has checked the tag's form.
  std::pair<std::uint64_t, std::uint64_t> find_value(std::string_view wanted) const {
    std::size_t at = here() + 1;
    const std::size_t end = here() + static_cast<std::size_t>(XML_GetCurrentByteCount(parser_.get()));
    const auto skip = [&](auto&& while_so) {
      while (at < end && while_so(text_[at])) ++at;
    };
    skip([](char c) { return !is_svg_space(c); });
    while (at < end) {
      skip(is_svg_space);
      const std::size_t name = at;
      skip([](char c) { return c != '=' && !is_svg_space(c); });
      const bool found = text_.substr(name, at - name) == wanted;
      skip([](char c) { return c != '"' && c != '\''; });
      if (at >= end) break;
      const char quote = text_[at++];
      const std::size_t value = at;
      skip([&](char c) { return c != quote; });
      if (found) return {value, at};
      ++at;
    }
    fail_at(here(), fmt::format("an attribute '{}' in the element itself", wanted), "one that a DTD declares");
  }

  void add_point(const Vec2d& p) {
    auto& curves = lines_.curves;
    const Vec3d position = transformed(to_drawing_, p);
    if (!std::isfinite(position[0]) || !std::isfinite(position[1]))
      fail_at(here(), "coordinates that are numbers", "larger ones");
    curves.corners.push_back(static_cast<std::uint32_t>(curves.positions.size()));
    curves.positions.push_back(position);
    held_.add();
    lines_.own.push_back(p);
  }

  /// Joins the last point of a curve to its first one if only rounding keeps them apart, as the sum of relative
  /// coordinates does.
  void join_ends(std::uint32_t first) {
    constexpr double kRounding = 1e-13;  // share of the largest coordinate: the rounding of a thousand sums
    double largest = 0;
    for (std::size_t p = first; p < lines_.own.size(); ++p)
      for (int k = 0; k < 2; ++k) largest = std::max(largest, std::abs(lines_.own[p][k]));
    if (!((lines_.own.back() - lines_.own[first]).length() <= kRounding * largest)) return;
    lines_.own.back() = lines_.own[first];
    lines_.curves.positions.back() = lines_.curves.positions[first];
  }

  /// Ends a curve. A curve that ends where it begins is closed anyway.
  void end_curve(bool closed) {
    auto& curves = lines_.curves;
    const std::size_t first = curves.face_begin.back();
    if (curves.corners.size() == first) return;
    if (curves.corners.size() > first + 2) join_ends(curves.corners[first]);
    if (closed && lines_.own[curves.corners[first]] != lines_.own.back() && curves.corners.size() > first + 1)
      curves.corners.push_back(curves.corners[first]);
    curves.close_face();
    lines_.closed.push_back(closed);
  }

  void read_points(SvgValueScanner value, bool closed) {
    while (!value.at_end()) {
      const double x = value.number("a number");
      add_point({x, value.number("a number for y")});
    }
    end_curve(closed);
  }

  void read_path(SvgValueScanner value) {
    Vec2d at(0.0, 0.0), start(0.0, 0.0);
    bool drawing = false;  // whether a curve has been begun
    char command = 0;
    while (!value.at_end()) {
      if (!value.at_number()) command = take_command(value, command);
      else if (command == 0 || command == 'z') value.fail("one of the commands M, L, H, V and Z");
      const bool relative = command >= 'a';
      if (command == 'Z' || command == 'z') {
        end_curve(true);
        at = start;
        drawing = false;
        command = 'z';
        continue;
      }
      const bool moves = command == 'M' || command == 'm';
      if (moves) end_curve(false);
      else if (!drawing) add_point(at);
      drawing = true;
      const Vec2d base = relative ? at : Vec2d(0.0, 0.0);
      if (command != 'V' && command != 'v') at[0] = base[0] + value.number("a number for x");
      if (command != 'H' && command != 'h') at[1] = base[1] + value.number("a number for y");
      add_point(at);
      if (!moves) continue;
      start = at;
      command = relative ? 'l' : 'L';  // coordinates that follow without a command are lines
    }
    end_curve(false);
  }

  static char take_command(SvgValueScanner& value, char before) {
    SvgValueScanner ahead = value;
    const char command = ahead.letter();
    if (std::string_view("MmLlHhVvZz").find(command) == std::string_view::npos)
      value.fail("straight segments (M, L, H, V, Z)");
    if (before == 0 && command != 'M' && command != 'm') value.fail("a path that begins with M");
    value = ahead;
    return command;
  }

  const std::string& path_;
  std::string_view text_;
  std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_;
  std::exception_ptr thrown_;
  std::vector<Element> open_;
  SvgMatrix to_drawing_ = kSvgIdentity;
  SvgLines lines_;
  MemoryWatch held_{path_, sizeof(Vec3d) + sizeof(Vec2d) + sizeof(std::uint32_t)};
};

void append_point(std::string& text, const Vec2d& p, const Rounding& precision = {}) {
  append_number(text, precision(p[0]), precision);
  append_number(text += ',', precision(p[1]), precision);
}

/// Appends a point in the coordinates of its shape. Without a transform, it has the digits of the precision, as results
/// are judged on these. With one, it has all digits, so that the point of the drawing is as exact.
void append_own(std::string& text, const SvgMatrix& to_drawing, const Vec3d& position, const Rounding& precision) {
  if (to_drawing == kSvgIdentity) append_point(text, {position[0], position[1]}, precision);
  else append_point(text, transformed_back(to_drawing, precision(position)));
}

/// The points of a drawing, of which some have moved.
struct MovedPoints {
  const SvgLines& lines;
  const CurvesView& source;
  std::span<const Vec3d> positions;
  const Rounding& precision;

  bool has_moved(std::uint32_t p) const { return positions[p] != source.positions[p]; }
  /// Whether a point of the curves first .. end - 1 has moved.
  bool any_of_curves(std::size_t first, std::size_t end) const {
    const auto corners =
        source.corners.subspan(source.face_begin[first], source.face_begin[end] - source.face_begin[first]);
    return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t p) { return has_moved(p); });
  }
  /// Appends the points of one of a shape's curves, as a part of the attribute that holds them.
  void append_curve(std::string& text, const SvgLines::Shape& shape, std::size_t curve) const {
    const auto points = source.face(curve);
    const bool repeats = points.size() > 1 && points.back() == points.front();
    for (std::size_t k = 0; k < points.size() - repeats; ++k) {
      if (k > 0) text += ' ';
      if (shape.is_path) text += k == 0 ? 'M' : 'L';
      const std::uint32_t p = points[k];
      if (has_moved(p)) append_own(text, shape.to_drawing, positions[p], precision);
      else append_point(text, lines.own[p]);
    }
    if (shape.is_path && lines.closed[curve]) text += " Z";
  }
};

}  // namespace

SvgLines parse_svg(const std::string& path, std::string_view text) { return SvgReader(path, text).run(); }

std::string rewrite_svg(std::string_view text, const SvgLines& lines, CurvesView source,
                        std::span<const Vec3d> positions, const Rounding& precision) {
  VDB_OFFSET_ASSERT(positions.size() == source.positions.size());
  const MovedPoints moved{lines, source, positions, precision};
  std::string rewritten;
  std::size_t copied = 0, curve = 0;
  for (const SvgLines::Shape& shape : lines.shapes) {
    const std::size_t first = curve;
    curve += shape.curves;
    if (!moved.any_of_curves(first, curve)) continue;
    rewritten.append(text, copied, shape.begin - copied);
    copied = shape.end;
    for (std::size_t c = first; c < curve; ++c) {
      if (c > first) rewritten += ' ';
      moved.append_curve(rewritten, shape, c);
    }
  }
  return rewritten.append(text, copied);
}

std::string as_svg(CurvesView curves, const Rounding& precision) {
  Vec2d lower(0.0, 0.0), upper(0.0, 0.0);
  for (std::size_t i = 0; i < curves.corners.size(); ++i) {
    const Vec3d& p = curves.positions[curves.corners[i]];
    if (p[2] != 0)
      throw InvalidInput(
          fmt::format("SVG: expected curves in the plane z = 0, got z = {} at point {}", p[2], curves.corners[i]));
    for (int k = 0; k < 2; ++k) {
      lower[k] = i == 0 ? p[k] : std::min(lower[k], p[k]);
      upper[k] = i == 0 ? p[k] : std::max(upper[k], p[k]);
    }
  }
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"";
  for (const double n : {lower[0], lower[1], upper[0] - lower[0]}) append_number(text, n), text += ' ';
  append_number(text, upper[1] - lower[1]);
  text += "\" fill=\"none\" stroke=\"black\" stroke-width=\"";
  append_number(text, std::max(upper[0] - lower[0], upper[1] - lower[1]) / 500);
  text += "\">\n";
  for (std::size_t c = 0; c < curves.face_count(); ++c) {
    const auto points = curves.face(c);
    const bool closed = points.size() > 3 && curves.positions[points.back()] == curves.positions[points.front()];
    text += "<path d=\"";
    for (std::size_t k = 0; k < points.size() - closed; ++k) {
      text += k == 0 ? "M" : " L";
      const Vec3d& p = curves.positions[points[k]];
      append_point(text, {p[0], p[1]}, precision);
    }
    text += closed ? " Z\"/>\n" : "\"/>\n";
  }
  return text += "</svg>\n";
}

}  // namespace vdb_offset::io
