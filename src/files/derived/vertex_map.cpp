// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bytes/append_number.h"
#include "bytes/chunked_output.h"
#include "vdb_offset/io/derived_file.h"

namespace vdb_offset::io {
namespace {

void append_origin(std::string& text, std::size_t vertex, const VertexOrigin& origin) {
  append_integer(text, vertex);
  append_integer(text += ' ', origin.face);
  for (const std::uint32_t v : origin.vertex) append_integer(text += ' ', v);
  for (const double share : origin.share) append_number(text += ' ', share);
  text += '\n';
}

}  // namespace

void write_vertex_map(const std::string& path, const Refinement& refinement, std::span<const std::uint32_t> of_file) {
  const std::size_t first = refinement.source_vertices();
  const std::string header = "# vertex face v0 v1 v2 s0 s1 s2: an added vertex is s0 v0 + s1 v1 + s2 v2\n";
  const auto append_added = [&](std::string& text, std::size_t i) {
    append_origin(text, first + i, refinement.added[i]);
  };
  const auto append_of_file = [&](std::string& text, std::size_t v) {
    if (of_file[v] >= first) append_origin(text, v, refinement.added[of_file[v] - first]);
  };
  const auto append_face = [&](std::string& text, std::size_t i) {
    if (i == 0) text += "# face parent: a face over a ridge, and one of the source beside it\n";
    append_integer(text, refinement.faces_in_place() + i);
    append_integer(text += ' ', refinement.parent[refinement.faces_in_place() + i]);
    text += '\n';
  };
  const Section vertices =
      of_file.empty() ? Section{refinement.added.size(), append_added} : Section{of_file.size(), append_of_file};
  write_pieces(path, in_sections(header, {vertices, {refinement.over_ridges, append_face}}));
}

}  // namespace vdb_offset::io
