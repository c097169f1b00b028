// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset::io {

/// What of a mesh is shown: its triangles, or the segments of its curves, or fewer of them.
struct ViewMesh {
  std::size_t size_of_element = 3;      ///< Corners of each element: 3 of triangles, 2 of segments.
  std::vector<std::uint32_t> vertices;  ///< The mesh's numbers of those that are shown, ascending.
  std::vector<std::uint32_t> corners;   ///< Of all elements, into `vertices`.
  std::vector<std::uint32_t> face;      ///< Of each element: the mesh's face that it is a part of.
  std::vector<std::uint8_t> edges;      ///< Of each element: bit k is set if its side from corner k on is the face's.
  std::size_t elements_of_mesh = 0;

  std::size_t element_count() const { return face.size(); }
  bool is_decimated() const { return element_count() < elements_of_mesh; }
};

/// Takes a mesh's triangles, or if they are more than `most`, clusters vertices (Rossignac & Borrel 1993): of those in
/// a cell of a grid whose normals have one main direction, that with the largest `weight` stands for all, of several
/// the first. Does not depend on the number of threads. Cost: O(vertices log(vertices)). \param weight of each vertex,
/// 0 or more
ViewMesh view_of(PolygonView mesh, bool are_curves, std::span<const float> weight, std::size_t most);

}  // namespace vdb_offset::io
