// SPDX-License-Identifier: Apache-2.0
#include "gltf/rewriting.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "bytes/append_number.h"
#include "bytes/scanner.h"

namespace vdb_offset::io::gltf {

PatchedBuffers::PatchedBuffers(const Contents& contents, const MovedMesh& moved) {
  for (const Block& block : contents.blocks) put_block(block, moved);
}

void PatchedBuffers::put_block(const Block& block, const MovedMesh& moved) {
  bool any = false, any_normal = false, any_tangent = false;
  for (std::uint64_t i = 0; i < block.position.count; ++i) {
    const std::size_t v = block.first + i;
    if (moved.has_moved(v)) {
      const Vec3d& before = moved.source.polygons.positions[v];
      put(block.position, i, block.frame.to_file(moved.precision(before, moved.positions[v])));
      any = true;
    }
    if (!block.normal || moved.normals->value.empty() || moved.normals->value[v].lengthSqr() == 0) continue;
    any_tangent |= put_normal(block, i, block.frame.normal_to_file(moved.normals->value[v]));
    any_normal = true;
  }
  if (any) changed_.push_back(block.position);
  if (any_normal) changed_.push_back(*block.normal);
  if (any_tangent) changed_.push_back(*block.tangent);
}

/// Puts a normal, and turns the tangent, if there is one, so that it is at a right angle to that. Returns whether it
/// was turned.
bool PatchedBuffers::put_normal(const Block& block, std::uint64_t i, const Vec3d& normal) {
  constexpr double kLeast = 1e-3;  // of a tangent: one that points along the normal says nothing
  put(*block.normal, i, normal);
  if (!block.tangent) return false;
  const Vec3d tangent = block.tangent->vector(i), turned = tangent - normal * normal.dot(tangent);
  const double length = turned.length();
  if (!(length > kLeast * tangent.length()) || !std::isfinite(length)) return false;
  put(*block.tangent, i, turned / length);
  return true;
}

void PatchedBuffers::put(const Accessor& accessor, std::uint64_t i, const Vec3d& value) {
  std::shared_ptr<std::string>& bytes = buffers_[accessor.buffer];
  if (!bytes) bytes = std::make_shared<std::string>(accessor.bytes);
  for (int k = 0; k < 3; ++k) {
    const auto number = static_cast<float>(value[k]);
    std::memcpy(bytes->data() + accessor.at(i) + static_cast<std::size_t>(k) * sizeof number, &number, sizeof number);
  }
}

/// The least or the largest of each component, as written. Empty if one has no finite number.
std::vector<float> PatchedBuffers::bounds_of(const Accessor& before, bool most) const {
  Accessor accessor = before;
  accessor.bytes = *buffers_.at(before.buffer);
  std::vector<float> bounds;
  for (std::uint32_t k = 0; k < accessor.width; ++k) {
    float bound = most ? -INFINITY : INFINITY;
    for (std::uint64_t i = 0; i < accessor.count; ++i) {
      const float number = accessor.single(i, k);
      if (std::isfinite(number) && (most ? number > bound : number < bound)) bound = number;
    }
    if (!std::isfinite(bound)) return {};
    bounds.push_back(bound);
  }
  return bounds;
}

void PatchedBuffers::add_bounds(std::string_view json, std::vector<Replacement>& replacements) const {
  const JsonText text(json);
  const std::optional<std::size_t> list = text.member(text.root(), "accessors");
  if (!list) return;
  const std::vector<std::size_t> accessors = text.elements(*list);
  for (const Accessor& accessor : changed_)
    for (const bool most : {false, true}) {
      const std::optional<std::size_t> array = text.member(accessors[accessor.index], most ? "max" : "min");
      if (!array || json[*array] != '[') continue;
      const std::vector<std::size_t> numbers = text.elements(*array);
      const std::vector<float> bounds = bounds_of(accessor, most);
      if (numbers.size() != bounds.size()) continue;
      for (std::size_t k = 0; k < bounds.size(); ++k) {
        const std::size_t end = text.end_of(numbers[k]);
        double written = 0;
        const bool is_number = parse_double(json.substr(numbers[k], end - numbers[k]), written);
        if (is_number && static_cast<float>(written) == bounds[k]) continue;
        std::string digits;
        append_number(digits, bounds[k], {Rounding::Kind::Single});
        replacements.push_back({numbers[k], end, std::move(digits)});
      }
    }
}

}  // namespace vdb_offset::io::gltf
