// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::io {

/// Writes a shell of the source's mesh (shell.h), with its faces in their order, as write_mesh() does.
///
/// In the source's own format both skins have all that the source's vertices and faces have; numbers of vertices that
/// did not move stay as they are, and the inner skin's normals point the other way.
/// - OBJ: groups `outer` and `inner`, each in front of the source's own names, and `rim`; materials and objects are the
///   source's on every part, smoothing groups on the skins. Comments, lines and points and all that is not of faces
///   comes once; lines and points join the skin that is the source. The rim has the border's texture coordinates, and
///   no normals.
/// - PLY: a face property `part`, 0 (outer), 1 (inner) or 2 (rim); faces of the rim have the values of the face at
///   their border. Other elements come once and refer to the outer skin.
/// - STL: ASCII: a solid for each part; binary: the rim's facets have the attribute bytes of those at their border.
/// - OFF: the rim's faces have the colours of those at their border.
/// - 3MF: objects, their places and names, and all other parts of the package. A new triangle has the properties of the
///   corners that it comes from; triangles of an object without any have base materials `outer`, `inner` and `rim`. An
///   object of which the shell has no faces stays. Slicers' volumes hold what comes of their triangles.
/// - glTF: nodes, materials, textures and skins; each primitive has its part of the shell, and each vertex all that the
///   one has which it comes from, the rim's as well. A mesh of which the shell has no faces stays.
/// - VTK: arrays of points and cells; a cell array `part`, as in PLY. Points and lines come once, with the outer skin.
/// \pre the shell was made of the source's polygons. \throw as write_mesh(), and InvalidInput for a shell of another
/// mesh.
VDB_OFFSET_API WriteResult write_shell(const Target& target, const MeshFile& source, const Shell& shell);
inline WriteResult write_shell(const std::string& path, const MeshFile& source, const Shell& shell,
                               const WriteOptions& options = {}) {
  return write_shell(target_of(path, source, options, Faces::Shell), source, shell);
}

/// Writes a shell of plain polygons: positions, faces and, in OBJ and PLY, the parts. \throw as write_mesh()
VDB_OFFSET_API WriteResult write_shell(const Target& target, const Shell& shell);
inline WriteResult write_shell(const std::string& path, const Shell& shell, const WriteOptions& options = {}) {
  return write_shell(target_of(path, options), shell);
}

/// What a captured mesh is to take of its source.
struct TransportRequest {
  bool texture = true, colours = true, materials = true;
  bool is_required = false;  ///< What is asked for must be there, and the format must have a place for it.
};

/// What a source file has for a captured mesh, as asked for.
struct Transported {
  Attributes attributes;  ///< Without normals: those of the source are not the captured mesh's.
  Materials materials;
};

/// \throw InvalidOption for something required that the source does not have, or the format no place for.
VDB_OFFSET_API Transported read_transported(const MeshFile& source, const TransportRequest& request, Format target);

/// Writes a captured mesh: triangles, normals (OBJ, OFF, PLY), and what it takes of the source.
///
/// Colours of a vertex are those of the closest point of the source, interpolated on its face. Each triangle takes the
/// chart of its texture coordinates, and its material, from the source's face that is closest to its centre; its
/// corners take the texture coordinates of the points of this chart that are closest to them. So the source's seams
/// come along, between triangles and as fine as these; which is why OBJ and PLY may have several texture coordinates
/// for a vertex. In OBJ the faces come material by material.
/// `captured` was made of the source's polygons, for a target that comes from no file. \throw as write_mesh()
VDB_OFFSET_API WriteResult write_iso_surface(const Target& target, const MeshFile& source,
                                             const Transported& transported, const IsoResult& captured);

/// Writes an iso-surface of a mesh that comes from no file: triangles and normals. \throw as write_mesh()
VDB_OFFSET_API void write_iso_surface(const Target& target, const IsoResult& captured);

/// Writes a hollow solid: the skin that is its source with the source's faces in their order and all that the format
/// can hold of them, the other skin, which was captured, with colours and materials of what is closest. OBJ has groups
/// `outer` and `inner`, PLY a face property `part`, 0 or 1. Without a source that is one of the skins: plain polygons.
/// \throw as write_mesh()
VDB_OFFSET_API WriteResult write_hollow(const Target& target, const MeshFile* source, const Hollow& hollow,
                                        const IsoResult& captured);

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
///   ends. Lines (`l`) are not split. Faces over ridges come last, in a group `ridge`, without normals.
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
/// numbers. For each face over a ridge a line `face parent` follows, behind a comment. All are counted from 0.
/// `of_file` is RefinedFile::vertex: in an STL file a vertex that was added has a line for each corner of a facet that
/// stands there. `.gz` and `.zst` are compressed; "-" is standard output. \throw WriteError
VDB_OFFSET_API void write_vertex_map(const std::string& path, const Refinement& refinement,
                                     std::span<const std::uint32_t> of_file = {});

}  // namespace vdb_offset::io
