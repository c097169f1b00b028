#include <fmt/format.h>

#include <algorithm>

#include "vdb_offset/error.h"
#include "vdb_offset/io/formats.h"
#include "vdb_offset/io/scanner.h"

namespace vdb_offset::io {
namespace {

/// Reads `v`, `vn` and `f` lines; all others stay what they are, bytes that are copied.
class ObjParser {
 public:
  explicit ObjParser(MeshFile& file)
      : file_(file), scanner_(file.path, file.bytes, byte_order_mark(file.bytes), true, '#') {}

  void run() {
    for (; !scanner_.at_end(); scanner_.next_line()) {
      const std::string_view keyword = scanner_.token();
      if (keyword == "v") vertex();
      else if (keyword == "vn") normal();
      else if (keyword == "f") face();
      else if (!keyword.empty()) other(keyword);
    }
    check_indices();
    if (file_.polygons.face_count() == 0) scanner_.fail("at least one face ('f' line)", file_.bytes.size());
    if (std::all_of(file_.corner_normal.begin(), file_.corner_normal.end(), [](auto n) { return n == kNoNormal; }))
      file_.corner_normal.clear();
  }

 private:
  void vertex() {
    file_.polygons.positions.push_back(scanner_.triple("a coordinate", file_.position_at.emplace_back()));
    if (!scanner_.at_line_end()) note("vertex weights or colours");
  }
  void normal() {
    scanner_.skip_triple("three numbers of a normal", file_.normal_at.emplace_back());
    note("normals");
  }
  void face() {
    const std::size_t begin = scanner_.position();
    std::size_t corners = 0;
    for (; !scanner_.at_line_end(); ++corners) corner(scanner_.token());
    if (corners < 3) scanner_.fail_with("at least 3 corners in a face", fmt::format("{}", corners), begin);
    face_at_.push_back(begin);
    file_.polygons.close_face();
  }
  /// v, v/vt, v//vn or v/vt/vn; negative numbers count back from the last one read so far.
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
    file_.polygons.corners.push_back(index(part[0], file_.polygons.positions.size(), "vertex", at));
    std::int64_t texture = 0;
    if (!part[1].empty() && !parse_integer(part[1], texture)) scanner_.fail("a texture index", at);
    file_.corner_normal.push_back(part[2].empty() ? kNoNormal : index(part[2], file_.normal_at.size(), "normal", at));
  }
  std::uint32_t index(std::string_view text, std::size_t count, const char* what, std::size_t at) {
    std::int64_t value = 0;
    if (!parse_integer(text, value)) scanner_.fail(fmt::format("a {} index", what), at);
    if (value == 0) scanner_.fail(fmt::format("a {} index from 1 on or below 0", what), at);
    if (value < 0) value += static_cast<std::int64_t>(count) + 1;
    if (value < 1 || static_cast<std::uint64_t>(value) > kMostVertices)
      scanner_.fail(fmt::format("a {} index within the {} read so far", what, count), at);
    return static_cast<std::uint32_t>(value - 1);
  }
  /// Positive indices may point forward, so that their range is known only now.
  void check_indices() {
    for (std::size_t f = 0; f < face_at_.size(); ++f)
      for (auto c = file_.polygons.face_begin[f]; c < file_.polygons.face_begin[f + 1]; ++c) {
        if (file_.polygons.corners[c] >= file_.polygons.positions.size())
          scanner_.fail_with(fmt::format("vertex indices up to {} in the face", file_.polygons.positions.size()),
                             fmt::format("{}", file_.polygons.corners[c] + 1), face_at_[f]);
        if (file_.corner_normal[c] != kNoNormal && file_.corner_normal[c] >= file_.normal_at.size())
          scanner_.fail_with(fmt::format("normal indices up to {} in the face", file_.normal_at.size()),
                             fmt::format("{}", file_.corner_normal[c] + 1), face_at_[f]);
      }
  }
  void other(std::string_view keyword) {
    // A file of random bytes is recognised by its first line that is none.
    if (keyword.size() > 32 || !std::all_of(keyword.begin(), keyword.end(), [](char c) { return c > ' ' && c < 127; }))
      scanner_.fail("a line of an OBJ file", scanner_.position() - keyword.size());
    if (keyword == "vt") note("texture coordinates");
    else if (keyword == "usemtl" || keyword == "mtllib") note("materials");
    else if (keyword == "g" || keyword == "o") note("groups and object names");
    else if (keyword == "s") note("smoothing groups");
    else note("other lines");
  }
  void note(const char* what) {
    if (std::find(file_.extras.begin(), file_.extras.end(), what) == file_.extras.end())
      file_.extras.emplace_back(what);
  }

  MeshFile& file_;
  Scanner scanner_;
  std::vector<std::size_t> face_at_;
};

}  // namespace

void parse_obj(MeshFile& file) { ObjParser(file).run(); }

}  // namespace vdb_offset::io
