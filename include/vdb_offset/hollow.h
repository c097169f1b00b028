// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/shell.h"

namespace vdb_offset {

/// A solid with a cavity: the faces of an outer surface in their order, then those of an inner surface, turned round.
struct Hollow {
  enum class Source { Neither, Outer, Inner };  ///< The surface that is the mesh which the other was made from.

  Polygons polygons;  ///< Vertices and faces of the outer surface, then of the inner one.
  std::size_t outer_vertices = 0, outer_faces = 0;
  Source source = Source::Neither;
  ShellFacts facts;  ///< There is no rim. A crossing counts as the source's if both triangles are from it.
};

/// Puts two surfaces together, one of which lies within the other, both with faces that point outward. The facts are
/// those of unrounded positions. \throw InvalidInput for meshes that cannot be used, or too many vertices.
VDB_OFFSET_API Hollow make_hollow(PolygonView outer, PolygonView inner, Hollow::Source source);

}  // namespace vdb_offset
