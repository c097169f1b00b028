// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/mesh_file.h"

#include <cmath>
#include <limits>

#include "document/document.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {

Attributes read_attributes(const MeshFile& source) {
  Attributes attributes;
  attributes.lost = source.extras;
  source.document->read_attributes(source, attributes);
  return attributes;
}

Materials read_materials(const MeshFile& source) { return source.document->read_materials(source); }

std::vector<Vec2d> vertex_texture(const MeshFile& source) {
  const CornerValues<Vec2d> texture = read_attributes(source).texture;
  if (texture.empty())
    throw InvalidInput(source.path + ": expected texture coordinates, which the distance uses (u, v), found none");
  const Polygons& mesh = source.polygons;
  std::vector<Vec2d> of_vertex(mesh.positions.size(), Vec2d(0.0));
  std::vector<std::uint8_t> has_value(of_vertex.size(), 0);
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    const std::uint32_t v = mesh.corners[c], t = texture.index(c, v);
    if (has_value[v]) continue;
    has_value[v] = t != kNoNormal;
    of_vertex[v] = t == kNoNormal ? Vec2d(std::numeric_limits<double>::quiet_NaN()) : texture.value[t];
  }
  return of_vertex;
}

}  // namespace vdb_offset::io
