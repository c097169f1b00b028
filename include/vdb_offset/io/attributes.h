// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/volume_mesh.h"

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
  CornerValues<Vec3d> normals;    ///< In the order of the file's normals; may hold NaNs. Facets' normals are none.
  std::vector<std::string> lost;  ///< All that the file holds besides, in words; malformed attributes among it.
};

/// Reads the attributes in a pass of their own, so that reading a mesh does not have to.
VDB_OFFSET_API Attributes read_attributes(const MeshFile& source);

/// What faces are made of, by the name of their material.
struct Materials {
  std::vector<std::string> names;      ///< "" for faces that have none.
  std::vector<std::uint32_t> of_face;  ///< Index into `names`. Empty: no face has a material.
  std::vector<std::string> libraries;  ///< What the file says of where they are described.
  /// Of each its colour: red, green and blue, 0 .. 1, sRGB. Empty: none is known.
  std::vector<std::optional<std::array<double, 3>>> colours = {};
};

/// The materials of an OBJ file, or of one that holds more than a mesh; other files have none.
VDB_OFFSET_API Materials read_materials(const MeshFile& source);

/// Texture coordinates, one for each vertex: those of the first corner at the vertex that has any, NaNs if none has.
/// Zero for a vertex that no face uses. \throw InvalidInput if the file holds no texture coordinates at all.
VDB_OFFSET_API std::vector<Vec2d> vertex_texture(const MeshFile& source);

/// What a file calls its faces. OBJ, and files that hold more than a mesh: by groups, a line's names joined by _; by
/// materials if no face is in a group, and by objects if none has a material either. ASCII STL: by solids. Names are in
/// the order of their first faces; faces without one are "wall". None if the file names nothing.
VDB_OFFSET_API WallNames wall_names(const MeshFile& mesh);

/// Names some faces of a mesh.
struct Selector {
  enum class By {
    Group,     ///< OBJ: a name of a `g` or `o` line; ASCII STL: the name of a solid.
    Material,  ///< OBJ: a name of a `usemtl` line.
    File,      ///< A text file: a 0 or 1 for each face, or else the indices of faces, counted from 0.
    Face,      ///< Of a CAD model: the number of a face, from 1.
    Name,      ///< Of a CAD model: the name of a face, its layer, or the solid or part that it is of.
    Colour,    ///< Of a CAD model: the colour of faces, as six hexadecimal digits, red first.
    Holes,     ///< Round holes: closed cylinders and cones that are curved inward, of eight flat faces around and more.
    Concave,   ///< Faces of surfaces that are curved inward.
    Convex,    ///< Faces of surfaces that are curved outward.
    Up,        ///< Faces that look up the z axis, within less than 45 degrees.
    Down,      ///< Faces that look down, likewise.
  };
  By by;
  std::string name;         ///< Empty of those by shape.
  bool is_negated = false;  ///< All faces but those.
  /// Of holes: those alone whose diameter, world units, is less or more. A cone's is the least, or if it ends in a tip
  /// the largest.
  std::optional<double> narrower_than = {}, wider_than = {};
};

/// \throw InvalidOption unless the text is `group=NAME`, `material=NAME`, `faces=FILE`, `face=N`, `name=NAME`,
/// `color=RRGGBB`, `holes`, `holes<D`, `holes>D`, `concave`, `convex`, `up` or `down`, or one of these behind `not:`.
VDB_OFFSET_API Selector parse_selector(const std::string& text);
/// The word before the equals sign, or of those by shape the word.
VDB_OFFSET_API const char* in_words(Selector::By by);

/// One number a face: 1 if any of the selectors names it that are not negated, or if all are, and none of those that
/// are names it. \throw InvalidOption for a name that no face has, which tells those that there are; for a shape that
/// none has; and if no face is left. ReadError, InvalidInput for a file that cannot be read, or holds no faces of this
/// mesh.
VDB_OFFSET_API std::vector<std::uint8_t> select_faces(const MeshFile& mesh, std::span<const Selector> selectors);

/// Reads a number for each of `count` vertices, in their order: from text (numbers between blanks and line ends, '#'
/// starts a comment) or from an array that NumPy saved (.npy, versions 1 to 3: floating or whole numbers of 1 to 8
/// bytes, either byte order, of shape (n,) or (n, 1)), which its first bytes tell. `.gz` and `.zst` are decompressed;
/// "-" is standard input. \throw ReadError if the file cannot be opened, InvalidInput (file, line or byte, what was
/// expected, what was found) for content that is neither, another count, or a number that is not finite (the vertex,
/// counted from 0). Never allocates more than a small multiple of `count`, or of the file's size if that is less.
VDB_OFFSET_API std::vector<double> read_vertex_numbers(const std::string& path, std::size_t count);

/// Reads numbers as read_vertex_numbers() does from bytes in memory; `name` is for messages.
VDB_OFFSET_API std::vector<double> parse_vertex_numbers(const std::string& name, std::string_view bytes,
                                                        std::size_t count);

/// The numbers that a PLY file, or one of VTK's, holds for its vertices under that name.
/// \throw InvalidInput if it is another file, has no such property of single numbers, or holds one that is not finite.
VDB_OFFSET_API std::vector<double> vertex_property(const MeshFile& source, const std::string& name);

}  // namespace vdb_offset::io
