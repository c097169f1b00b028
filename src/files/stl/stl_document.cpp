// SPDX-License-Identifier: Apache-2.0
#include "stl/stl_document.h"

#include <algorithm>

#include "bytes/obj_lines.h"
#include "bytes/scanner.h"
#include "stl/stl_layout.h"

namespace vdb_offset::io {

void StlRows::read_attributes(const MeshFile& source, Attributes& attributes) const {
  const std::string_view bytes = source.text();
  if (source.encoding == Encoding::Ascii) {
    Scanner scanner(source.path, bytes);
    scanner.first_word();
    if (!scanner.at_line_end()) attributes.lost.emplace_back("the name of the solid");
    return;
  }
  const auto is_filled = [](char c) { return c != '\0' && c != ' '; };
  if (std::any_of(bytes.begin(), bytes.begin() + stl::kHeader, is_filled))
    attributes.lost.emplace_back("the header's text");
  const std::size_t facets = source.polygons.face_count();
  for (std::size_t f = 1; f <= facets; ++f) {
    const std::size_t behind = stl::kFirst + f * stl::kFacet;
    if (bytes[behind - 2] == '\0' && bytes[behind - 1] == '\0') continue;
    attributes.lost.emplace_back("attribute bytes");
    break;
  }
  if (bytes.size() > stl::kFirst + facets * stl::kFacet) attributes.lost.emplace_back("bytes behind the last facet");
}

void StlRows::visit_labels(const MeshFile& source, LabelListener& listener) const {
  if (source.encoding != Encoding::Ascii) return;
  Scanner scanner(source.path, source.text());
  for (; !scanner.at_text_end(); scanner.next_line()) {
    const std::string_view keyword = scanner.token();
    if (is_word(keyword, "solid")) listener.set_groups({rest_of_line(scanner)});
    else if (is_word(keyword, "facet")) listener.add_face();
  }
}

}  // namespace vdb_offset::io
