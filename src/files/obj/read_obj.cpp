// SPDX-License-Identifier: Apache-2.0
// Reads an OBJ file in parallel: the mesh comes out, with the normal of each corner, the places of all coordinates and
// normals, and the names of everything else. The text is cut at lines into runs. A first pass counts what each run
// holds, so that each has its own part of the arrays; a second one parses them there, plain lines by a fast cursor and
// all others by a Scanner, which also gives the messages. If several runs fail, the first one in the file is reported:
// neither mesh nor message depends on the number of threads. Arrays are bounded by the bytes of the file, and indices
// are checked as they are read. Lines of other kinds are only noted here; texture coordinates, groups and materials are
// read by obj_document.cpp.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <sstream>
#include <tuple>
#include <utility>

#include "bytes/line_records.h"
#include "bytes/obj_lines.h"
#include "bytes/scanner.h"
#include "document/require_format.h"
#include "ground/system/memory.h"
#include "obj/obj_document.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

/// What a file holds besides positions and faces, as bits, in the order of their names.
enum Extra : unsigned {
  kVertexData = 1,
  kNormals = 2,
  kTexture = 4,
  kMaterials = 8,
  kGroups = 16,
  kSmooth = 32,
  kOther = 64
};
constexpr const char* kExtraNames[] = {
    "vertex weights or colours", "normals",          "texture coordinates", "materials",
    "groups and object names",   "smoothing groups", "other lines"};
/// What the corners of faces refer to, as further bits.
enum Named : unsigned { kNamesTexture = 128, kNamesNormals = 256 };

// Bytes of the shortest line of a vertex, "v 0 0 0".
constexpr std::size_t kLeastVertexLine = 7;

/// Numbers of vertices, normals and so on: in a run of lines, or before it.
struct Counts {
  std::size_t vertices = 0, normals = 0, faces = 0, corners = 0;

  Counts& operator+=(const Counts& other) {
    vertices += other.vertices;
    normals += other.normals;
    faces += other.faces;
    corners += other.corners;
    return *this;
  }
  bool operator==(const Counts&) const = default;
};

/// The arrays that are filled, each run of lines its own part.
struct Arrays {
  Polygons& polygons;
  std::vector<std::uint32_t>& corner_normal;
  std::vector<NumberTriple> position_at, normal_at;
};

/// The number of corners in a face's line.
std::size_t count_corners(const ObjLine& line) {
  std::size_t corners = 0;
  FastCursor cursor = line.cursor;
  while (cursor.skip_word()) ++corners;
  if (cursor.at_line_end() && cursor.position() + 1 >= line.whole.data() + line.whole.size()) return corners;
  Scanner words = line.words();  // the slow way: a comment follows, or the line goes on in the next one
  for (corners = 0; !words.token().empty();) ++corners;
  return corners;
}

/// Counts what a run of lines holds. How malformed lines are counted does not matter: parsing will refuse them.
Counts count_run(const MeshFile& file, std::size_t begin, std::size_t end) {
  Counts counts;
  for_each_obj_line(file.path, file.text(), begin, end, [&](const ObjLine& line) {
    const bool is_vertex = line.is("v"), is_face = line.is("f");
    // Lines too short for a vertex are refused here, so that the size of arrays is bounded by that of the file.
    if (is_vertex && line.whole.size() < kLeastVertexLine) {
      NumberTriple ignored;
      line.words().triple("a coordinate", ignored);
    }
    counts.vertices += is_vertex;
    counts.normals += line.is("vn");
    if (!is_face) return;
    ++counts.faces;
    counts.corners += count_corners(line);
  });
  return counts;
}

/// Parses a run of lines into its part of the arrays.
class RunParser {
 public:
  RunParser(const MeshFile& file, Arrays& arrays, const Counts& from, const Counts& to, const Counts& all)
      : file_(file),
        text_(file.text()),
        scanner_(file.path, text_, 0, true, '#'),
        arrays_(arrays),
        next_(from),
        to_(to),
        all_(all) {}

  /// Parses lines from `begin` to `end`. Returns what they hold besides positions and faces, as bits, and what they
  /// name as files of materials.
  std::pair<unsigned, std::vector<std::string>> run(std::size_t begin, std::size_t end) {
    for_each_obj_line(file_.path, text_, begin, end, [&](const ObjLine& line) {
      if (line.is("v")) vertex(line);
      else if (line.is("f")) face(line);
      else if (line.is("vn")) normal(line);
      else if (!line.keyword.empty()) other(line);
    });
    if (!(next_ == to_)) changed();
    return {extras_, std::move(libraries_)};
  }

 private:
  /// Called if parsing finds something else than was counted: the file has changed.
  [[noreturn]] void changed() const {
    scanner_.fail_with("a file that stays as it is", "one that changes while it is read", 0);
  }
  std::size_t take(std::size_t Counts::*what) {
    if (next_.*what == to_.*what) changed();
    return (next_.*what)++;
  }
  std::uint64_t offset_of(const char* at) const { return static_cast<std::uint64_t>(at - text_.data()); }
  void vertex(const ObjLine& line) {
    FastCursor cursor = line.cursor;
    const std::size_t v = take(&Counts::vertices);
    Vec3d& p = arrays_.polygons.positions[v];
    NumberTriple& at = arrays_.position_at[v];
    bool plain = true;
    for (int k = 0; k < 3 && plain; ++k) {
      cursor.skip_blanks();
      at.at[k] = offset_of(cursor.position());
      plain = cursor.number(p[k]);
    }
    if (plain && cursor.at_line_end()) return;
    scanner_ = line.words();
    p = scanner_.triple("a coordinate", at);
    if (!scanner_.at_line_end()) extras_ |= kVertexData;
  }

  void normal(const ObjLine& line) {
    FastCursor cursor = line.cursor;
    NumberTriple& at = arrays_.normal_at[take(&Counts::normals)];
    extras_ |= kNormals;
    bool plain = true;
    for (auto& byte : at.at) {
      cursor.skip_blanks();
      byte = offset_of(cursor.position());
      plain = plain && cursor.skip_word();
    }
    if (plain && cursor.at_line_end()) return;
    scanner_ = line.words();
    scanner_.skip_triple("three numbers of a normal", at);
  }

  void face(const ObjLine& line) {
    FastCursor cursor = line.cursor;
    const std::size_t f = take(&Counts::faces), first = next_.corners;
    bool plain = true;
    while (plain && !cursor.at_line_end()) plain = plain_corner(cursor);
    if (!plain) {
      next_.corners = first;
      scanner_ = line.words();
      while (!scanner_.at_line_end()) corner(scanner_.token());
    }
    if (next_.corners - first < 3) {
      scanner_ = line.words();
      scanner_.fail_with("at least 3 corners in a face", fmt::format("{}", next_.corners - first), line.begin());
    }
    arrays_.polygons.face_begin[f + 1] = static_cast<std::uint32_t>(next_.corners);
  }

  bool plain_corner(FastCursor& cursor) {
    std::uint32_t vertex = 0, texture = 0, normal = 0;
    if (!cursor.digits(vertex) || vertex == 0 || vertex > all_.vertices) return false;
    if (cursor.take('/')) {
      const bool has_texture = !cursor.take('/');
      if (has_texture && !cursor.digits(texture)) return false;
      if (!has_texture || cursor.take('/')) {
        if (!cursor.digits(normal) || normal == 0 || normal > all_.normals) return false;
      }
      if (has_texture) extras_ |= kNamesTexture;
    }
    if (!cursor.at_word_end()) return false;
    add_corner(vertex - 1, normal == 0 ? kNoNormal : normal - 1);
    return true;
  }
  void add_corner(std::uint32_t vertex, std::uint32_t normal) {
    const std::size_t c = take(&Counts::corners);
    arrays_.polygons.corners[c] = vertex;
    if (!arrays_.corner_normal.empty()) arrays_.corner_normal[c] = normal;
  }

  /// Parses a corner: v, v/vt, v//vn or v/vt/vn. Negative numbers count back from the last one that was read.
  void corner(std::string_view token) {
    const std::size_t at = scanner_.position() - token.size();
    std::string_view part[3];
    int parts = 0;
    for (std::string_view rest = token; parts < 3; ++parts) {
      const std::size_t slash = std::min(rest.find('/'), rest.size());
      part[parts] = rest.substr(0, slash);
      if (slash == rest.size()) break;
      rest.remove_prefix(slash + 1);
    }
    if (parts == 3) scanner_.fail("a corner of the form v, v/vt, v//vn or v/vt/vn", at);
    const std::uint32_t vertex = index(part[0], next_.vertices, all_.vertices, "vertex", at);
    std::int64_t texture = 0;
    if (!part[1].empty() && !parse_integer(part[1], texture)) scanner_.fail("a texture index", at);
    if (!part[1].empty()) extras_ |= kNamesTexture;
    add_corner(vertex, part[2].empty() ? kNoNormal : normal_index(part[2], at));
  }
  /// The index of a normal; kNoNormal in a file without `vn` lines, as some writers name normals that they do not
  /// write.
  std::uint32_t normal_index(std::string_view text, std::size_t at) {
    if (all_.normals > 0) return index(text, next_.normals, all_.normals, "normal", at);
    std::int64_t ignored = 0;
    if (!parse_integer(text, ignored)) scanner_.fail("a normal index", at);
    extras_ |= kNamesNormals;
    return kNoNormal;
  }
  std::uint32_t index(std::string_view text, std::size_t so_far, std::size_t all, const char* what, std::size_t at) {
    std::int64_t value = 0;
    if (!parse_integer(text, value)) scanner_.fail(fmt::format("a {} index", what), at);
    if (value == 0) scanner_.fail(fmt::format("a {} index from 1 on or below 0", what), at);
    if (value < 0) {
      value += static_cast<std::int64_t>(so_far) + 1;
      if (value < 1) scanner_.fail(fmt::format("a {} index within the {} read so far", what, so_far), at);
    }
    if (static_cast<std::uint64_t>(value) > all) scanner_.fail(fmt::format("a {} index up to {}", what, all), at);
    return static_cast<std::uint32_t>(value - 1);
  }

  void other(const ObjLine& line) {
    scanner_ = line.words();
    const std::string_view keyword = line.keyword;
    // A file that is no OBJ file is recognised by the first line without a plausible keyword.
    if (keyword.size() > 32 || !std::all_of(keyword.begin(), keyword.end(), [](char c) { return c > ' ' && c < 127; }))
      scanner_.fail("a line of an OBJ file", scanner_.position() - keyword.size());
    if (keyword == "vt") extras_ |= kTexture;
    else if (keyword == "usemtl" || keyword == "mtllib") extras_ |= kMaterials;
    else if (keyword == "g" || keyword == "o") extras_ |= kGroups;
    else if (keyword == "s") extras_ |= kSmooth;
    else extras_ |= kOther;
    if (keyword == "mtllib") libraries_.push_back(rest_of_line(line));
  }

  const MeshFile& file_;
  std::string_view text_;
  Scanner scanner_;
  Arrays& arrays_;
  Counts next_, to_, all_;
  unsigned extras_ = 0;
  std::vector<std::string> libraries_;  // files of materials
};

/// Adds the files that lines with `mtllib` name: one each, or several with blanks between.
void add_libraries(MeshFile& file, const std::vector<std::string>& lines) {
  const std::filesystem::path folder = std::filesystem::path(file.path).parent_path();
  for (const std::string& line : lines) {
    std::istringstream words(line);
    file.files_named.push_back((folder / line).string());
    for (std::string word; words >> word;)
      if (word != line) file.files_named.push_back((folder / word).string());
  }
}

/// What there is before each run, and in the whole file.
std::vector<Counts> count(const MeshFile& file, const std::vector<std::size_t>& cuts) {
  std::vector<Counts> before(cuts.size());
  tbb::parallel_for(std::size_t{1}, cuts.size(),
                    [&](std::size_t run) { before[run] = count_run(file, cuts[run - 1], cuts[run]); });
  for (std::size_t run = 1; run < cuts.size(); ++run) before[run] += before[run - 1];
  return before;
}

Arrays allocate(MeshFile& file, std::vector<std::uint32_t>& corner_normal, const Counts& all) {
  const Scanner end(file.path, file.text(), file.text().size());
  if (all.vertices > kMostVertices || all.normals > kMostVertices || all.corners > kMostVertices)
    end.fail("fewer than 2^32 vertices and face corners");
  const std::size_t corner = sizeof(std::uint32_t) * (all.normals > 0 ? 2 : 1);
  require_memory(all.vertices * (sizeof(Vec3d) + sizeof(NumberTriple)) + all.normals * sizeof(NumberTriple) +
                     all.corners * corner + all.faces * sizeof(std::uint32_t),
                 file.path);
  Arrays arrays{file.polygons, corner_normal, {}, {}};
  arrays.polygons.positions.resize(all.vertices);
  arrays.polygons.corners.resize(all.corners);
  arrays.polygons.face_begin.resize(all.faces + 1);
  arrays.position_at.resize(all.vertices);
  arrays.normal_at.resize(all.normals);
  if (all.normals > 0) arrays.corner_normal.resize(all.corners);
  return arrays;
}

}  // namespace

/// Reads `v`, `vn` and `f` lines; all others will be copied as they are. The lines are counted first, so that runs of
/// them can be parsed in parallel, each into its own part of the arrays.
void parse_obj(MeshFile& file) {
  const auto rows = std::make_shared<ObjRows>();
  file.document = rows;
  rows->has_carriage_returns = use_line_feeds(file);
  const std::vector<std::size_t> cuts = cut_at_lines(file.text(), byte_order_mark(file.text()));
  const std::vector<Counts> before = count(file, cuts);
  const Counts& all = before.back();
  Arrays arrays = allocate(file, rows->corner_normal, all);
  std::vector<std::exception_ptr> failed(cuts.size());
  std::vector<std::pair<unsigned, std::vector<std::string>>> extras(cuts.size());
  tbb::parallel_for(std::size_t{1}, cuts.size(), [&](std::size_t run) {
    try {
      extras[run] = RunParser(file, arrays, before[run - 1], before[run], all).run(cuts[run - 1], cuts[run]);
    } catch (...) {
      failed[run] = std::current_exception();
    }
  });
  for (const auto& exception : failed)
    if (exception) std::rethrow_exception(exception);
  if (all.faces == 0) Scanner(file.path, file.text()).fail("at least one face ('f' line)", file.text().size());
  rows->position_at = ByteOffsets(std::move(arrays.position_at));
  rows->normal_at = ByteOffsets(std::move(arrays.normal_at));
  file.normal_count = rows->normal_at.size();
  unsigned held = 0;
  for (const auto& [extra, libraries] : extras) {
    held |= extra;
    add_libraries(file, libraries);
  }
  for (std::size_t i = 0; i < std::size(kExtraNames); ++i)
    if (held >> i & 1) file.extras.emplace_back(kExtraNames[i]);
  for (const auto& [named, there, remark] :
       {std::tuple{kNamesNormals, kNormals, "faces name normals (as in f 1//1), but there is no 'vn' line"},
        {kNamesTexture, kTexture, "faces name texture coordinates (as in f 1/1), but there is no 'vt' line"}})
    if ((held & named) && !(held & there)) file.remarks.emplace_back(remark);
}

}  // namespace vdb_offset::io
