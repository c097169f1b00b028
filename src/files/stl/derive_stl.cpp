// SPDX-License-Identifier: Apache-2.0
// Writes an STL file over a mesh that is made of its own, in the encoding of the source. A binary file keeps its
// header, the attribute bytes of facets and what stands behind the last one; its count is new. The pieces of a facet
// have its normal, and in a text all words, remarks and line ends of it. Facets of an inner skin have the source's
// normals with the other sign, or new ones where they moved; those of a rim, which is split into triangles, have their
// own. The text of a shell is laid out anew and gets a solid for each part, with the source's name behind the part's; a
// number that did not change keeps its text. What is lost is named: several solids of a text, and the parts in a binary
// file, which has no names for them.
#include <array>
#include <cstring>

#include "bytes/append_number.h"
#include "bytes/scanner.h"
#include "derived/derived_mesh.h"
#include "document/convert.h"
#include "ground/mesh/triangulate.h"
#include "stl/stl_document.h"
#include "stl/stl_layout.h"

namespace vdb_offset::io {
namespace {

/// A facet to be: its corners, and the face that it is of.
struct DerivedFacet {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t face;
};

class StlDeriver {
 public:
  explicit StlDeriver(SharedDerived derived) : derived_(std::move(derived)), source_(derived_->source()) {
    const FaceRange rim = derived_->faces_of(ShellPart::Rim);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::uint32_t f = rim.begin; f < rim.end; ++f) {
      triangles.clear();
      append_triangles(derived_->mesh(), f, triangles);
      for (const auto& triangle : triangles) rim_.push_back({triangle, f});
    }
  }

  std::size_t facets(ShellPart part) const {
    return part == ShellPart::Rim ? rim_.size() : derived_->faces_of(part).size();
  }
  DerivedFacet facet(ShellPart part, std::size_t i) const {
    if (part == ShellPart::Rim) return rim_[i];
    const std::uint32_t f = derived_->faces_of(part).begin + static_cast<std::uint32_t>(i);
    const auto corners = derived_->mesh().face(f);
    return {{corners[0], corners[1], corners[2]}, f};
  }

  void append_binary_facet(std::string& bytes, const DerivedFacet& facet) const {
    const std::uint32_t parent = derived_->parent(facet.face);
    const std::string_view own = source_.text().substr(stl::kFirst + parent * stl::kFacet, stl::kFacet);
    const bool inner = derived_->part(facet.face) == ShellPart::Inner;
    if (const auto normal = new_normal(facet)) append_floats(bytes, *normal);
    else
      for (std::size_t k = 0; k < 3; ++k) {
        float number = 0;
        std::memcpy(&number, own.data() + k * sizeof number, sizeof number);
        append_binary(bytes, inner ? 0.0f - number : number);
      }
    for (const std::uint32_t v : facet.corners) append_floats(bytes, derived_->position(v));
    bytes += own.substr(stl::kAttribute);
  }

  void append_facet(std::string& text, const DerivedFacet& facet) const {
    text += "  facet normal";
    for (const std::string& word : normal_of(facet)) (text += ' ') += word;
    text += "\n    outer loop\n";
    for (const std::uint32_t v : facet.corners) {
      derived_->append_position(text += "      vertex", v);
      text += '\n';
    }
    text += "    endloop\n  endfacet\n";
  }

  /// Appends the pieces of a facet of a text, with what stands between it and the facet before.
  void append_pieces(std::string& text, std::uint32_t of) const {
    const std::size_t begin = begin_of(of), gap = of > 0 ? end_of(of - 1) : 0;
    text += source_.text().substr(gap, begin - gap);
    const std::string between = line_before(begin);
    const FaceRange pieces = derived_->pieces_of(of);
    for (std::uint32_t f = pieces.begin; f < pieces.end; ++f) {
      if (f > pieces.begin) text += between;
      append_piece(text, f, begin, end_of(of));
    }
  }
  /// What stands behind the last facet.
  void append_rest(std::string& text) const {
    text += source_.text().substr(end_of(static_cast<std::uint32_t>(source_.polygons.face_count()) - 1));
  }

 private:
  /// None if it is that of the parent, but for the sign of an inner one.
  std::optional<Vec3d> new_normal(const DerivedFacet& facet) const {
    const ShellPart part = derived_->part(facet.face);
    if (part != ShellPart::Rim) return derived_->new_normal(derived_->parent(facet.face), part == ShellPart::Inner);
    const auto at = [&](std::size_t k) { return derived_->position(facet.corners[k]); };
    const Vec3d normal = (at(1) - at(0)).cross(at(2) - at(0));
    return normal.length() > 0 ? normal / normal.length() + Vec3d(0.0) : Vec3d(0.0);  // adding 0 turns -0 into 0
  }
  std::array<std::string, 3> normal_of(const DerivedFacet& facet) const {
    const ShellPart part = derived_->part(facet.face);
    if (part != ShellPart::Rim) return derived_->normal_words(derived_->parent(facet.face), part == ShellPart::Inner);
    const Vec3d normal = *new_normal(facet);
    std::array<std::string, 3> words;
    for (std::size_t k = 0; k < 3; ++k) append_number(words[k], normal[static_cast<int>(k)], {Rounding::Kind::Single});
    return words;
  }
  static void append_floats(std::string& bytes, const Vec3d& p) {
    for (int k = 0; k < 3; ++k) append_binary(bytes, static_cast<float>(p[k]));
  }

  /// Appends a piece: the facet from `begin` to `end` with other coordinates.
  void append_piece(std::string& text, std::uint32_t f, std::size_t begin, std::size_t end) const {
    const auto own = source_.polygons.view().face(derived_->parent(f)), face = derived_->mesh().face(f);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const NumberTriple to = rows_of(source_).position_at[own[corner]],
                         from = rows_of(source_).position_at[derived_->origin(face[corner]).vertex[0]];
      for (int k = 0; k < 3; ++k) {
        text += source_.text().substr(begin, to.at[k] - begin);
        begin = to.at[k] + word_at(to.at[k]).size();
        derived_->append_coordinate(text, face[corner], k, word_at(from.at[k]));
      }
    }
    text += source_.text().substr(begin, end - begin);
  }

  /// Where the word `facet` begins: two words in front of the normal.
  std::size_t begin_of(std::uint32_t f) const {
    std::size_t at = rows_of(source_).normal_at[f].at[0];
    for (int words = 0; words < 2; ++words) {
      at = source_.text().find_last_not_of(kBlanks, at - 1);
      at = source_.text().find_last_of(kBlanks, at) + 1;
    }
    return at;
  }
  /// Where the word `endfacet` ends. Remarks may stand between it and the loop's end.
  std::size_t end_of(std::uint32_t f) const {
    Scanner scanner(source_.path, source_.text(), rows_of(source_).position_at[3 * std::size_t{f} + 2].at[2]);
    scanner.token();
    scanner.token_anywhere("'endloop'");
    stl::skip_remark(scanner);
    scanner.token_anywhere("'endfacet'");
    return scanner.position();
  }
  /// What parts two facets: the end of a line and the blanks in front of the facet, as far as they are there.
  std::string line_before(std::size_t begin) const {
    const std::string_view before = source_.text().substr(0, begin);
    const std::size_t last = before.find_last_not_of(" \t"), line = last == std::string_view::npos ? 0 : last + 1;
    if (line == 0 || before[line - 1] != '\n') return " ";
    const bool has_return = line > 1 && before[line - 2] == '\r';
    return std::string(before.substr(line - (has_return ? 2 : 1)));
  }
  std::string_view word_at(std::uint64_t byte) const { return Scanner(source_.path, source_.text(), byte).token(); }

  static constexpr const char* kBlanks = " \t\r\n\v\f";

  SharedDerived derived_;
  const MeshFile& source_;
  std::vector<DerivedFacet> rim_;
};

using SharedStlDeriver = std::shared_ptr<const StlDeriver>;
constexpr ShellPart kParts[] = {ShellPart::Outer, ShellPart::Inner, ShellPart::Rim};

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

Pieces text_of_solids(const MeshFile& source, const SharedStlDeriver& deriver, std::vector<std::string>& lost) {
  std::size_t count = 0;
  std::string of_source = solid_name(source, count);
  if (count > 1) {
    of_source.clear();
    lost.emplace_back("the source's solids and their names");
  }
  std::vector<Section> sections;
  const auto add_line = [&](const std::string& line) {
    sections.push_back({1, [=](std::string& text, std::size_t) { (text += line) += '\n'; }});
  };
  for (const ShellPart part : kParts) {
    if (deriver->facets(part) == 0) continue;
    const std::string title = std::string("solid ") + name(part) + (part == ShellPart::Rim ? "" : of_source);
    add_line(title);
    sections.push_back({deriver->facets(part), [=](std::string& text, std::size_t i) {
                          deriver->append_facet(text, deriver->facet(part, i));
                        }});
    add_line("end" + title);
  }
  return in_sections({}, std::move(sections));
}

Pieces text_with_pieces(const MeshFile& source, const SharedStlDeriver& deriver) {
  return in_sections(
      {}, {{source.polygons.face_count(),
            [=](std::string& text, std::size_t f) { deriver->append_pieces(text, static_cast<std::uint32_t>(f)); }},
           {deriver->facets(ShellPart::Rim),
            [=](std::string& text, std::size_t i) {
              if (i == 0) text += '\n';
              deriver->append_facet(text, deriver->facet(ShellPart::Rim, i));
            }},
           {1, [=](std::string& text, std::size_t) { deriver->append_rest(text); }}});
}

Pieces binary_facets(const MeshFile& source, const SharedStlDeriver& deriver) {
  std::vector<Section> sections;
  std::size_t facets = 0;
  for (const ShellPart part : kParts) {
    facets += deriver->facets(part);
    sections.push_back({deriver->facets(part), [=](std::string& bytes, std::size_t i) {
                          deriver->append_binary_facet(bytes, deriver->facet(part, i));
                        }});
  }
  const std::string_view rest = source.text().substr(stl::kFirst + source.polygons.face_count() * stl::kFacet);
  sections.push_back({1, [=](std::string& bytes, std::size_t) { bytes += rest; }});
  std::string header(source.text().substr(0, stl::kHeader));
  append_binary(header, static_cast<std::uint32_t>(facets));
  return in_sections(header, std::move(sections));
}

}  // namespace

WrittenDocument StlRows::derive(const SharedDerived& derived, const std::string&) const {
  const auto deriver = std::make_shared<const StlDeriver>(derived);
  const MeshFile& source = derived->source();
  WrittenDocument written;
  if (source.encoding != Encoding::Ascii) {
    if (derived->is_shell()) written.lost.emplace_back(kShellParts);
    written.file = binary_facets(source, deriver);
  } else {
    written.file =
        derived->is_shell() ? text_of_solids(source, deriver, written.lost) : text_with_pieces(source, deriver);
  }
  return written;
}

}  // namespace vdb_offset::io
