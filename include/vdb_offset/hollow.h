#pragma once

#include "vdb_offset/polygons.h"
#include "vdb_offset/shell.h"

namespace vdb_offset {

/// A solid with a cavity: the faces of an outer surface in their order, then those of an inner one, turned round.
struct Hollow {
  enum class Source { Neither, Outer, Inner };  ///< Which of the two is the mesh that the other was made of.

  Polygons polygons;  ///< Vertices and faces of the outer surface, then of the inner one.
  std::size_t outer_vertices = 0, outer_faces = 0;
  Source source = Source::Neither;
  ShellFacts facts;  ///< Without a rim. Pairs that meet are the source's own if both are of it.
};

/// Puts two surfaces together, one of which lies within the other; their faces point outward. The facts are those of
/// positions as they are. \throw InvalidInput for meshes that cannot be used, or too many vertices.
Hollow make_hollow(PolygonView outer, PolygonView inner, Hollow::Source source);

}  // namespace vdb_offset
