#include "vdb_offset/io/curve/svg.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <functional>
#include <memory>
#include <utility>

#include "vdb_offset/base/memory.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/base/append_number.h"
#include "vdb_offset/io/base/line_records.h"
#include "vdb_offset/io/base/scanner.h"

namespace vdb_offset::io {
namespace {

constexpr double kDegree = 0.017453292519943295;

/// x' = a x + c y + e, y' = b x + d y + f.
using Matrix = std::array<double, 6>;
constexpr Matrix kIdentity = {1, 0, 0, 1, 0, 0};

/// First `inner`, then `outer`.
Matrix product(const Matrix& outer, const Matrix& inner) {
  const auto& [a, b, c, d, e, f] = outer;
  return {a * inner[0] + c * inner[1], b * inner[0] + d * inner[1],     a * inner[2] + c * inner[3],
          b * inner[2] + d * inner[3], a * inner[4] + c * inner[5] + e, b * inner[4] + d * inner[5] + f};
}

double determinant(const Matrix& m) { return m[0] * m[3] - m[1] * m[2]; }

/// Whether what it does to a drawing can be undone in doubles.
bool has_inverse(const Matrix& m) {
  constexpr double kLeastSize = 1e-100, kLeastShare = 1e-12;
  const double size = m[0] * m[0] + m[1] * m[1] + m[2] * m[2] + m[3] * m[3];
  return size > kLeastSize && size < 1 / kLeastSize && std::abs(determinant(m)) > kLeastShare * size &&
         std::isfinite(m[4]) && std::isfinite(m[5]);
}

Vec3d transformed(const Matrix& m, const Vec2d& p) {
  return {m[0] * p[0] + m[2] * p[1] + m[4], m[1] * p[0] + m[3] * p[1] + m[5], 0};
}

Vec2d transformed_back(const Matrix& m, const Vec3d& p) {
  const double x = p[0] - m[4], y = p[1] - m[5], det = determinant(m);
  return {(m[3] * x - m[2] * y) / det, (m[0] * y - m[1] * x) / det};
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }

/// Walks over the value of an attribute.
class ValueScanner {
 public:
  /// `fail(expected, found)` throws.
  ValueScanner(std::string_view value, std::function<void(const std::string&, const std::string&)> fail)
      : value_(value), fail_(std::move(fail)) {}

  bool at_end() {
    while (at_ < value_.size() && (is_space(value_[at_]) || value_[at_] == ',')) ++at_;
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

  /// What stands before the next "(", and that.
  std::string_view function_name() {
    const std::size_t open = value_.find('(', at_);
    if (open == std::string_view::npos) fail("a transform such as 'translate(1 2)'");
    std::string_view name = value_.substr(at_, open - at_);
    while (!name.empty() && is_space(name.back())) name.remove_suffix(1);
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

Matrix parse_function(ValueScanner& value, std::string_view name) {
  std::vector<double> n;
  while (!value.close()) n.push_back(value.number("a number or ')' in a transform"));
  const auto given = [&](std::initializer_list<std::size_t> counts) {
    return std::find(counts.begin(), counts.end(), n.size()) != counts.end();
  };
  if (name == "matrix" && given({6})) return {n[0], n[1], n[2], n[3], n[4], n[5]};
  if (name == "translate" && given({1, 2})) return {1, 0, 0, 1, n[0], n.size() > 1 ? n[1] : 0};
  if (name == "scale" && given({1, 2})) return {n[0], 0, 0, n.back(), 0, 0};
  if (name == "skewX" && given({1})) return {1, 0, std::tan(n[0] * kDegree), 1, 0, 0};
  if (name == "skewY" && given({1})) return {1, std::tan(n[0] * kDegree), 0, 1, 0, 0};
  if (name != "rotate" || !given({1, 3}))
    value.fail(fmt::format("a transform that SVG knows, not '{}' of {} numbers, before here", name, n.size()));
  const double c = std::cos(n[0] * kDegree), s = std::sin(n[0] * kDegree);
  const Matrix turn = {c, s, -s, c, 0, 0};
  if (n.size() == 1) return turn;
  return product(product({1, 0, 0, 1, n[1], n[2]}, turn), {1, 0, 0, 1, -n[1], -n[2]});
}

/// Whether a list of CSS declarations has one that moves the element.
bool has_transform(std::string_view style) {
  while (!style.empty()) {
    std::string_view name = style.substr(0, style.find(';'));
    style.remove_prefix(std::min(name.size() + 1, style.size()));
    name = name.substr(0, name.find(':'));
    while (!name.empty() && is_space(name.front())) name.remove_prefix(1);
    while (!name.empty() && is_space(name.back())) name.remove_suffix(1);
    for (const char* const moving : {"transform", "translate", "rotate", "scale"})
      if (name == moving) return true;
  }
  return false;
}

Matrix parse_transform(ValueScanner value) {
  Matrix all = kIdentity;
  while (!value.at_end()) {
    const std::string_view name = value.function_name();
    all = product(all, parse_function(value, name));
  }
  return all;
}

/// Reads a drawing as expat comes by its elements.
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
    constexpr std::size_t kChunk = 1 << 26;
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
    Matrix to_drawing;
    bool shown;
  };
  // Between the namespace of an element and its name.
  static constexpr char kNamespaceEnd = '|';

  /// No exception may pass through expat.
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

  ValueScanner scan(const char* value, const char* what) const {
    return {value, [this, what](const std::string& expected, const std::string& found) {
              fail_at(here(), expected, fmt::format("{} in {}", found, what));
            }};
  }

  void begin(std::string_view name, const char** attributes) {
    Element element = open_.empty() ? Element{kIdentity, true} : open_.back();
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
  void look_at(std::string_view name, const Matrix& to_drawing, const ValueOf& value_of) {
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

  /// Also called for an empty element that begin() has failed at.
  void end() {
    if (!thrown_) open_.pop_back();
  }

  /// The bytes of an attribute of the tag that expat is at, and has found well-formed.
  std::pair<std::uint64_t, std::uint64_t> find_value(std::string_view wanted) const {
    std::size_t at = here() + 1;
    const std::size_t end = here() + static_cast<std::size_t>(XML_GetCurrentByteCount(parser_.get()));
    const auto skip = [&](auto&& while_so) {
      while (at < end && while_so(text_[at])) ++at;
    };
    skip([](char c) { return !is_space(c); });
    while (at < end) {
      skip(is_space);
      const std::size_t name = at;
      skip([](char c) { return c != '=' && !is_space(c); });
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

  /// Relative coordinates add up to where a curve began but for rounding.
  void join_ends(std::uint32_t first) {
    constexpr double kRounding = 1e-13;
    double largest = 0;
    for (std::size_t p = first; p < lines_.own.size(); ++p)
      for (int k = 0; k < 2; ++k) largest = std::max(largest, std::abs(lines_.own[p][k]));
    if (!((lines_.own.back() - lines_.own[first]).length() <= kRounding * largest)) return;
    lines_.own.back() = lines_.own[first];
    lines_.curves.positions.back() = lines_.curves.positions[first];
  }

  /// A curve that ends where it begins is closed as it is.
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

  void read_points(ValueScanner value, bool closed) {
    while (!value.at_end()) {
      const double x = value.number("a number");
      add_point({x, value.number("a number for y")});
    }
    end_curve(closed);
  }

  void read_path(ValueScanner value) {
    Vec2d at(0.0, 0.0), start(0.0, 0.0);
    bool drawing = false;  // a curve has been begun
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
      command = relative ? 'l' : 'L';  // what follows without a command
    }
    end_curve(false);
  }

  static char take_command(ValueScanner& value, char before) {
    ValueScanner ahead = value;
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
  Matrix to_drawing_ = kIdentity;
  SvgLines lines_;
  MemoryWatch held_{path_, sizeof(Vec3d) + sizeof(Vec2d) + sizeof(std::uint32_t)};
};

void append_point(std::string& text, const Vec2d& p, const Rounding& precision = {}) {
  append_number(text, precision(p[0]), precision);
  append_number(text += ',', precision(p[1]), precision);
}

/// A point as its shape has it. Digits are those of the drawing's coordinates, on which results are judged: undoing a
/// transform takes all there are.
void append_own(std::string& text, const Matrix& to_drawing, const Vec3d& position, const Rounding& precision) {
  if (to_drawing == kIdentity) append_point(text, {position[0], position[1]}, precision);
  else append_point(text, transformed_back(to_drawing, precision(position)));
}

}  // namespace

SvgLines parse_svg(const std::string& path, std::string_view text) { return SvgReader(path, text).run(); }

std::string patch_svg(std::string_view text, const SvgLines& lines, CurvesView source, std::span<const Vec3d> positions,
                      const Rounding& precision) {
  std::string patched;
  std::size_t copied = 0, curve = 0;
  const auto has_moved = [&](std::uint32_t p) { return positions[p] != source.positions[p]; };
  for (const SvgLines::Shape& shape : lines.shapes) {
    const std::size_t first = curve;
    curve += shape.curves;
    const auto corners =
        source.corners.subspan(source.face_begin[first], source.face_begin[curve] - source.face_begin[first]);
    if (std::none_of(corners.begin(), corners.end(), has_moved)) continue;
    patched.append(text, copied, shape.begin - copied);
    copied = shape.end;
    for (std::size_t c = first; c < curve; ++c) {
      const auto points = source.face(c);
      const bool repeats = points.size() > 1 && points.back() == points.front();
      if (c > first) patched += ' ';
      for (std::size_t k = 0; k < points.size() - repeats; ++k) {
        if (k > 0) patched += ' ';
        if (shape.is_path) patched += k == 0 ? 'M' : 'L';
        const std::uint32_t p = points[k];
        if (has_moved(p)) append_own(patched, shape.to_drawing, positions[p], precision);
        else append_point(patched, lines.own[p]);
      }
      if (shape.is_path && lines.closed[c]) patched += " Z";
    }
  }
  return patched.append(text, copied);
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
