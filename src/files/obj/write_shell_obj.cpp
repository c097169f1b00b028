// SPDX-License-Identifier: Apache-2.0
// Writes a shell of an OBJ file in the source's own text. The text is cut into runs of lines, which are scanned in
// parallel for counts and for the statements in force before each; after that the text of each run for the outer skin,
// the inner skin and the rim is made by itself. Groups of faces get the name of their part in front. Statements such as
// materials are repeated where those in force would be others, and ended where a face had none. Inner faces name
// normals of their own; faces of the rim have the texture coordinates of their border, no normals and no smoothing.
// Lines and points join the inner skin if that alone is the source, else the outer one. Numbers and lines that do not
// change keep their text, and comments come once.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "bytes/line_records.h"
#include "bytes/obj_lines.h"
#include "bytes/scanner.h"
#include "derived/shell_writers.h"
#include "document/rows.h"
#include "ground/system/progress_count.h"
#include "obj/obj_corners.h"
#include "obj/obj_document.h"

// The file begins with the source's text, with the positions of the outer skin. Then follow the vertices of the inner
// skin, its faces, which are the source's reversed, and the faces of the rim; both with the statements that the faces
// depend on.
namespace vdb_offset::io {
namespace {

/// A statement that holds for the faces after it, and the one that ends it. Groups are not among these, as they also
/// name the part of the shell.
struct FaceState {
  std::string_view keyword, reset;
};
constexpr std::size_t kFaceStateCount = 8;
constexpr FaceState kFaceStates[kFaceStateCount] = {{"o", ""},
                                                    {"usemtl", "usemtl\n"},
                                                    {"s", "s off\n"},
                                                    {"lod", "lod 0\n"},
                                                    {"usemap", "usemap off\n"},
                                                    {"bevel", "bevel off\n"},
                                                    {"c_interp", "c_interp off\n"},
                                                    {"d_interp", "d_interp off\n"}};
constexpr std::size_t kObject = 0, kSmoothGroup = 2, kNoState = kFaceStateCount;

std::size_t face_state_of(std::string_view keyword) {
  std::size_t i = 0;
  while (i < kFaceStateCount && kFaceStates[i].keyword != keyword) ++i;
  return i;
}

/// The statements in force at some point of a file: whole lines, empty where there has been none.
using StateLines = std::array<std::string_view, kFaceStateCount>;

bool is_element(std::string_view keyword) { return keyword == "l" || keyword == "p"; }

/// A run of lines: what it holds, and how many vertices and so on there are before it.
struct ObjRun {
  std::size_t begin = 0, end = 0;
  std::size_t vertices = 0, textures = 0, faces = 0;
  bool has_groups = false, has_elements = false;
  StateLines state;  // in force before the run; during the scan, the last statements of the run
};

/// The runs of a file, and what is known of the whole file.
struct ObjRuns {
  std::vector<ObjRun> runs;
  StateLines state_at_end;
  bool groups_late = true;   // the first face is in no group
  bool objects_late = true;  // the first face is in no object
  std::size_t first_face_run = 0;
};

class ObjRunFinder {
 public:
  explicit ObjRunFinder(const MeshFile& source) : source_(source) {
    const std::vector<std::size_t> cuts = cut_at_lines(source.text(), 0);
    found_.runs.resize(cuts.size() - 1);
    named_.resize(found_.runs.size());
    tbb::parallel_for(std::size_t{0}, found_.runs.size(), [&](std::size_t i) { scan(i, cuts[i], cuts[i + 1]); });
    for (std::size_t i = 0; i < named_.size(); ++i) {
      found_.groups_late = found_.groups_late && !named_[i].group;
      found_.objects_late = found_.objects_late && !named_[i].object;
      found_.first_face_run = i;
      if (found_.runs[i].faces > 0) break;
    }
    put_together();
  }
  ObjRuns take() { return std::move(found_); }

 private:
  /// Whether there is a group or an object before a run's first face.
  struct Named {
    bool group = false, object = false;
  };

  void scan(std::size_t i, std::size_t begin, std::size_t end) {
    ObjRun& run = found_.runs[i];
    run.begin = begin;
    run.end = end;
    const std::size_t start = begin == 0 ? byte_order_mark(source_.text()) : begin;
    for_each_obj_line(source_.path, source_.text(), start, end, [&](const ObjLine& line) {
      run.vertices += line.is("v");
      run.textures += line.is("vt");
      run.faces += line.is("f");
      run.has_elements |= is_element(line.keyword);
      run.has_groups |= line.is("g");
      named_[i].group |= run.faces == 0 && line.is("g");
      named_[i].object |= run.faces == 0 && line.is("o");
      if (const std::size_t state = face_state_of(line.keyword); state != kNoState) run.state[state] = line.whole;
    });
  }

  /// Turns the counts and statements of each run into those before it.
  void put_together() {
    ObjRun before;
    for (ObjRun& run : found_.runs) {
      for (std::size_t ObjRun::*const count : {&ObjRun::vertices, &ObjRun::textures, &ObjRun::faces}) {
        const std::size_t of_run = run.*count;
        run.*count = before.*count;
        before.*count += of_run;
      }
      const StateLines of_run = run.state;
      run.state = before.state;
      for (std::size_t k = 0; k < kFaceStateCount; ++k)
        if (!of_run[k].empty()) before.state[k] = of_run[k];
    }
    found_.state_at_end = before.state;
    // Statements that come later in the source are in force after a skin has been written. Runs before them need the
    // statement that ends them.
    for (ObjRun& run : found_.runs)
      for (std::size_t k = 0; k < kFaceStateCount; ++k)
        if (run.state[k].empty() && !before.state[k].empty()) run.state[k] = kFaceStates[k].reset;
  }

  const MeshFile& source_;
  ObjRuns found_;
  std::vector<Named> named_;
};

/// Appends a g line: the name of the part, then the names of the source's line.
void append_group(std::string& text, const ObjLine& line, ShellPart part) {
  const auto names = static_cast<std::size_t>(line.keyword.end() - line.whole.begin());
  text += line.whole.substr(0, names);
  text += ' ';
  text += name(part);
  append_line(text, line.whole.substr(names));
}

class ObjShellWriter {
 public:
  explicit ObjShellWriter(const SharedShell& content)
      : content_(content),
        source_(content->source),
        shell_(content->shell),
        found_(ObjRunFinder(source_).take()),
        outer_(rewrite_in_place(source_, shell_.outer(), content->precision,
                                std::make_shared<NewNormals>(content->outer.new_normals()))),
        elements_inside_(content->inner.is_source() && !content->outer.is_source()),
        has_vertex_data_(std::find(source_.extras.begin(), source_.extras.end(), "vertex weights or colours") !=
                         source_.extras.end()),
        has_normals_(std::any_of(rows_of(source_).corner_normal.begin(), rows_of(source_).corner_normal.end(),
                                 [](std::uint32_t n) { return n != kNoNormal; })) {}

  std::size_t runs() const { return found_.runs.size(); }
  /// Whether faces of the inner skin come into the source's last object although theirs have none: no statement ends an
  /// object.
  bool misplaces_faces() const { return found_.objects_late && !found_.state_at_end[kObject].empty(); }
  bool has_normals() const { return has_normals_; }

  /// The text of a run of the source, with the positions of the outer skin.
  std::string outer_run(std::size_t i) const {
    const ObjRun& run = found_.runs[i];
    std::string patched = outer_.make(i);
    bool needs_group = found_.groups_late && i == found_.first_face_run;
    if (i + 1 == runs() && !patched.ends_with('\n')) patched += '\n';
    if (!needs_group && !run.has_groups && !(run.has_elements && elements_inside_) && has_faces_as_they_are())
      return patched;
    const std::size_t mark = i == 0 ? byte_order_mark(patched) : 0;
    std::string text = patched.substr(0, mark);
    Progress at{run.vertices, run.textures, run.faces};
    for_each_obj_line(source_.path, patched, mark, patched.size(), [&](const ObjLine& line) {
      const bool is_face = line.is("f");
      at.textures += line.is("vt");
      if (needs_group && is_face) {
        text += "g outer\n";
        needs_group = false;
      }
      if (line.is("g")) append_group(text, line, ShellPart::Outer);
      else if (is_face) append_outer_face(text, line, at);
      else if (!(elements_inside_ && is_element(line.keyword))) append_line(text, line.whole);
      at.faces += is_face;
    });
    return text;
  }

  /// Appends a vertex of the inner skin or a split.
  void append_other_vertex(std::string& text, std::size_t i) const {
    const auto [skin, v] = content_->vertex(static_cast<std::uint32_t>(shell_.source_vertices() + i));
    text += 'v';
    skin.append_position(text, v);
    if (has_vertex_data_) {
      Scanner words(source_.path, source_.text(), rows_of(source_).position_at[skin.source_of(v)].at[2], true, '#');
      for (words.token(); !words.at_line_end();) (text += ' ') += words.token();
    }
    text += '\n';
  }

  void append_inner_normal(std::string& text, std::size_t n) const {
    text += "vn";
    content_->inner.append_normal(text, n);
    text += '\n';
  }

  /// The inner skin's faces over those of a run, and the statements that they depend on.
  std::string inner_run(std::size_t i) const {
    std::string text = i == 0 && found_.groups_late ? "g inner\n" : "";
    StateLines state = found_.runs[i].state, written = i == 0 ? found_.state_at_end : state;
    for_each_face_line(i, [&](const ObjLine& line, const Progress& at) {
      if (line.is("g")) return append_group(text, line, ShellPart::Inner);
      if (const std::size_t k = face_state_of(line.keyword); k != kNoState) {
        state[k] = line.whole;
        return;
      }
      if (!line.is("f") ? !elements_inside_ : shell_.skin_face(static_cast<std::uint32_t>(at.faces)) == kNone) return;
      append_changes(text, state, written);
      if (line.is("f")) append_inner_face(text, line, at);
      else append_element(text, line, at);
    });
    append_changes(text, state, written);
    return text;
  }

  /// The rim's faces at the borders of a run's faces, and the statements that they depend on.
  std::string rim_run(std::size_t i) const {
    auto edge = first_rim_of(found_.runs[i].faces);
    if (edge == first_rim_of(i + 1 < runs() ? found_.runs[i + 1].faces : mesh_faces())) return {};
    std::string text = edge == shell_.rim.begin() ? "g rim\n" : "";
    StateLines state = found_.runs[i].state, written = state_before(edge);
    for_each_face_line(i, [&](const ObjLine& line, const Progress& at) {
      if (const std::size_t k = face_state_of(line.keyword); k != kNoState) state[k] = line.whole;
      if (!line.is("f") || edge == shell_.rim.end() || edge->face != at.faces) return;
      append_changes(text, with_flat_rim(state), written);
      const std::vector<std::uint64_t> textures = textures_of(line, at);
      for (; edge != shell_.rim.end() && edge->face == at.faces; ++edge) append_rim_face(text, edge, textures);
    });
    append_changes(text, with_flat_rim(state), written);
    return text;
  }

 private:
  /// Numbers of vertices, texture coordinates and faces that have been read.
  struct Progress {
    std::size_t vertices, textures, faces;
  };
  using RimIterator = std::vector<Shell::RimOrigin>::const_iterator;

  /// Calls visit(line, progress) for the lines of a run that are faces, elements, groups or statements for faces.
  template <class Visit>
  void for_each_face_line(std::size_t i, Visit&& visit) const {
    const ObjRun& run = found_.runs[i];
    Progress at{run.vertices, run.textures, run.faces};
    const std::size_t begin = run.begin == 0 ? byte_order_mark(source_.text()) : run.begin;
    for_each_obj_line(source_.path, source_.text(), begin, run.end, [&](const ObjLine& line) {
      const bool is_face = line.is("f");
      at.vertices += line.is("v");
      at.textures += line.is("vt");
      // There are more faces only if the file has changed meanwhile; then nothing will be put in place.
      if (is_face && at.faces >= mesh_faces()) return;
      if (is_face || line.is("g") || is_element(line.keyword) || face_state_of(line.keyword) != kNoState)
        visit(line, at);
      at.faces += is_face;
    });
  }

  static void append_changes(std::string& text, const StateLines& state, StateLines& written) {
    for (std::size_t k = 0; k < kFaceStateCount; ++k) {
      if (state[k].empty() || state[k] == written[k]) continue;
      append_line(text, state[k]);
      written[k] = state[k];
    }
  }

  /// The statements for the rim: without smoothing, as the rim meets the skins at an angle.
  static StateLines with_flat_rim(StateLines state) {
    if (!state[kSmoothGroup].empty()) state[kSmoothGroup] = kFaceStates[kSmoothGroup].reset;
    return state;
  }

  /// The statements in force before a face of the rim is written.
  StateLines state_before(RimIterator edge) const {
    if (edge == shell_.rim.begin()) return found_.state_at_end;
    const auto next = std::partition_point(found_.runs.begin(), found_.runs.end(),
                                           [&](const ObjRun& run) { return run.faces <= (edge - 1)->face; });
    return with_flat_rim(next->state);
  }

  RimIterator first_rim_of(std::size_t face) const {
    return std::partition_point(shell_.rim.begin(), shell_.rim.end(),
                                [&](const Shell::RimOrigin& edge) { return edge.face < face; });
  }

  /// The numbers of texture coordinates, one for each corner of a face's line.
  std::vector<std::uint64_t> textures_of(const ObjLine& line, const Progress& at) const {
    std::vector<std::uint64_t> textures;
    for (Scanner words = line.words(); !words.at_line_end();)
      textures.push_back(texture_number(words.token(), at.textures));
    textures.resize(source_.polygons.view().face(at.faces).size(), 0);
    return textures;
  }

  std::size_t mesh_faces() const { return source_.polygons.face_count(); }
  bool has_faces_as_they_are() const { return shell_.faces.empty() && shell_.splits.empty(); }

  /// Appends the source's line if the face of the shell has the same vertices; nothing if the shell has no such face.
  void append_outer_face(std::string& text, const ObjLine& line, const Progress& at) const {
    const std::uint32_t face = at.faces < mesh_faces() ? shell_.skin_face(static_cast<std::uint32_t>(at.faces)) : kNone;
    if (face == kNone) return;
    if (std::ranges::equal(shell_.polygons.view().face(face), source_.polygons.view().face(at.faces)))
      append_line(text, line.whole);
    else append_face(text, line, at, face, 0);
  }

  void append_inner_face(std::string& text, const ObjLine& line, const Progress& at) const {
    const std::uint32_t face = shell_.skin_face(static_cast<std::uint32_t>(at.faces));
    append_face(text, line, at, shell_.skin_faces() + face, rows_of(source_).normal_at.size());
  }

  /// Appends the face of the shell over the one of a line. Numbers of normals follow `first_normal`.
  void append_face(std::string& text, const ObjLine& line, const Progress& at, std::size_t face,
                   std::size_t first_normal) const {
    const PolygonView mesh = source_.polygons.view();
    const std::vector<std::uint64_t> textures = textures_of(line, at);
    const auto corners = shell_.polygons.view().face(face);
    text += 'f';
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t corner = shell_.source_corner(mesh, face, k);
      const std::uint32_t normal = has_normals_ ? rows_of(source_).corner_normal[corner] : kNoNormal;
      append_corner(text, std::uint64_t{corners[k]} + 1, textures[corner - mesh.face_begin[at.faces]],
                    normal == kNoNormal ? 0 : first_normal + normal + 1);
    }
    text += '\n';
  }

  void append_rim_face(std::string& text, RimIterator edge, const std::vector<std::uint64_t>& textures) const {
    const PolygonView mesh = source_.polygons.view();
    const std::size_t face = 2 * shell_.skin_faces() + static_cast<std::size_t>(edge - shell_.rim.begin());
    const auto corners = shell_.polygons.view().face(face);
    text += 'f';
    for (std::size_t k = 0; k < corners.size(); ++k)
      append_corner(text, std::uint64_t{corners[k]} + 1,
                    textures[shell_.source_corner(mesh, face, k) - mesh.face_begin[edge->face]], 0);
    text += '\n';
  }

  /// Appends an element, a line v/vt.. or points v, with the vertices of the inner skin.
  void append_element(std::string& text, const ObjLine& line, const Progress& at) const {
    text += line.keyword;
    for (Scanner words = line.words(); !words.at_line_end();) {
      const std::string_view word = words.token();
      std::int64_t vertex = 0;
      if (!parse_integer(word.substr(0, word.find('/')), vertex)) {
        (text += ' ') += word;  // malformed words are copied
        continue;
      }
      if (vertex < 0) vertex += static_cast<std::int64_t>(at.vertices) + 1;
      append_corner(text, static_cast<std::uint64_t>(vertex) + content_->inner.first_vertex(),
                    texture_number(word, at.textures), 0);
    }
    text += '\n';
  }

  SharedShell content_;
  const MeshFile& source_;
  const Shell& shell_;
  ObjRuns found_;
  Pieces outer_;
  bool elements_inside_, has_vertex_data_, has_normals_;
};

}  // namespace

Pieces ObjRows::with_shell(const std::shared_ptr<const ShellContent>& content, std::vector<std::string>& lost) const {
  const auto writer = std::make_shared<const ObjShellWriter>(content);
  if (writer->misplaces_faces()) lost.emplace_back("that the inner skin's first faces are in no object");
  const std::size_t normals = writer->has_normals() ? rows_of(content->source).normal_at.size() : 0;
  return in_a_row(
      {{writer->runs(), [=](std::size_t i) { return writer->outer_run(i); }},
       in_sections({}, {{content->shell.polygons.positions.size() - content->shell.source_vertices(),
                         [=](std::string& text, std::size_t i) { writer->append_other_vertex(text, i); }},
                        {normals, [=](std::string& text, std::size_t n) { writer->append_inner_normal(text, n); }}}),
       {writer->runs(), [=](std::size_t i) { return writer->inner_run(i); }},
       {writer->runs(), [=](std::size_t i) { return writer->rim_run(i); }}});
}

}  // namespace vdb_offset::io
