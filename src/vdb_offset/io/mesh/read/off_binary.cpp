#include "vdb_offset/io/mesh/read/off_binary.h"

#include <algorithm>
#include <cstring>

#include "vdb_offset/io/base/scanner.h"
#include "vdb_offset/io/mesh/read/ply_header.h"

namespace vdb_offset::io::off {
namespace {

template <class T>
void append_big(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}
void append_count(std::string& bytes, std::size_t value) { append_big(bytes, static_cast<std::int32_t>(value)); }

/// The source's records with other numbers at some places.
class BinaryShellWriter {
 public:
  explicit BinaryShellWriter(const SharedShell& content)
      : content_(content),
        source_(content->source),
        shell_(content->shell),
        layout_(layout_of(source_)),
        face_at_(face_places(source_)) {}

  std::string start() const {
    std::string bytes(source_.text().substr(0, *binary_begin(source_)));
    append_count(bytes, shell_.polygons.positions.size());
    append_count(bytes, shell_.polygons.face_count());
    append_count(bytes, 0);
    return bytes;
  }
  void append_vertex(std::string& bytes, ShellPart part, std::size_t v) const {
    const Skin& skin = content_->skin(part);
    const std::uint64_t begin = source_.position_at[v].at[0];
    const std::size_t start = bytes.size();
    bytes += source_.text().substr(begin, 4 * layout_.width);
    const auto put = [&](std::size_t first, const Vec3d& numbers) {
      std::string raw;
      for (int k = 0; k < 3; ++k) append_big(raw, static_cast<float>(numbers[k]));
      bytes.replace(start + 4 * first, raw.size(), raw);
    };
    if (const auto position = skin.new_position(v)) put(0, *position);
    if (layout_.normal == 0) return;
    const std::uint64_t at = begin + 4 * layout_.normal;
    if (const auto normal = skin.new_normal(v)) put(layout_.normal, *normal);
    else if (skin.is_reversed())
      put(layout_.normal,
          Vec3d(0.0) - Vec3d(number_at(source_, at), number_at(source_, at + 4), number_at(source_, at + 8)));
  }
  /// With the colour of the face that it comes from.
  void append_face(std::string& bytes, std::size_t f) const {
    const auto face = shell_.polygons.view().face(f);
    append_count(bytes, face.size());
    for (const auto v : face) append_count(bytes, v);
    const std::uint32_t of_mesh = shell_.source_face(f);
    const std::uint64_t colour = face_at_[of_mesh] + 4 * (1 + source_.polygons.view().face(of_mesh).size());
    bytes += source_.text().substr(colour, face_at_[of_mesh + 1] - colour);
  }

 private:
  SharedShell content_;
  const MeshFile& source_;
  const Shell& shell_;
  Layout layout_;
  std::vector<std::uint64_t> face_at_;
};

}  // namespace

Layout layout_of(const MeshFile& file) {
  const auto holds = [&](const char* what) {
    return std::find(file.extras.begin(), file.extras.end(), what) != file.extras.end();
  };
  Layout layout;
  const auto take = [&](const char* what, std::size_t& place, std::size_t width) {
    if (!holds(what)) return;
    place = layout.width;
    layout.width += width;
  };
  take("normals", layout.normal, 3);
  take("vertex colours", layout.colour, 4);
  take("texture coordinates", layout.texture, 2);
  return layout;
}

std::optional<std::size_t> binary_begin(const MeshFile& file) {
  const std::string_view text = file.text();
  constexpr std::size_t kLongestLine = 80;
  const std::size_t end = text.substr(0, kLongestLine).find_first_of("\r\n");
  if (end == std::string_view::npos) return std::nullopt;
  Scanner words(file.path, text.substr(0, end));
  words.token();
  if (!is_word(words.token(), "binary") || !words.at_line_end()) return std::nullopt;
  return end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
}

double number_at(const MeshFile& file, std::uint64_t at) {
  return ply::binary_number(file.text().data() + at, {'f', 4}, Encoding::BigEndian);
}

std::int64_t integer_at(const MeshFile& file, std::uint64_t at) {
  return static_cast<std::int64_t>(ply::binary_number(file.text().data() + at, {'i', 4}, Encoding::BigEndian));
}

std::vector<std::uint64_t> face_places(const MeshFile& file) {
  const std::size_t vertices = file.polygons.positions.size();
  std::vector<std::uint64_t> places{*binary_begin(file) + 12 + 4 * layout_of(file).width * vertices};
  for (std::size_t f = 0; f < file.polygons.face_count(); ++f) {
    const std::uint64_t colours = places.back() + 4 * (1 + file.polygons.view().face(f).size());
    places.push_back(colours + 4 * (1 + static_cast<std::uint64_t>(integer_at(file, colours))));
  }
  return places;
}

Pieces shell_to_binary(const SharedShell& content) {
  const auto writer = std::make_shared<const BinaryShellWriter>(content);
  const std::size_t vertices = content->shell.source_vertices();
  return in_sections(
      writer->start(),
      {{vertices, [=](std::string& bytes, std::size_t v) { writer->append_vertex(bytes, ShellPart::Outer, v); }},
       {vertices, [=](std::string& bytes, std::size_t v) { writer->append_vertex(bytes, ShellPart::Inner, v); }},
       {content->shell.polygons.face_count(),
        [=](std::string& bytes, std::size_t f) { writer->append_face(bytes, f); }}});
}

}  // namespace vdb_offset::io::off
