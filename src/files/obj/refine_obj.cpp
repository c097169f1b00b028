// SPDX-License-Identifier: Apache-2.0
// Writes an OBJ file with the faces of a refinement. A first pass cuts the text into runs of lines, and notes what
// stands before each run, where the last line of each kind ends, and the texture coordinates of all corners. After that
// each run is made by itself, in any order. Added vertices, texture coordinates and normals are interpolated by the
// shares of their origin; corners share new ones if they share those at the origin's vertices. Indices that count back
// over added lines become plain numbers; every other line that does not describe a split face keeps its bytes. The
// first piece keeps the comment of its face. If corners name texture coordinates that are not there, pieces have none,
// which is named as a loss. Line elements are not split.
#include <algorithm>
#include <array>
#include <optional>

#include "bytes/append_number.h"
#include "bytes/line_records.h"
#include "bytes/obj_lines.h"
#include "derived/interpolate.h"
#include "derived/refine_writers.h"
#include "obj/obj_corners.h"
#include "obj/obj_document.h"

// The source's lines in their order. Behind the last `v`, `vt` and `vn` lines follow those that are added, so that all
// others keep their numbers; lines of faces that are split become lines of their pieces.
namespace vdb_offset::io {
namespace {

/// The lines that corners of faces refer to.
enum LineKind : std::size_t { kVLines, kVtLines, kVnLines, kLineKinds };
constexpr std::string_view kKeywords[kLineKinds] = {"v", "vt", "vn"};

/// How many lines of each kind, and how many faces, have been read.
struct ObjCounts {
  std::array<std::size_t, kLineKinds> lines{};
  std::size_t faces = 0;
};

std::size_t kind_of(const ObjLine& line) {
  return line.is("v") ? kVLines : line.is("vt") ? kVtLines : line.is("vn") ? kVnLines : kLineKinds;
}

/// How many words stand in front of those that refer to vertices; none in lines that do not.
std::optional<std::size_t> words_before_indices(const ObjLine& line) {
  if (line.is("f") || line.is("l") || line.is("p") || line.is("fo")) return 0;
  if (line.is("curv")) return 2;
  if (line.is("surf")) return 4;
  return std::nullopt;
}

/// What a refinement needs to know of the whole file.
struct ObjOverview {
  explicit ObjOverview(const MeshFile& source) : cuts(cut_at_lines(source.text(), 0)) {
    ObjCounts counts;
    corner_texture.reserve(source.polygons.corners.size());
    for (std::size_t run = 0; run + 1 < cuts.size(); ++run) {
      before.push_back(counts);
      const std::size_t begin = run == 0 ? byte_order_mark(source.text()) : cuts[run];
      for_each_obj_line(source.path, source.text(), begin, cuts[run + 1], [&](const ObjLine& line) {
        if (const std::size_t kind = kind_of(line); kind != kLineKinds) {
          ++counts.lines[kind];
          last_end[kind] = line.begin() + line.whole.size();
          if (kind == kVtLines) texture_at.push_back(line.words().position());
        } else if (line.is("f")) {
          ++counts.faces;
          for (Scanner words = line.words(); !words.at_line_end();) add_corner(words.token(), counts);
        }
      });
    }
    const auto is_known = [&](std::uint32_t t) { return t == kNone || t < texture_at.size(); };
    const auto is_none = [](std::uint32_t t) { return t == kNone; };
    names_unknown_texture = !std::all_of(corner_texture.begin(), corner_texture.end(), is_known);
    // There are other corners only if the file has changed meanwhile, which is found out in the end.
    if (corner_texture.size() != source.polygons.corners.size() ||
        std::all_of(corner_texture.begin(), corner_texture.end(), is_none))
      corner_texture = {};
  }

  std::vector<std::size_t> cuts;
  std::vector<ObjCounts> before;                   // of each run between two cuts: what stands in front of it
  std::array<std::size_t, kLineKinds> last_end{};  // of each kind: the byte behind the last line
  std::vector<std::uint64_t> texture_at;           // of each vt line: the byte behind the keyword
  std::vector<std::uint32_t> corner_texture;       // of each corner; empty if no corner has texture coordinates
  bool names_unknown_texture = false;              // some corner names texture coordinates that are not there

 private:
  void add_corner(std::string_view corner, const ObjCounts& counts) {
    const std::uint64_t number = texture_number(corner, counts.lines[kVtLines]);
    corner_texture.push_back(number == 0 ? kNone
                                         : static_cast<std::uint32_t>(std::min<std::uint64_t>(number, kNone) - 1));
  }
};

class ObjRefiner {
 public:
  explicit ObjRefiner(const SharedRefined& content)
      : content_(content),
        source_(content->source),
        text_(source_.text()),
        overview_(source_),
        line_end_(line_end_of(text_)),
        has_vertex_data_(std::find(source_.extras.begin(), source_.extras.end(), "vertex weights or colours") !=
                         source_.extras.end()) {
    if (!overview_.names_unknown_texture) texture_ = refine(overview_.corner_texture, overview_.texture_at.size());
    normals_ = refine(rows_of(source_).corner_normal, rows_of(source_).normal_at.size());
    for (std::size_t v = 0; has_vertex_data_ && v < rows_of(source_).position_at.size(); ++v)
      colours_.look_at(tail(v), kAll);
  }

  std::size_t runs() const { return overview_.before.size(); }
  bool loses_texture() const { return overview_.names_unknown_texture && !overview_.texture_at.empty(); }

  std::string run(std::size_t i) const {
    const std::size_t begin = i == 0 ? byte_order_mark(text_) : overview_.cuts[i];
    std::string text(text_.substr(overview_.cuts[i], begin - overview_.cuts[i]));
    ObjCounts at = overview_.before[i];
    for_each_obj_line(source_.path, text_, begin, overview_.cuts[i + 1], [&](const ObjLine& line) {
      // There are more faces only if the file has changed meanwhile, which is found out in the end.
      if (line.is("f") && at.faces < content_->mesh().face_count() && content_->is_split(at.faces))
        append_pieces(text, line, at);
      else append_with_same_indices(text, line, at);
      at.faces += line.is("f");
      const std::size_t kind = kind_of(line);
      if (kind == kLineKinds) return;
      ++at.lines[kind];
      if (line.begin() + line.whole.size() == overview_.last_end[kind]) append_added(text, kind);
    });
    return text;
  }

 private:
  static constexpr std::size_t kAll = ~std::size_t{0};

  RefinedCorners refine(std::span<const std::uint32_t> of_corner, std::size_t count) const {
    return refine_corners(content_->mesh(), content_->refinement, of_corner, count);
  }
  const VertexOrigin& origin(std::size_t added) const { return content_->refinement.added[added]; }
  Scanner scanner_at(std::uint64_t byte) const { return {source_.path, text_, byte, true, '#'}; }
  std::string_view word_at(std::uint64_t byte) const { return scanner_at(byte).token(); }
  /// What stands behind a vertex's coordinates.
  Scanner tail(std::size_t v) const {
    Scanner scanner = scanner_at(rows_of(source_).position_at[v].at[2]);
    scanner.token();
    return scanner;
  }

  std::size_t added_count(std::size_t kind) const {
    return kind == kVLines    ? content_->refinement.added.size()
           : kind == kVtLines ? texture_.added.size()
                              : normals_.added.size();
  }

  /// Appends the lines of a kind that are added.
  void append_added(std::string& text, std::size_t kind) const {
    // A backslash at the end of the text would join the next line.
    const auto goes_on = [&] { return !text.ends_with('\n') || text.ends_with("\\\n") || text.ends_with("\\\r\n"); };
    while (added_count(kind) > 0 && goes_on()) text += line_end_;
    for (std::size_t i = 0; i < added_count(kind); ++i) {
      text += kKeywords[kind];
      if (kind == kVLines) append_vertex(text, i);
      else if (kind == kVtLines) append_texture(text, texture_.added[i]);
      else append_normal(text, normals_.added[i]);
      // So would that of a word which is no number; a blank behind it keeps the lines apart, as it did in the source.
      if (text.ends_with('\\')) text += ' ';
      text += line_end_;
    }
  }
  void append_vertex(std::string& text, std::size_t added) const {
    const Vec3d& position = content_->added_position(added);
    for (int k = 0; k < 3; ++k) append_number(text += ' ', position[k], source_.precision);
    if (!has_vertex_data_) return;
    const auto tails = at_origin(origin(added), [&](std::uint32_t v) { return tail(v); });
    append_interpolated_words(text, origin(added), tails, colours_.are_bytes() ? kAll : 0);
  }
  void append_texture(std::string& text, const RefinedCorners::Between& between) const {
    const auto words = [&](std::size_t k) {
      return scanner_at(between.of[k] == kNone ? text_.size() : overview_.texture_at[between.of[k]]);
    };
    append_interpolated_words(text, origin(between.added), {words(0), words(1), words(2)});
  }
  void append_normal(std::string& text, const RefinedCorners::Between& between) const {
    std::array<std::array<std::string_view, 3>, 3> words;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; between.of[k] != kNone && i < 3; ++i)
        words[k][i] = word_at(rows_of(source_).normal_at[between.of[k]].at[i]);
    append_interpolated_normal(text, origin(between.added), words);
  }

  /// Appends the pieces of a face, the first with the comment behind it.
  void append_pieces(std::string& text, const ObjLine& line, const ObjCounts& at) const {
    const PolygonView refined = content_->refined();
    Scanner words = line.words();
    while (!words.at_line_end()) words.token();
    std::string_view comment = line.whole.substr(words.position() - line.begin());
    comment = comment.substr(0, comment.find_first_of("\r\n"));
    for (std::uint32_t piece = content_->first_piece[at.faces]; piece < content_->first_piece[at.faces + 1]; ++piece) {
      text += 'f';
      for (std::uint32_t c = refined.face_begin[piece]; c < refined.face_begin[piece + 1]; ++c)
        append_corner(text, std::uint64_t{refined.corners[c]} + 1, number_of(texture_, c), number_of(normals_, c));
      if (!comment.empty()) (text += ' ') += comment;
      comment = {};
      text += line_end_;
    }
  }
  /// The number, from 1 on, of a corner's texture coordinates or normal; 0 if it has none.
  static std::uint64_t number_of(const RefinedCorners& values, std::size_t corner) {
    if (values.of_corner.empty() || values.of_corner[corner] == kNone) return 0;
    return std::uint64_t{values.of_corner[corner]} + 1;
  }

  /// Appends a line as it is, but for indices that count back over lines that are added: these become plain numbers.
  void append_with_same_indices(std::string& text, const ObjLine& line, const ObjCounts& at) const {
    std::array<bool, kLineKinds> moves{};
    for (std::size_t kind = 0; kind < kLineKinds; ++kind)
      moves[kind] = added_count(kind) > 0 && line.begin() >= overview_.last_end[kind];
    const auto before = words_before_indices(line);
    if (!before || moves == std::array<bool, kLineKinds>{} || line.whole.find('-') == std::string_view::npos) {
      text += line.whole;
      return;
    }
    Scanner words = line.words();
    std::size_t copied = line.begin();
    for (std::size_t i = 0; !words.at_line_end(); ++i) {
      const std::string_view word = words.token();
      if (i < *before) continue;
      text += text_.substr(copied, words.last_token() - copied);
      append_index(text, word, moves, at);
      copied = words.position();
    }
    text += text_.substr(copied, line.begin() + line.whole.size() - copied);
  }
  static void append_index(std::string& text, std::string_view word, const std::array<bool, kLineKinds>& moves,
                           const ObjCounts& at) {
    for (std::size_t kind = 0; kind < kLineKinds; ++kind) {
      const std::size_t slash = std::min(word.find('/'), word.size());
      std::int64_t number = 0;
      const bool counts_back = moves[kind] && parse_integer(word.substr(0, slash), number) && number < 0;
      if (counts_back) number += static_cast<std::int64_t>(at.lines[kind]) + 1;
      if (counts_back && number > 0) append_integer(text, static_cast<std::uint64_t>(number));
      else text += word.substr(0, slash);
      if (slash == word.size()) return;
      text += '/';
      word.remove_prefix(slash + 1);
    }
    text += word;
  }

  SharedRefined content_;
  const MeshFile& source_;
  std::string_view text_;
  ObjOverview overview_;
  std::string_view line_end_;
  bool has_vertex_data_;
  RefinedCorners texture_, normals_;
  ByteColours colours_;
};

}  // namespace

Pieces ObjRows::refined(const std::shared_ptr<const RefinedContent>& content, std::vector<std::string>& lost) const {
  const auto refiner = std::make_shared<const ObjRefiner>(content);
  if (refiner->loses_texture())
    lost.emplace_back("texture coordinates of pieces (some faces name ones that are not there)");
  return {refiner->runs(), [=](std::size_t i) { return refiner->run(i); }};
}

}  // namespace vdb_offset::io
