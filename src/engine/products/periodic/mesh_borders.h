// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The borders of a mesh, by the first vertex at each position.
struct MeshBorders {
  explicit MeshBorders(PolygonView mesh);

  std::vector<std::uint32_t> first;               ///< Of each vertex of the mesh.
  std::vector<std::uint32_t> vertices;            ///< On borders.
  std::vector<Vec3d> points;                      ///< Where these are.
  std::map<std::uint32_t, std::uint32_t> number;  ///< Of each of these vertices.
  std::set<std::array<std::uint32_t, 2>> edges;   ///< In the direction in which their faces run.
};

}  // namespace vdb_offset
