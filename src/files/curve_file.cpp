// SPDX-License-Identifier: Apache-2.0
// Reads and writes files of plane curves. Texts have a point a line and a blank line between curves; airfoils in
// Lednicer's order become one curve. OBJ files have line elements, whose indices may count back or ahead. SVG and DXF
// drawings are read and rewritten by folders of their own. The reader notes where each coordinate stands: in the format
// of the source every byte of a text or an OBJ file stays but for coordinates that changed, and in a drawing all bytes
// but those of what moved. Another format gets a new file with the points of each curve in order. An OBJ file holds
// curves if it has line elements and no faces. Whether curves lie in one plane, and which of them meet, is not looked
// at here.
#include "vdb_offset/io/curve_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "bytes/append_number.h"
#include "bytes/chunked_output.h"
#include "bytes/compression.h"
#include "bytes/obj_lines.h"
#include "bytes/scanner.h"
#include "document/require_format.h"
#include "document/rows.h"
#include "dxf/dxf.h"
#include "ground/system/memory.h"
#include "svg/svg.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

/// Walks over the lines of a text, without their line ends.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text), next_(byte_order_mark(text)) {}
  bool next() {
    if (next_ >= text_.size()) return false;
    begin_ = next_;
    const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
    line_ = text_.substr(begin_, end - begin_);
    next_ = end + 1;
    return true;
  }
  std::size_t begin() const { return begin_; }
  std::string_view line() const { return line_; }

 private:
  std::string_view text_, line_;
  std::size_t next_, begin_ = 0;
};

constexpr char kComment = '#';

/// The words of a line up to a comment: their number, and whether all of them are numbers.
struct Words {
  int count = 0;
  bool numbers = true;
};

Words words_of(const std::string& path, std::string_view line) {
  Words words;
  Scanner scanner(path, line, 0, false, kComment);
  double value = 0;
  for (std::string_view word = scanner.token(); !word.empty(); word = scanner.token()) {
    ++words.count;
    words.numbers = words.numbers && parse_double(word, value);
  }
  return words;
}

/// Reads plain text, curve by curve.
class TextParser {
 public:
  TextParser(CurveFile& curves, Rows& rows) : curves_(curves), file_(curves.file), rows_(rows) {}

  void run() {
    for (Lines lines(file_.text()); lines.next();) take(lines);
    end_curve();
    join_airfoil();
    if (file_.polygons.positions.empty())
      Scanner(file_.path, file_.text()).fail("at least one line 'x y'", file_.text().size());
    rows_.position_at = ByteOffsets(std::move(at_));
  }

 private:
  void take(const Lines& lines) {
    const std::string_view line = lines.line();
    if (const std::size_t comment = line.find(kComment); comment != std::string_view::npos && begins_curve())
      closed_ = closed_ || line.substr(comment).find("closed") != std::string_view::npos;
    const Words words = words_of(file_.path, line);
    const bool point = words.numbers && (words.count == 2 || words.count == 3);
    if (words.count == 0 && line.find(kComment) == std::string_view::npos) return end_curve();
    if (words.count == 0) return;
    if (!point && !titled_ && file_.polygons.positions.empty()) {
      titled_ = true;
      return;
    }
    add_point(lines.begin(), words.count);
  }

  bool begins_curve() const { return file_.polygons.corners.size() == file_.polygons.face_begin.back(); }

  void add_point(std::size_t begin, int words) {
    Scanner scanner(file_.path, file_.text(), begin, false, kComment);
    auto& positions = file_.polygons.positions;
    held_.add();
    if (positions.empty()) curves_.planar = words == 2;
    Vec3d p(0.0);
    NumberTriple& at = at_.emplace_back();
    const int count = curves_.planar ? 2 : 3;
    for (int k = 0; k < count; ++k) p[k] = scanner.number("a coordinate", &at.at[k]);
    if (curves_.planar) at.at[2] = at.at[1];
    if (!scanner.at_line_end()) scanner.fail(fmt::format("{} coordinates, as in the lines before", count));
    file_.polygons.corners.push_back(static_cast<std::uint32_t>(positions.size()));
    positions.push_back(p);
  }

  void end_curve() {
    auto& corners = file_.polygons.corners;
    if (begins_curve()) return;
    const std::size_t first = file_.polygons.face_begin.back();
    if (closed_ && corners.size() > first + 1) corners.push_back(corners[first]);
    closed_ = false;
    file_.polygons.close_face();
  }

  /// Joins the two curves of an airfoil in Lednicer's format: a line with two counts, the points of the upper side,
  /// then those of the lower side.
  void join_airfoil() {
    Polygons& read = file_.polygons;
    if (!titled_ || !curves_.planar || read.positions.size() < 5) return;
    const Vec3d counts = read.positions.front();
    const auto upper = static_cast<std::size_t>(std::max(0.0, std::min(counts[0], 1e9))),
               lower = static_cast<std::size_t>(std::max(0.0, std::min(counts[1], 1e9)));
    if (upper < 2 || lower < 2 || static_cast<double>(upper) != counts[0] || static_cast<double>(lower) != counts[1] ||
        upper + lower + 1 != read.positions.size())
      return;
    read.positions.erase(read.positions.begin());
    at_.erase(at_.begin());
    read.corners.clear();
    read.face_begin = {0};
    for (std::size_t i = upper; i-- > 0;) read.corners.push_back(static_cast<std::uint32_t>(i));
    for (std::size_t i = 0; i < lower; ++i) read.corners.push_back(static_cast<std::uint32_t>(upper + i));
    read.close_face();
  }

  CurveFile& curves_;
  MeshFile& file_;
  Rows& rows_;
  std::vector<NumberTriple> at_;
  MemoryWatch held_{file_.path, sizeof(Vec3d) + sizeof(NumberTriple) + sizeof(std::uint32_t)};
  bool titled_ = false, closed_ = false;
};

/// Reads `v` lines and `l` elements; all other lines will be copied as they are.
class LineElementParser {
 public:
  LineElementParser(MeshFile& file, Rows& rows)
      : file_(file), rows_(rows), scanner_(file.path, file.text(), 0, true, kComment) {}

  void run() {
    for_each_obj_line(file_.path, file_.text(), [&](const ObjLine& line) {
      scanner_ = line.words();
      if (line.is("v")) file_.polygons.positions.push_back(scanner_.triple("a coordinate", at_.emplace_back()));
      else if (line.is("l")) element();
    });
    for (const auto& [index, at] : ahead_)
      if (index > file_.polygons.positions.size())
        scanner_.fail(fmt::format("a vertex index up to {}", file_.polygons.positions.size()), at);
    rows_.position_at = ByteOffsets(std::move(at_));
  }

 private:
  void element() {
    const std::size_t first = file_.polygons.corners.size();
    while (!scanner_.at_line_end()) {
      const std::string_view word = scanner_.token();
      const std::size_t at = scanner_.last_token();
      std::int64_t index = 0;
      const auto so_far = static_cast<std::int64_t>(file_.polygons.positions.size());
      if (!parse_integer(word.substr(0, word.find('/')), index) || index == 0 || index > 0x7fffffff)
        scanner_.fail("a vertex index from 1 on or below 0", at);
      if (index < 0) index += so_far + 1;
      if (index < 1) scanner_.fail(fmt::format("a vertex index within the {} read so far", so_far), at);
      if (index > so_far) ahead_.emplace_back(static_cast<std::uint64_t>(index), at);
      file_.polygons.corners.push_back(static_cast<std::uint32_t>(index - 1));
    }
    if (file_.polygons.corners.size() - first < 2) scanner_.fail("at least 2 points in a line element");
    file_.polygons.close_face();
  }

  MeshFile& file_;
  Rows& rows_;
  Scanner scanner_;
  std::vector<NumberTriple> at_;
  std::vector<std::pair<std::uint64_t, std::size_t>>
      ahead_;  // byte and index of vertices that had not been read yet where they were named
};

CurveFile parse_bytes(const std::string& name, CurveFormat format, FileBytes bytes, const CurveReading& how) {
  CurveFile curves;
  curves.format = format;
  curves.file.path = name;
  curves.file.bytes = std::move(bytes);
  if (curves.file.text().empty()) throw InvalidInput(name + ", byte 0: expected curves, got an empty file");
  const auto rows = std::make_shared<Rows>(Rows::Syntax{kComment, true});
  curves.file.document = rows;
  if (format != CurveFormat::Svg) rows->has_carriage_returns = use_line_feeds(curves.file);
  switch (format) {
    case CurveFormat::Text:
      TextParser(curves, *rows).run();
      break;
    case CurveFormat::Obj:
      LineElementParser(curves.file, *rows).run();
      break;
    case CurveFormat::Svg:
      parse_svg(curves, how);
      break;
    case CurveFormat::Dxf:
      parse_dxf(curves, how);
  }
  const Curves& read = curves.file.polygons;
  if (read.face_count() == 0) throw InvalidInput(name + ": expected an element 'l', got none");
  if (read.corners.size() == read.face_count())
    throw InvalidInput(
        fmt::format("{}: expected a curve of 2 points or more, got single points alone ({}), with empty "
                    "lines between them",
                    name, read.face_count()));
  return curves;
}

void append_curve_point(std::string& text, const Vec3d& p, int count, const Rounding& precision) {
  for (int k = 0; k < count; ++k) {
    if (k > 0) text += ' ';
    append_number(text, precision(p[k]), precision);
  }
  text += '\n';
}

std::string as_obj(CurvesView curves, const Rounding& precision) {
  std::string text;
  for (const Vec3d& p : curves.positions) append_curve_point(text += "v ", p, 3, precision);
  for (std::size_t c = 0; c < curves.face_count(); ++c) {
    if (curves.face(c).size() < 2) continue;  // an element has two points at least
    text += 'l';
    for (const auto p : curves.face(c)) append_integer(text += ' ', p + 1);
    text += '\n';
  }
  return text;
}

/// Curves as plain text: the points of each curve in order. A point of several curves is written for each of them.
std::string as_text(CurvesView curves, const Rounding& precision) {
  const bool planar = std::all_of(curves.corners.begin(), curves.corners.end(),
                                  [&](std::uint32_t p) { return curves.positions[p][2] == 0; });
  std::string text;
  for (std::size_t c = 0; c < curves.face_count(); ++c) {
    if (c > 0) text += '\n';
    for (const auto p : curves.face(c)) append_curve_point(text, curves.positions[p], planar ? 2 : 3, precision);
  }
  return text;
}

std::string as_file(CurveFormat format, CurvesView curves, const Rounding& precision) {
  return format == CurveFormat::Obj   ? as_obj(curves, precision)
         : format == CurveFormat::Svg ? as_svg(curves, precision)
         : format == CurveFormat::Dxf ? as_dxf(curves, precision)
                                      : as_text(curves, precision);
}

/// The format of a file of curves. \throw InvalidInput for an unknown ending
CurveFormat format_of_curves(const std::string& path) {
  const auto format = curve_format_of(path);
  if (!format) throw InvalidInput(path + ": expected a name that ends in .dat, .txt, .xy, .svg, .dxf or .obj");
  return *format;
}

}  // namespace

std::optional<CurveFormat> curve_format_of(std::string_view path) {
  path = without_compression(path);
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  const std::string_view ending = path.substr(dot + 1);
  if (is_word(ending, "obj")) return CurveFormat::Obj;
  if (is_word(ending, "svg")) return CurveFormat::Svg;
  if (is_word(ending, "dxf")) return CurveFormat::Dxf;
  for (const char* const text : {"dat", "txt", "xy"})
    if (is_word(ending, text)) return CurveFormat::Text;
  return std::nullopt;
}

bool holds_curves(const std::string& path) {
  const auto format = curve_format_of(path);
  if (format != CurveFormat::Obj) return format.has_value();
  // Compressed files and pipes are not looked into, as they cannot be read twice, or not cheaply.
  std::error_code unknown;
  if (without_compression(path) != path || !std::filesystem::is_regular_file(path, unknown)) return false;
  const FileBytes bytes = FileBytes::open(path);
  const std::string_view text = bytes.view();
  const auto has_line = [&](std::string_view start) {
    return text.starts_with(start) || text.rfind(fmt::format("\n{}", start)) != std::string_view::npos ||
           text.rfind("\r" + std::string(start)) != std::string_view::npos;
  };
  // The end of the file is searched: that is where a mesh has its faces.
  return !has_line("f ") && !has_line("f\t") && (has_line("l ") || has_line("l\t"));
}

std::optional<double> unit_of_curves(const std::string& path) {
  const auto format = curve_format_of(path);
  if (format != CurveFormat::Dxf && format != CurveFormat::Svg) return std::nullopt;
  MeshFile file;
  file.path = path;
  file.bytes = FileBytes::open(path);
  if (format == CurveFormat::Svg) return svg_unit_micrometres(SvgDocument(file.path, file.text()));
  use_line_feeds(file);
  return unit_of_dxf(DxfText(file.path, file.text()));
}

CurveFile read_curves(const std::string& path, const CurveReading& how) {
  return parse_bytes(path, format_of_curves(path), FileBytes::open(path), how);
}

CurveFile parse_curves(const std::string& name, CurveFormat format, std::string bytes, const CurveReading& how) {
  return parse_bytes(name, format, FileBytes(std::move(bytes)), how);
}

namespace {

Precision precision_of_new(const WriteOptions& options) {
  return options.digits > 0 ? Precision{Precision::Kind::Digits, options.digits} : Precision{};
}

}  // namespace

Precision precision_of_curves(const std::string& path, const CurveFile& source, const WriteOptions& options) {
  Precision precision = precision_of_new(options);
  const bool is_in_place =
      curve_format_of(path) == source.format && source.format != CurveFormat::Svg && source.format != CurveFormat::Dxf;
  precision.rounds_all = !is_in_place;
  return precision;
}

void write_curves(const std::string& path, CurvesView curves, const WriteOptions& options) {
  const CurveFormat format = format_of_curves(path);
  write_pieces(path, in_sections(as_file(format, curves, precision_of_new(options)), {}));
}

void write_curves(const std::string& path, const CurveFile& source, std::span<const Vec3d> positions,
                  const WriteOptions& options) {
  const CurveFormat format = format_of_curves(path);
  const Rounding precision = precision_of_curves(path, source, options);
  const Curves& read = source.file.polygons;
  const CurvesView moved{positions, read.corners, read.face_begin};
  const Pieces pieces =
      format != source.format ? in_sections(as_file(format, moved, precision), {})
      : format == CurveFormat::Svg
          ? in_sections(rewrite_svg(source.file.text(), *source.svg, read.view(), positions, precision), {})
      : format == CurveFormat::Dxf
          ? with_line_ends_of(source.file, in_sections(rewrite_dxf(source, positions, precision), {}))
          : rewrite_in_place(source.file, positions, precision);
  write_pieces_of(source.file.path, source.file.bytes, path, pieces);
}

}  // namespace vdb_offset::io
