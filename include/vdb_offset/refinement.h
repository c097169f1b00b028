// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Where a vertex that was added lies in the source: on an edge of a face, or inside of a triangle that the face is
/// made of.
struct VertexOrigin {
  std::uint32_t face;                   ///< A face of the source that it lies on; on an edge, one of those there.
  std::array<std::uint32_t, 3> vertex;  ///< Corners of that face, vertices of the source; on an edge its ends first.
  std::array<double, 3> share;  ///< Barycentric: not below 0, their sum is 1 exactly; on an edge the last one is 0.
};

/// A mesh whose faces are split, on the same surface: no vertex of the source is moved, and no face leaves its plane,
/// but for what rounding does (see Tolerance::precision), and where vertices hang on its sides, by how far off these
/// are.
struct VDB_OFFSET_API Refinement {
  /// The source's vertices in their order, then the ones that were added. In the place of each face of the source there
  /// are its pieces, in a row and the same way round: triangles, or the face itself where it is not split. Where
  /// vertices of the source hang on the sides of a face (see WeldOptions::join_hanging), its pieces have vertices of
  /// their own that were added at the same positions.
  Polygons polygons;
  std::vector<std::uint32_t> parent;  ///< Of each face: the source's face that it is a piece of; ascending.
  std::vector<VertexOrigin> added;    ///< Of each vertex that was added, in order.

  std::size_t source_vertices() const { return polygons.positions.size() - added.size(); }
};

}  // namespace vdb_offset
