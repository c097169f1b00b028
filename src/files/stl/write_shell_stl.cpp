// SPDX-License-Identifier: Apache-2.0
// Writes a shell of an STL file in the encoding of the source. A text gets a solid for each part, with the source's
// name behind the part's; facets are laid out anew, but a number that did not change keeps its text. A binary file
// keeps its header, the attribute bytes of facets and what stands behind the last one; its count is new. Facets of the
// inner skin have the source's normals with the other sign, or new ones where they moved. The rim is split into
// triangles, with normals of their own and the attribute bytes of the facets at their border. What is lost is named:
// several solids of a text, and the parts in a binary file, which has no names for them.
#include <array>
#include <cstring>

#include "bytes/append_number.h"
#include "bytes/scanner.h"
#include "derived/shell_writers.h"
#include "ground/mesh/triangulate.h"
#include "stl/stl_document.h"
#include "stl/stl_layout.h"

namespace vdb_offset::io {
namespace {

/// A triangle of the rim, and the face of the source that it comes from.
struct RimFacet {
  std::array<std::uint32_t, 3> corners;  // vertices of the shell
  std::uint32_t source_face;
};

std::vector<RimFacet> split_rim(const Shell& shell) {
  std::vector<RimFacet> facets;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t f = 2 * shell.skin_faces(); f < shell.polygons.face_count(); ++f) {
    triangles.clear();
    append_triangles(shell.view(), f, triangles);
    for (const auto& triangle : triangles) facets.push_back({triangle, shell.source_face(f)});
  }
  return facets;
}

class StlShellWriter {
 public:
  explicit StlShellWriter(const SharedShell& content)
      : content_(content), source_(content->source), shell_(content->shell), rim_(split_rim(shell_)) {}

  std::size_t rim_facets() const { return rim_.size(); }

  /// Appends facet f of a skin.
  void append_text(std::string& text, ShellPart part, std::size_t f) const {
    text += "  facet normal";
    content_->skin(part).append_normal(text, shell_.source_face(f));
    text += "\n    outer loop\n";
    for (const std::uint32_t v : corners(part, f)) append_vertex(text, v);
    text += "    endloop\n  endfacet\n";
  }
  void append_rim_text(std::string& text, std::size_t i) const {
    text += "  facet normal";
    const Vec3d normal = rim_normal(i);
    for (int k = 0; k < 3; ++k) append_number(text += ' ', normal[k], {Rounding::Kind::Single});
    text += "\n    outer loop\n";
    for (const std::uint32_t v : rim_[i].corners) append_vertex(text, v);
    text += "    endloop\n  endfacet\n";
  }

  void append_binary_facet(std::string& bytes, ShellPart part, std::size_t f) const {
    const Skin& skin = content_->skin(part);
    const std::uint32_t of_source = shell_.source_face(f);
    if (const auto normal = skin.new_normal(of_source)) append_floats(bytes, *normal);
    else append_old_normal(bytes, of_source, skin.is_reversed());
    for (const std::uint32_t v : corners(part, f)) append_floats(bytes, position(v));
    append_attribute(bytes, of_source);
  }
  void append_binary_rim(std::string& bytes, std::size_t i) const {
    append_floats(bytes, rim_normal(i));
    for (const std::uint32_t v : rim_[i].corners) append_floats(bytes, position(v));
    append_attribute(bytes, rim_[i].source_face);
  }

 private:
  std::span<const std::uint32_t> corners(ShellPart part, std::size_t f) const {
    return shell_.polygons.view().face(part == ShellPart::Inner ? shell_.skin_faces() + f : f);
  }
  void append_vertex(std::string& text, std::uint32_t v) const {
    text += "      vertex";
    const auto [skin, number] = content_->vertex(v);
    skin.append_position(text, number);
    text += '\n';
  }
  Vec3d position(std::uint32_t v) const {
    const auto [skin, number] = content_->vertex(v);
    return skin.position(number);
  }
  Vec3d rim_normal(std::size_t i) const {
    const auto& [a, b, c] = rim_[i].corners;
    const Vec3d normal = (position(b) - position(a)).cross(position(c) - position(a));
    return normal.length() > 0 ? normal / normal.length() + Vec3d(0.0) : Vec3d(0.0);  // adding 0 turns -0 into 0
  }

  static void append_floats(std::string& bytes, const Vec3d& p) {
    for (int k = 0; k < 3; ++k) append_binary(bytes, static_cast<float>(p[k]));
  }
  void append_old_normal(std::string& bytes, std::size_t f, bool reversed) const {
    const NumberTriple at = rows_of(source_).normal_at[f];
    for (const std::uint64_t byte : at.at) {
      float number = 0;
      std::memcpy(&number, source_.text().data() + byte, sizeof number);
      append_binary(bytes, reversed ? 0.0f - number : number);
    }
  }
  void append_attribute(std::string& bytes, std::size_t source_face) const {
    bytes += source_.text().substr(stl::kFirst + source_face * stl::kFacet + stl::kAttribute, 2);
  }

  SharedShell content_;
  const MeshFile& source_;
  const Shell& shell_;
  std::vector<RimFacet> rim_;
};

using SharedStlWriter = std::shared_ptr<const StlShellWriter>;

/// The name behind "solid", with the blank before it; in a file of several solids, that of the first. `solids` gets
/// their number.
std::string solid_name(const MeshFile& source, std::size_t& solids) {
  Scanner scanner(source.path, source.text(), byte_order_mark(source.text()));
  std::string name;
  for (solids = 0; !scanner.at_text_end(); scanner.next_line()) {
    if (!is_word(scanner.token(), "solid")) continue;
    while (solids == 0 && !scanner.at_line_end()) (name += ' ') += scanner.token();
    ++solids;
  }
  return name;
}

Pieces solids(const SharedShell& content, const SharedStlWriter& writer, std::vector<std::string>& lost) {
  std::size_t count = 0;
  std::string of_source = solid_name(content->source, count);
  if (count > 1) {
    of_source.clear();
    lost.emplace_back("the source's solids and their names");
  }
  std::vector<Pieces> parts;
  const auto add = [&](ShellPart part, const std::string& behind, std::size_t facets, auto&& append) {
    if (facets == 0) return;
    const std::string title = name(part) + behind + "\n";
    parts.push_back(in_sections("solid " + title, {{facets, append}, {1, [=](std::string& text, std::size_t) {
                                                                        text += "endsolid " + title;
                                                                      }}}));
  };
  for (const ShellPart part : {ShellPart::Outer, ShellPart::Inner})
    add(part, of_source, content->shell.skin_faces(),
        [=](std::string& text, std::size_t f) { writer->append_text(text, part, f); });
  add(ShellPart::Rim, "", writer->rim_facets(),
      [=](std::string& text, std::size_t i) { writer->append_rim_text(text, i); });
  return in_a_row(std::move(parts));
}

Pieces binary_stl(const SharedShell& content, const SharedStlWriter& writer) {
  const std::size_t faces = content->shell.skin_faces();
  std::string header(content->source.text().substr(0, stl::kHeader));
  append_binary(header, static_cast<std::uint32_t>(2 * faces + writer->rim_facets()));
  const auto skin = [&](ShellPart part) {
    return Section{faces, [=](std::string& bytes, std::size_t f) { writer->append_binary_facet(bytes, part, f); }};
  };
  const std::size_t end = stl::kFirst + content->source.polygons.face_count() * stl::kFacet;
  return in_sections(
      header, {skin(ShellPart::Outer),
               skin(ShellPart::Inner),
               {writer->rim_facets(), [=](std::string& bytes, std::size_t i) { writer->append_binary_rim(bytes, i); }},
               {1, [=](std::string& bytes, std::size_t) { bytes += content->source.text().substr(end); }}});
}

}  // namespace

Pieces StlRows::with_shell(const std::shared_ptr<const ShellContent>& content, std::vector<std::string>& lost) const {
  const auto writer = std::make_shared<const StlShellWriter>(content);
  if (content->source.encoding == Encoding::Ascii) return solids(content, writer, lost);
  lost.emplace_back(kShellParts);
  return binary_stl(content, writer);
}

}  // namespace vdb_offset::io
