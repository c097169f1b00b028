// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "document/encode.h"

namespace vdb_offset::io::gltf {

/// The triangles of a content over vertices that have one normal and one pair of texture coordinates each, as the
/// format needs. The mesh's vertices come first, in their order; those with several have copies behind them.
struct SplitVertices {
  std::vector<std::uint32_t> origin;                    ///< The mesh's vertex, for each.
  std::vector<Vec3d> normals;                           ///< Of length 1; or empty.
  std::vector<Vec2d> texture;                           ///< Or empty.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Face by face.
  std::vector<std::uint32_t> triangle_begin;            ///< The first triangle of each face, and their number.

  explicit SplitVertices(const Content& content);
};

}  // namespace vdb_offset::io::gltf
