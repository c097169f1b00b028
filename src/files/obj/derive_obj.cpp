// SPDX-License-Identifier: Apache-2.0
// Writes an OBJ file over a mesh that is made of its own. The text is cut into runs of lines, which are scanned in
// parallel for what stands before each run, for the statements in force there, and for the texture coordinates of all
// corners; after that each run is made by itself, in any order.
//
// Of a refinement, added vertices, texture coordinates and normals are interpolated by the shares of their origin;
// corners share new ones if they share those at the origin's vertices. They follow the last line of their kind, so that
// all others keep their numbers, and indices that count back over them become plain numbers. If corners name texture
// coordinates that are not there, pieces have none, which is named as a loss. Line elements are not split.
//
// Of a shell, the text with the positions of the outer skin comes first. Then follow the vertices of the inner skin,
// its faces, which are the source's reversed and name normals of their own, and the faces of the rim, with the texture
// coordinates of their border, no normals and no smoothing. Groups of faces get the name of their part in front.
// Statements such as materials are repeated where those in force would be others, and ended where a face had none.
// Lines and points join the inner skin if that alone is the source, else the outer one.
//
// Numbers and lines that do not change keep their text, and comments come once: the first face in the place of another
// has its comment.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <optional>

#include "bytes/append_number.h"
#include "bytes/line_records.h"
#include "bytes/obj_lines.h"
#include "bytes/scanner.h"
#include "derived/derived_mesh.h"
#include "derived/interpolate.h"
#include "derived/refined_corners.h"
#include "obj/obj_corners.h"
#include "obj/obj_document.h"
#include "obj/obj_runs.h"

namespace vdb_offset::io {
namespace {

constexpr std::size_t kAll = ~std::size_t{0};
constexpr std::string_view kKeywords[kLineKinds] = {"v", "vt", "vn"};

/// How many words stand in front of those that refer to vertices; none in lines that do not.
std::optional<std::size_t> words_before_indices(const ObjLine& line) {
  if (line.is("f") || line.is("l") || line.is("p") || line.is("fo")) return 0;
  if (line.is("curv")) return 2;
  if (line.is("surf")) return 4;
  return std::nullopt;
}

/// Appends a g line: the name of the part, then the names of the source's line.
void append_group(std::string& text, const ObjLine& line, ShellPart part) {
  const auto names = static_cast<std::size_t>(line.keyword.end() - line.whole.begin());
  text += line.whole.substr(0, names);
  text += ' ';
  text += name(part);
  append_line(text, line.whole.substr(names));
}

void append_changes(std::string& text, const StateLines& state, StateLines& written) {
  for (std::size_t k = 0; k < kFaceStateCount; ++k) {
    if (state[k].empty() || state[k] == written[k]) continue;
    append_line(text, state[k]);
    written[k] = state[k];
  }
}

/// The statements for the rim: without smoothing, as the rim meets the skins at an angle.
StateLines with_flat_rim(StateLines state) {
  if (!state[kSmoothGroup].empty()) state[kSmoothGroup] = kFaceStates[kSmoothGroup].reset;
  return state;
}

class ObjDeriver {
 public:
  explicit ObjDeriver(SharedDerived derived)
      : derived_(std::move(derived)),
        source_(derived_->source()),
        text_(source_.text()),
        found_(find_obj_runs(source_)),
        in_place_(derived_->rows_in_place(0, text_.size())),
        line_end_(derived_->is_shell() ? "\n" : line_end_of(text_)),
        elements_inside_(derived_->is_shell() && derived_->is_source(ShellPart::Inner) &&
                         !derived_->is_source(ShellPart::Outer)),
        has_vertex_data_(std::find(source_.extras.begin(), source_.extras.end(), "vertex weights or colours") !=
                         source_.extras.end()),
        has_normals_(std::any_of(rows_of(source_).corner_normal.begin(), rows_of(source_).corner_normal.end(),
                                 [](std::uint32_t n) { return n != kNoNormal; })) {
    if (derived_->is_shell()) return;
    if (!found_.names_unknown_texture)
      texture_ = refine_corners(*derived_, found_.corner_texture, found_.texture_at.size());
    normals_ = refine_corners(*derived_, rows_of(source_).corner_normal, rows_of(source_).normal_at.size());
    for (std::size_t v = 0; has_vertex_data_ && v < derived_->source_vertices(); ++v) colours_.look_at(tail(v), kAll);
  }

  std::size_t runs() const { return found_.runs.size(); }
  bool loses_texture() const {
    return !derived_->is_shell() && found_.names_unknown_texture && !found_.texture_at.empty();
  }
  /// Whether faces of the inner skin come into the source's last object although theirs have none: no statement ends an
  /// object.
  bool misplaces_faces() const {
    return derived_->is_shell() && found_.objects_late && !found_.state_at_end[kObject].empty();
  }
  std::size_t inner_normals() const { return has_normals_ ? rows_of(source_).normal_at.size() : 0; }

  /// A run of the source, with faces in the place of others. Of a refinement, with all that is added.
  std::string run(std::size_t i) const {
    const ObjRun& run = found_.runs[i];
    const bool is_shell = derived_->is_shell();
    std::string moved = in_place_.make(i);
    bool needs_group = is_shell && found_.groups_late && i == found_.first_face_run;
    if (is_shell && i + 1 == runs() && !moved.ends_with('\n')) moved += '\n';
    if (!needs_group && derived_->keeps_all() && !run.has_groups && !(run.has_elements && elements_inside_))
      return moved;
    const std::size_t mark = i == 0 ? byte_order_mark(moved) : 0;
    std::string text = moved.substr(0, mark);
    ObjCounts at = run.before;
    for_each_obj_line(source_.path, moved, mark, moved.size(), [&](const ObjLine& line) {
      // There are more faces only if the file has changed meanwhile, which is found out in the end.
      if (line.is("f") && at.faces < derived_->source_mesh().face_count()) {
        if (needs_group) text += "g outer\n";
        needs_group = false;
        append_pieces(text, line, run.begin, at);
      } else if (is_shell && line.is("g")) {
        append_group(text, line, ShellPart::Outer);
      } else if (!elements_inside_ || !is_obj_element(line.keyword)) {
        append_with_same_indices(text, line, run.begin, at);
      }
      at.faces += line.is("f");
      const std::size_t kind = kind_of(line);
      if (kind == kLineKinds) return;
      ++at.lines[kind];
      if (!is_shell && run.begin + line.begin() + line.whole.size() == found_.last_end[kind]) append_added(text, kind);
    });
    return text;
  }

  /// Appends a vertex that was added.
  void append_vertex(std::string& text, std::size_t added) const {
    const auto v = static_cast<std::uint32_t>(derived_->source_vertices() + added);
    const VertexOrigin origin = derived_->origin(v);
    derived_->append_position(text += 'v', v);
    if (has_vertex_data_)
      append_interpolated_words(text, origin, at_origin(origin, [&](std::uint32_t of) { return tail(of); }),
                                colours_.are_bytes() ? kAll : 0);
    end_line(text);
  }

  void append_inner_normal(std::string& text, std::size_t n) const {
    text += "vn";
    for (const std::string& word : derived_->normal_words(n, true)) (text += ' ') += word;
    end_line(text);
  }

  /// The faces of the inner skin or the rim over those of a run, and the statements that they depend on. \param faces
  /// those of the part, or some of them, whose parents are ascending
  std::string behind_run(std::size_t i, ShellPart part, FaceRange faces) const {
    const bool inner = part == ShellPart::Inner, is_shell = derived_->is_shell();
    std::uint32_t face = first_over(faces, i);
    const std::uint32_t end = first_over(faces, i + 1);
    if (!inner && face == end) return {};
    const bool is_first = inner ? i == 0 : face == derived_->faces_of(part).begin;
    std::string text = is_first ? title_of(part) : "";
    StateLines state = found_.runs[i].state, written = is_first ? found_.state_at_end
                                                       : inner  ? state
                                                                : state_behind(face - 1);
    const auto in_force = [&] { return inner || !is_shell ? state : with_flat_rim(state); };
    for_each_face_line(i, [&](const ObjLine& line, const ObjCounts& at) {
      if (inner && line.is("g")) return append_group(text, line, part);
      if (const std::size_t k = face_state_of(line.keyword); k != kNoState) {
        state[k] = line.whole;
        return;
      }
      const bool is_element = inner && elements_inside_ && is_obj_element(line.keyword);
      const bool has_faces = line.is("f") && face < end && derived_->parent(face) == at.faces;
      if (is_element || has_faces) append_changes(text, in_force(), written);
      if (is_element) append_element(text, line, at);
      for (; has_faces && face < end && derived_->parent(face) == at.faces; ++face) {
        append_face(text, face);
        text += '\n';
      }
    });
    append_changes(text, in_force(), written);
    return text;
  }

 private:
  /// What stands in front of the first face of a part.
  std::string title_of(ShellPart part) const {
    if (part == ShellPart::Inner) return found_.groups_late ? "g inner\n" : "";
    return derived_->is_shell() ? "g rim\n" : end_of_text() + "g ridge\n";
  }

  Scanner scanner_at(std::uint64_t byte) const { return {source_.path, text_, byte, true, '#'}; }
  /// What stands behind a vertex's coordinates.
  Scanner tail(std::size_t v) const {
    Scanner scanner = scanner_at(rows_of(source_).position_at[v].at[2]);
    scanner.token();
    return scanner;
  }
  /// A backslash at the end of a word that is no number would join the next line; a blank behind it keeps the lines
  /// apart, as it did in the source.
  void end_line(std::string& text) const {
    if (text.ends_with('\\')) text += ' ';
    text += line_end_;
  }

  /// How many lines of a kind are added in the midst of the text.
  std::size_t added_count(std::size_t kind) const {
    if (derived_->is_shell()) return 0;
    return kind == kVLines    ? derived_->added_vertices()
           : kind == kVtLines ? texture_.added.size()
                              : normals_.added.size();
  }
  void append_added(std::string& text, std::size_t kind) const {
    // A backslash at the end of the text would join the next line.
    const auto goes_on = [&] { return !text.ends_with('\n') || text.ends_with("\\\n") || text.ends_with("\\\r\n"); };
    while (added_count(kind) > 0 && goes_on()) text += line_end_;
    for (std::size_t i = 0; i < added_count(kind); ++i) {
      if (kind == kVLines) append_vertex(text, i);
      else if (kind == kVtLines) append_texture(text, texture_.added[i]);
      else append_normal(text, normals_.added[i]);
    }
  }
  void append_texture(std::string& text, const RefinedCorners::Between& between) const {
    const auto words = [&](std::size_t k) {
      return scanner_at(between.of[k] == kNone ? text_.size() : found_.texture_at[between.of[k]]);
    };
    append_interpolated_words(text += kKeywords[kVtLines], derived_->origin(between.vertex),
                              {words(0), words(1), words(2)});
    end_line(text);
  }
  void append_normal(std::string& text, const RefinedCorners::Between& between) const {
    std::array<std::array<std::string_view, 3>, 3> words;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; between.of[k] != kNone && i < 3; ++i)
        words[k][i] = scanner_at(rows_of(source_).normal_at[between.of[k]].at[i]).token();
    text += kKeywords[kVnLines];
    for (const std::string& word : interpolated_normal_words(derived_->origin(between.vertex), words))
      (text += ' ') += word;
    end_line(text);
  }

  /// Appends the faces in the place of one of the source's, the first with the comment behind it; its line, if it is
  /// kept.
  void append_pieces(std::string& text, const ObjLine& line, std::size_t first, const ObjCounts& at) const {
    const auto of = static_cast<std::uint32_t>(at.faces);
    if (derived_->is_kept(of)) return append_with_same_indices(text, line, first, at);
    Scanner words = line.words();
    while (!words.at_line_end()) words.token();
    std::string_view comment = line.whole.substr(words.position() - line.begin());
    comment = comment.substr(0, comment.find_first_of("\r\n"));
    const FaceRange pieces = derived_->pieces_of(of);
    for (std::uint32_t f = pieces.begin; f < pieces.end; ++f) {
      append_face(text, f);
      if (!comment.empty()) (text += ' ') += comment;
      comment = {};
      text += line_end_;
    }
  }

  void append_face(std::string& text, std::uint32_t f) const {
    const PolygonView mesh = derived_->mesh();
    text += 'f';
    for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c)
      append_corner(text, std::uint64_t{mesh.corners[c]} + 1, texture_of(f, c), normal_of(f, c));
  }
  // The number, from 1 on, of the texture coordinates or the normal of a face's corner; 0 if it has none.
  std::uint64_t texture_of(std::uint32_t f, std::uint32_t c) const {
    if (!derived_->is_shell()) return number_in(texture_.of_corner, c);
    return number_in(found_.corner_texture, source_corner(f, c));
  }
  std::uint64_t normal_of(std::uint32_t f, std::uint32_t c) const {
    if (!derived_->is_shell()) return derived_->part(f) == ShellPart::Rim ? 0 : number_in(normals_.of_corner, c);
    const ShellPart part = derived_->part(f);
    const std::uint64_t own =
        part == ShellPart::Rim ? 0 : number_in(rows_of(source_).corner_normal, source_corner(f, c));
    return own > 0 && part == ShellPart::Inner ? inner_normals() + own : own;
  }
  static std::uint64_t number_in(std::span<const std::uint32_t> of_corner, std::size_t corner) {
    return of_corner.empty() || of_corner[corner] == kNone ? 0 : std::uint64_t{of_corner[corner]} + 1;
  }
  std::uint32_t source_corner(std::uint32_t f, std::uint32_t c) const {
    CornerFinder finder(derived_->source_mesh());
    return derived_->corner(f, c - derived_->mesh().face_begin[f], finder).corner[0];
  }

  /// Appends a line of a run that begins at `first` as it is, but for indices that count back over lines that are
  /// added: these become plain numbers.
  void append_with_same_indices(std::string& text, const ObjLine& line, std::size_t first, const ObjCounts& at) const {
    std::array<bool, kLineKinds> moves{};
    for (std::size_t kind = 0; kind < kLineKinds; ++kind)
      moves[kind] = added_count(kind) > 0 && first + line.begin() >= found_.last_end[kind];
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
      text += line.text.substr(copied, words.last_token() - copied);
      append_index(text, word, moves, at);
      copied = words.position();
    }
    text += line.text.substr(copied, line.begin() + line.whole.size() - copied);
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

  // Of a shell.

  /// The first of some faces of which the parent is in a run, or behind it.
  std::uint32_t first_over(FaceRange faces, std::size_t i) const {
    if (i == runs()) return faces.end;
    while (faces.size() > 0) {
      const std::uint32_t middle = faces.begin + faces.size() / 2;
      if (derived_->parent(middle) < found_.runs[i].before.faces) faces.begin = middle + 1;
      else faces.end = middle;
    }
    return faces.begin;
  }
  /// The statements in force where the text of a rim's face ends.
  StateLines state_behind(std::uint32_t face) const {
    const auto next = std::partition_point(found_.runs.begin(), found_.runs.end(), [&](const ObjRun& run) {
      return run.before.faces <= derived_->parent(face);
    });
    // Behind a run its state is that of the next one.
    const StateLines& state = next == found_.runs.end() ? found_.state_at_end : next->state;
    return derived_->is_shell() ? with_flat_rim(state) : state;
  }
  /// What ends the source's last line.
  std::string end_of_text() const { return text_.ends_with('\n') ? "" : std::string(line_end_); }

  /// Calls visit(line, what stands before) for the lines of a run that are faces, elements, groups or statements for
  /// faces.
  template <class Visit>
  void for_each_face_line(std::size_t i, Visit&& visit) const {
    const ObjRun& run = found_.runs[i];
    ObjCounts at = run.before;
    const std::size_t begin = run.begin == 0 ? byte_order_mark(text_) : run.begin;
    for_each_obj_line(source_.path, text_, begin, run.end, [&](const ObjLine& line) {
      if (const std::size_t kind = kind_of(line); kind != kLineKinds) ++at.lines[kind];
      else visit(line, at);
      at.faces += line.is("f");
    });
  }

  /// Appends an element, a line v/vt.. or points v, with the vertices of the inner skin.
  void append_element(std::string& text, const ObjLine& line, const ObjCounts& at) const {
    text += line.keyword;
    for (Scanner words = line.words(); !words.at_line_end();) {
      const std::string_view word = words.token();
      std::int64_t vertex = 0;
      if (!parse_integer(word.substr(0, word.find('/')), vertex)) {
        (text += ' ') += word;  // malformed words are copied
        continue;
      }
      if (vertex < 0) vertex += static_cast<std::int64_t>(at.lines[kVLines]) + 1;
      append_corner(text, static_cast<std::uint64_t>(vertex) + derived_->source_vertices(),
                    texture_number(word, at.lines[kVtLines]), 0);
    }
    text += '\n';
  }

  SharedDerived derived_;
  const MeshFile& source_;
  std::string_view text_;
  ObjRuns found_;
  Pieces in_place_;
  std::string_view line_end_;
  bool elements_inside_, has_vertex_data_, has_normals_;
  RefinedCorners texture_, normals_;
  ByteColours colours_;
};

}  // namespace

WrittenDocument ObjRows::derive(const SharedDerived& derived, const std::string&) const {
  const auto deriver = std::make_shared<const ObjDeriver>(derived);
  WrittenDocument written;
  if (deriver->loses_texture())
    written.lost.emplace_back("texture coordinates of pieces (some faces name ones that are not there)");
  if (deriver->misplaces_faces()) written.lost.emplace_back("that the inner skin's first faces are in no object");
  const std::size_t runs = deriver->runs();
  written.file = {runs, [=](std::size_t i) { return deriver->run(i); }};
  const auto behind = [&](ShellPart part, FaceRange faces) {
    return Pieces{runs, [=](std::size_t i) { return deriver->behind_run(i, part, faces); }};
  };
  if (derived->has_ridges()) {
    const auto [strips, patches] = derived->over_ridges();
    written.file = in_a_row({written.file, behind(ShellPart::Rim, strips), behind(ShellPart::Rim, patches)});
  }
  if (!derived->is_shell()) return written;
  const auto part_behind = [&](ShellPart part) { return behind(part, derived->faces_of(part)); };
  written.file = in_a_row(
      {written.file,
       in_sections(
           {}, {{derived->added_vertices(), [=](std::string& text, std::size_t i) { deriver->append_vertex(text, i); }},
                {deriver->inner_normals(),
                 [=](std::string& text, std::size_t n) { deriver->append_inner_normal(text, n); }}}),
       part_behind(ShellPart::Inner), part_behind(ShellPart::Rim)});
  return written;
}

}  // namespace vdb_offset::io
