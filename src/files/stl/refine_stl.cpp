// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include "bytes/append_number.h"
#include "bytes/scanner.h"
#include "derived/refine_writers.h"
#include "stl/stl_document.h"
#include "stl/stl_layout.h"

// Each piece is the facet itself with other coordinates, so that normals, attribute bytes and remarks stay.
namespace vdb_offset::io {
namespace {

class StlRefiner {
 public:
  explicit StlRefiner(const SharedRefined& content) : content_(content), source_(content->source) {}

  /// Appends the pieces of a facet of a binary file.
  void append_facet(std::string& bytes, std::size_t f) const {
    const std::string_view facet = source_.text().substr(stl::kFirst + f * stl::kFacet, stl::kFacet);
    if (!content_->is_split(f)) {
      bytes += facet;
      return;
    }
    for (std::uint32_t piece = content_->first_piece[f]; piece < content_->first_piece[f + 1]; ++piece) {
      bytes += facet.substr(0, stl::kNormal);
      for (const std::uint32_t v : content_->refined().face(piece))
        for (int k = 0; k < 3; ++k) append_binary(bytes, static_cast<float>(content_->refined().positions[v][k]));
      bytes += facet.substr(stl::kAttribute);
    }
  }

  /// Appends the pieces of a facet of a text, with what stands between it and the facet before.
  void append_text(std::string& text, std::size_t f) const {
    const std::size_t begin = begin_of(f), end = end_of(f);
    const std::size_t gap = f > 0 ? end_of(f - 1) : 0;
    text += source_.text().substr(gap, begin - gap);
    const std::string between = line_before(begin);
    for (std::uint32_t piece = content_->first_piece[f]; piece < content_->first_piece[f + 1]; ++piece) {
      if (piece > content_->first_piece[f]) text += between;
      append_piece(text, f, piece, begin, end);
    }
  }
  /// What stands behind the last facet.
  void append_rest(std::string& text) const {
    text += source_.text().substr(end_of(content_->mesh().face_count() - 1));
  }

 private:
  /// Where the word `facet` begins: two words in front of the normal.
  std::size_t begin_of(std::size_t f) const {
    std::size_t at = rows_of(source_).normal_at[f].at[0];
    for (int words = 0; words < 2; ++words) {
      at = source_.text().find_last_not_of(kBlanks, at - 1);
      at = source_.text().find_last_of(kBlanks, at) + 1;
    }
    return at;
  }
  /// Where the word `endfacet` ends. Remarks may stand between it and the loop's end.
  std::size_t end_of(std::size_t f) const {
    Scanner scanner(source_.path, source_.text(), rows_of(source_).position_at[3 * f + 2].at[2]);
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

  void append_piece(std::string& text, std::size_t f, std::uint32_t piece, std::size_t begin, std::size_t end) const {
    const auto own = content_->mesh().face(f), face = content_->refined().face(piece);
    std::size_t copied = begin;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const NumberTriple to = rows_of(source_).position_at[own[corner]];
      const auto* const known = std::find(own.data(), own.data() + own.size(), face[corner]);
      for (int k = 0; k < 3; ++k) {
        text += source_.text().substr(copied, to.at[k] - copied);
        copied = to.at[k] + word_at(to.at[k]).size();
        if (known != own.data() + own.size()) text += word_at(rows_of(source_).position_at[*known].at[k]);
        else append_number(text, content_->refined().positions[face[corner]][k], source_.precision);
      }
    }
    text += source_.text().substr(copied, end - copied);
  }
  std::string_view word_at(std::uint64_t byte) const { return Scanner(source_.path, source_.text(), byte).token(); }

  static constexpr const char* kBlanks = " \t\r\n\v\f";

  SharedRefined content_;
  const MeshFile& source_;
};

}  // namespace

Pieces StlRows::refined(const std::shared_ptr<const RefinedContent>& content, std::vector<std::string>&) const {
  const auto refiner = std::make_shared<const StlRefiner>(content);
  const std::size_t facets = content->mesh().face_count();
  if (content->source.encoding == Encoding::Ascii)
    return in_sections("", {{facets, [=](std::string& text, std::size_t f) { refiner->append_text(text, f); }},
                            {1, [=](std::string& text, std::size_t) { refiner->append_rest(text); }}});
  const std::string_view bytes = content->source.text();
  std::string header(bytes.substr(0, stl::kHeader));
  append_binary(header, static_cast<std::uint32_t>(content->refined().face_count()));
  return in_sections(
      header, {{facets, [=](std::string& text, std::size_t f) { refiner->append_facet(text, f); }},
               {1, [=](std::string& text, std::size_t) { text += bytes.substr(stl::kFirst + facets * stl::kFacet); }}});
}

}  // namespace vdb_offset::io
