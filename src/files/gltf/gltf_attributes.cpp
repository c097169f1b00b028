// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <limits>

#include "gltf/gltf_document.h"

namespace vdb_offset::io::gltf {
namespace {

using AttributeOf = std::optional<Accessor> Block::*;

bool has_any(const std::vector<Block>& blocks, AttributeOf part) {
  return std::any_of(blocks.begin(), blocks.end(), [&](const Block& block) { return (block.*part).has_value(); });
}

/// Which value each corner has, where some vertices have none: that of its vertex. Empty if all have one.
std::vector<std::uint32_t> corners_with(const std::vector<Block>& blocks, AttributeOf part, const Polygons& mesh) {
  std::vector<std::uint8_t> has(mesh.positions.size(), 0);
  for (const Block& block : blocks)
    if (block.*part) std::fill_n(has.begin() + block.first, block.position.count, std::uint8_t{1});
  if (std::all_of(has.begin(), has.end(), [](auto each) { return each != 0; })) return {};
  std::vector<std::uint32_t> of_corner = mesh.corners;
  for (std::uint32_t& corner : of_corner)
    if (!has[corner]) corner = kNoNormal;
  return of_corner;
}

void for_each_value(const std::vector<Block>& blocks, AttributeOf part,
                    const std::function<void(const Block&, const Accessor&, std::uint64_t)>& visit) {
  for (const Block& block : blocks)
    for (std::uint64_t i = 0; block.*part && i < block.position.count; ++i) visit(block, *(block.*part), i);
}

void read_normals(const std::vector<Block>& blocks, const Polygons& mesh, Attributes& attributes) {
  if (!has_any(blocks, &Block::normal)) return;
  auto& [value, of_corner, single] = attributes.normals;
  value.assign(mesh.positions.size(), Vec3d(0.0));
  for_each_value(blocks, &Block::normal,
                 [&normals = value](const Block& block, const Accessor& accessor, std::uint64_t i) {
                   normals[block.first + i] = block.frame.normal_to_mesh(accessor.vector(i));
                 });
  of_corner = corners_with(blocks, &Block::normal, mesh);
  single = true;
  std::erase(attributes.lost, kNormals);
}

/// Its second coordinate goes down the picture, in the other formats up.
void read_texture(const std::vector<Block>& blocks, const Polygons& mesh, Attributes& attributes) {
  if (!has_any(blocks, &Block::texture)) return;
  CornerValues<Vec2d> texture;
  texture.value.assign(mesh.positions.size(), Vec2d(0.0));
  bool finite = true;
  for_each_value(blocks, &Block::texture, [&](const Block& block, const Accessor& accessor, std::uint64_t i) {
    const Vec2d uv(accessor.number(i, 0), 1 - accessor.number(i, 1));
    texture.value[block.first + i] = uv;
    finite = finite && uv.isFinite();
  });
  if (!finite) return;
  texture.of_corner = corners_with(blocks, &Block::texture, mesh);
  attributes.texture = std::move(texture);
  std::erase(attributes.lost, kTexture);
}

/// Vertices without a colour are white, as they are shown.
void read_colours(const std::vector<Block>& blocks, const Polygons& mesh, Attributes& attributes) {
  if (!has_any(blocks, &Block::colour)) return;
  std::vector<std::array<double, 4>> colours(mesh.positions.size(), {1, 1, 1, 1});
  bool fits = true, has_alpha = false;
  for_each_value(blocks, &Block::colour, [&](const Block& block, const Accessor& accessor, std::uint64_t i) {
    has_alpha |= accessor.width == 4;
    for (std::uint32_t k = 0; k < accessor.width; ++k) {
      const double share = accessor.number(i, k);
      fits = fits && share >= 0 && share <= 1;
      colours[block.first + i][k] = share;
    }
  });
  if (!fits) return;
  attributes.colours = std::move(colours);
  attributes.has_alpha = has_alpha;
  std::erase(attributes.lost, kColours);
}

}  // namespace

void GltfDocument::read_attributes(const MeshFile& source, Attributes& attributes) const {
  read_normals(contents_.blocks, source.polygons, attributes);
  read_texture(contents_.blocks, source.polygons, attributes);
  read_colours(contents_.blocks, source.polygons, attributes);
}

}  // namespace vdb_offset::io::gltf
