// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/refinement.h"

namespace vdb_offset::io {

/// A file as it would be if its mesh had the faces of a refinement.
struct VDB_OFFSET_API RefinedFile {
  MeshFile file;  ///< In the source's format and encoding, under the source's name.
  /// STL, whose facets have vertices of their own: of each vertex of the file that of the refinement. Else empty: the
  /// numbers are the same.
  std::vector<std::uint32_t> vertex;
  std::vector<std::string> lost;  ///< What of the source the file does not hold, in words.
};

/// Makes the file in memory and reads it, so that all that takes a file takes this one.
///
/// What need not change stays byte for byte; a refinement that splits nothing gives the source. The source's vertices
/// come first, and the pieces of a face are in its place, with all that it has. What vertices and corners of faces have
/// is interpolated for the ones that were added, with the shares of their origin:
/// - OBJ: numbers behind coordinates, texture coordinates and normals. New `v`, `vt` and `vn` lines follow the last one
///   of their kind, so that the numbers of the others stay; indices that count back are written anew where they would
///   mean others. Faces on both sides of an edge share new texture coordinates and normals if they share those at its
///   ends. Lines (`l`) are not split.
/// - PLY: floating-point properties of vertices, and colours of whole numbers; per-corner lists of texture coordinates
///   and colours. Other properties of added vertices are those of the vertex with the largest share. Strips of
///   triangles become faces.
/// - OFF: normals, colours and texture coordinates of vertices. Faces keep their colours.
/// - STL: facets keep their normals, attribute bytes and solids.
///
/// \pre positions of added vertices are numbers of the source's precision. \throw InvalidInput if they are not, or if
/// the refinement is none of the source's polygons; ReadError if the source's file was written to meanwhile.
VDB_OFFSET_API RefinedFile refine_file(const MeshFile& source, const Refinement& refinement);

/// Writes where the vertices that were added lie, as text: behind a comment, a line `vertex face v0 v1 v2 s0 s1 s2` for
/// each. `vertex` is its number in the refined file; `face` one of the source's faces that it lies on; v0 to v2 are
/// corners of that face, and s0 to s2 their shares (see VertexOrigin), with the digits that read back to the same
/// numbers. All are counted from 0. `of_file` is RefinedFile::vertex: in an STL file a vertex that was added has a line
/// for each corner of a facet that stands there. `.gz` and `.zst` are compressed; "-" is standard output.
/// \throw WriteError
VDB_OFFSET_API void write_vertex_map(const std::string& path, const Refinement& refinement,
                                     std::span<const std::uint32_t> of_file = {});

}  // namespace vdb_offset::io
