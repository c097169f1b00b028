// SPDX-License-Identifier: Apache-2.0
#include "document/columns.h"

#include <algorithm>
#include <atomic>

#include "document/binary_number.h"
#include "ground/system/parallel.h"

namespace vdb_offset::io {

bool is_kept(Attributes& attributes, const std::string& extra) { return std::erase(attributes.lost, extra) > 0; }

bool has_extra(const MeshFile& source, std::string_view extra) {
  return std::find(source.extras.begin(), source.extras.end(), extra) != source.extras.end();
}

bool all_finite(const std::vector<Vec2d>& points) {
  return std::all_of(points.begin(), points.end(), [](const Vec2d& p) { return p.isFinite(); });
}

bool any_named(const std::vector<std::uint32_t>& of_corner) {
  return std::any_of(of_corner.begin(), of_corner.end(), [](auto n) { return n != kNoNormal; });
}

Scanner scanner_at(const MeshFile& source, std::uint64_t byte) {
  const Rows::Syntax& syntax = rows_of(source).syntax();
  return {source.path, source.text(), byte, syntax.joins_lines, syntax.comment};
}

void read_normals_of_rows(const MeshFile& source, Attributes& attributes) {
  const Rows& rows = rows_of(source);
  if (rows.normal_at.empty()) return;
  if (rows.normals_of() == NormalsOf::Corners && !any_named(rows.corner_normal)) return;
  auto& [value, of_corner, single] = attributes.normals;
  value.resize(rows.normal_at.size());
  of_corner = rows.corner_normal;
  single = rows.normal_bytes == 4;
  for_each_index(value.size(), [&normals = value, &source, &rows](std::size_t n) {
    const NumberTriple triple = rows.normal_at[n];
    for (int k = 0; k < 3; ++k)
      normals[n][k] = source.encoding == Encoding::Ascii ? number_or_nan(scanner_at(source, triple.at[k]).token())
                                                         : binary_number(source.text().data() + triple.at[k],
                                                                         {'f', rows.normal_bytes}, source.encoding);
  });
  is_kept(attributes, "normals");
}

bool take_colours(const Columns& columns, std::size_t width, double white, Attributes& attributes) {
  if (width != 3 && width != 4) return false;
  std::vector<std::array<double, 4>> colours(columns.number.size() / columns.width, {0, 0, 0, 1});
  for (std::size_t v = 0; v < colours.size(); ++v)
    for (std::size_t k = 0; k < width; ++k) {
      colours[v][k] = columns.number[v * columns.width + k] / white;
      if (!(colours[v][k] >= 0 && colours[v][k] <= 1)) return false;
    }
  attributes.colours = std::move(colours);
  attributes.has_alpha = width == 4;
  return true;
}

bool take_texture(const Columns& columns, std::size_t first, Attributes& attributes) {
  std::vector<Vec2d> texture;
  for (std::size_t at = first; at + 1 < columns.number.size(); at += columns.width)
    texture.emplace_back(columns.number[at], columns.number[at + 1]);
  if (!all_finite(texture)) return false;
  attributes.texture.value = std::move(texture);
  return true;
}

std::optional<Columns> read_tails(const MeshFile& source, const ByteOffsets& last) {
  constexpr std::size_t kMost = 6;  // words: a colour of four numbers and two texture coordinates
  const auto tail = [&](std::size_t v) {
    Scanner scanner = scanner_at(source, last[v].at[2]);
    scanner.token();
    return scanner;
  };
  Columns columns;
  for (Scanner first = tail(0); !first.at_line_end(); first.token())
    if (++columns.width > kMost) return std::nullopt;
  columns.number.resize(last.size() * columns.width);
  std::atomic<bool> same = true;
  for_each_index(last.size(), [&](std::size_t v) {
    Scanner scanner = tail(v);
    for (std::size_t k = 0; k < columns.width; ++k)
      columns.number[v * columns.width + k] = number_or_nan(scanner.token());
    if (!scanner.at_line_end()) same = false;
  });
  if (!same) return std::nullopt;
  return columns;
}

}  // namespace vdb_offset::io
