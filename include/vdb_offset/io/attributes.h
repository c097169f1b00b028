// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// Values at the corners of faces, several of which may share one.
template <class Value>
struct VDB_OFFSET_API CornerValues {
  std::vector<Value> value;              ///< Empty: there are none.
  std::vector<std::uint32_t> of_corner;  ///< Which of them each corner has, or kNoNormal; empty: each vertex its own.
  bool single = false;                   ///< Stored in single precision.

  bool empty() const { return value.empty(); }
  std::uint32_t index(std::size_t corner, std::uint32_t vertex) const {
    return of_corner.empty() ? vertex : of_corner[corner];
  }
};

/// What a mesh file holds besides positions and faces that other formats have a place for, too.
struct Attributes {
  std::vector<std::array<double, 4>> colours;  ///< Of vertices: red, green, blue and alpha, 0 .. 1. May be empty.
  bool has_alpha = false;
  CornerValues<Vec2d> texture;
  CornerValues<Vec3d> normals;    ///< In the order of MeshFile::normal_at; may hold NaNs. Facets' normals are none.
  std::vector<std::string> lost;  ///< All that the file holds besides, in words; malformed attributes among it.
};

/// Reads the attributes in a pass of their own, so that reading a mesh does not have to.
VDB_OFFSET_API Attributes read_attributes(const MeshFile& source);

/// What faces are made of, by the name of their material.
struct Materials {
  std::vector<std::string> names;      ///< "" for faces that have none.
  std::vector<std::uint32_t> of_face;  ///< Index into `names`. Empty: no face has a material.
  std::vector<std::string> libraries;  ///< What the file says of where they are described.
};

/// The materials of an OBJ file; other files have none.
VDB_OFFSET_API Materials read_materials(const MeshFile& source);

/// Texture coordinates, one for each vertex: those of the first corner at the vertex that has any, NaNs if none has.
/// Zero for a vertex that no face uses. \throw InvalidInput if the file holds no texture coordinates at all.
VDB_OFFSET_API std::vector<Vec2d> vertex_texture(const MeshFile& source);

}  // namespace vdb_offset::io
