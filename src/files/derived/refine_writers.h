// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "bytes/chunked_output.h"
#include "derived/refined_corners.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset::io {

/// A refinement that is to be written in the format of its source. Refers to both.
struct RefinedContent {
  const MeshFile& source;
  const Refinement& refinement;
  std::vector<std::uint32_t> first_piece = first_pieces(source.polygons.view(), refinement);

  PolygonView mesh() const { return source.polygons.view(); }
  PolygonView refined() const { return refinement.polygons.view(); }
  bool is_split(std::size_t face) const { return io::is_split(mesh(), refinement, first_piece, face); }
  const Vec3d& added_position(std::size_t added) const {
    return refinement.polygons.positions[refinement.source_vertices() + added];
  }
};
using SharedRefined = std::shared_ptr<const RefinedContent>;

/// What something is at the vertices that an added one lies between.
template <class At>
auto at_origin(const VertexOrigin& origin, At&& at) {
  using Value = decltype(at(std::uint32_t{0}));
  return std::array<Value, 3>{at(origin.vertex[0]), at(origin.vertex[1]), at(origin.vertex[2])};
}

}  // namespace vdb_offset::io
