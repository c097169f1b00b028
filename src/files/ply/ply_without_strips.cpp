// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bytes/append_number.h"
#include "ply/ply_document.h"
#include "ply/ply_rows.h"

namespace vdb_offset::io {
namespace ply {
namespace {

/// Writes a file of strips with their triangles as faces: the element `tristrips` becomes `face`, and all others stay
/// but for one of that name, which holds no faces.
class StripReplacer {
 public:
  explicit StripReplacer(const MeshFile& source)
      : source_(source),
        header_(read_header(source)),
        strips_(*find_strips(header_)),
        list_(*std::find_if(strips_.properties.begin(), strips_.properties.end(), is_corner_list)) {}

  std::string run(std::vector<std::string>& lost) const {
    lost.emplace_back("strips of triangles (the triangles are there, as faces)");
    for (const Property& property : strips_.properties)
      if (&property != &list_) lost.push_back("property '" + property.name + "' of triangle strips");
    std::string bytes = header();
    BodyReader body(source_, header_);
    for (const Element& element : header_.elements) {
      const std::size_t begin = body.position();
      for (std::size_t row = 0; row < element.count && !element.properties.empty(); ++row)
        for (const Property& property : element.properties) body.skip(property);
      if (&element == &strips_) append_faces(bytes);
      else if (element.name != "face") bytes += source_.text().substr(begin, body.position() - begin);
      else if (element.count > 0) lost.emplace_back("element 'face' (it holds no faces)");
    }
    return bytes += source_.text().substr(body.position());
  }

 private:
  std::string header() const {
    const std::string_view lines = source_.text().substr(0, header_.end);
    std::string text;
    std::string_view element;
    bool list_found = false;
    for (std::size_t at = 0; at < lines.size();) {
      const std::size_t newline = std::min(lines.find(header_.line_end, at), lines.size() - 1);
      const std::string_view line = lines.substr(at, newline + 1 - at);
      at = newline + 1;
      Scanner words(source_.path, line);
      const std::string_view keyword = words.token();
      const bool is_property = keyword == "property";
      if (keyword == "element") element = words.token();
      if ((keyword == "element" || is_property) && element == "face") continue;
      if (keyword == "element" && element == strips_.name) {
        text += "element face ";
        append_integer(text, source_.polygons.face_count());
        text += line.substr(line.find_last_not_of("\r\n") + 1);
      } else if (is_property && element == strips_.name) {
        const bool is_list = !list_found && words.token() == "list";
        for (int word = 0; is_list && word < 2; ++word) words.token();
        if (!is_list || words.token() != list_.name) continue;
        list_found = true;
        text += line;
      } else {
        text += line;
      }
    }
    return text;
  }

  void append_faces(std::string& bytes) const {
    for (std::size_t f = 0; f < source_.polygons.face_count(); ++f) {
      const auto face = source_.polygons.view().face(f);
      if (header_.encoding != Encoding::Ascii) {
        append_binary_as(bytes, static_cast<double>(face.size()), *list_.count, header_.encoding);
        for (const auto v : face) append_binary_as(bytes, v, list_.type, header_.encoding);
        continue;
      }
      append_integer(bytes += header_.line_end, face.size());
      for (const auto v : face) append_integer(bytes += ' ', v);
    }
  }

  const MeshFile& source_;
  Header header_;
  const Element& strips_;
  const Property& list_;
};

}  // namespace
}  // namespace ply

std::string PlyRows::with_face_rows(const MeshFile& source, std::vector<std::string>& lost) const {
  return ply::StripReplacer(source).run(lost);
}

}  // namespace vdb_offset::io
