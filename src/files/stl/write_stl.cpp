// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "document/append_values.h"
#include "document/format_readers.h"

namespace vdb_offset::io {
namespace {

void append_facet(std::string& bytes, const std::array<Vec3d, 3>& corner) {
  Vec3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  if (normal.length() > 0) normal /= normal.length();
  for (const Vec3d& row : {normal, corner[0], corner[1], corner[2]})
    for (int k = 0; k < 3; ++k) append_binary(bytes, static_cast<float>(row[k]));
  append_binary(bytes, std::uint16_t{0});
}

}  // namespace

Pieces to_stl(const SharedContent& content) {
  const PolygonView& mesh = content->mesh;
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  const auto made = std::make_shared<const Triangles>(mesh.triangles.empty() ? split_polygons(mesh) : Triangles());
  const std::span<const std::array<std::uint32_t, 3>> triangles = mesh.triangles.empty() ? *made : mesh.triangles;
  std::string header(80, '\0');
  append_binary(header, static_cast<std::uint32_t>(triangles.size()));
  return in_sections(header, {{triangles.size(), [content, made, triangles](std::string& bytes, std::size_t t) {
                                 const auto& at = content->mesh.positions;
                                 const Rounding single{Rounding::Kind::Single};
                                 const auto& [a, b, c] = triangles[t];
                                 append_facet(bytes, {single(at[a]), single(at[b]), single(at[c])});
                               }}});
}

}  // namespace vdb_offset::io
