// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/io/file_bytes.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {

/// Assimp stands for all that is read by that library; Step,
/// Iges and Brep (of OpenCASCADE) are CAD models, and Vdb is OpenVDB's, a surface of whose grids is the mesh.
enum class Format { Obj, Off, Ply, Stl, ThreeMf, Gltf, Glb, Vtp, Vtk, Vtu, Assimp, Step, Iges, Brep, Vdb };

/// The format that a file name's ending stands for (.obj .off .ply .stl .3mf .gltf .glb .vtp .vtk .vtu, .fbx .dae .3ds,
/// .step .stp .iges .igs .brep, and .vdb, any case, also before .gz or .zst), if it does.
VDB_OFFSET_API std::optional<Format> format_of(std::string_view path);
VDB_OFFSET_API const char* name(Format format);
/// Whether meshes can be written in the format: not in those that Assimp reads, in CAD models, and in grids.
VDB_OFFSET_API bool is_written(Format format);
/// Whether a file of the format holds a CAD model.
VDB_OFFSET_API bool is_cad(Format format);

/// The length of the unit of a file's coordinates in micrometres, if the file states it. Reads no more than that takes.
/// \throw ReadError, InvalidInput as read_mesh()
VDB_OFFSET_API std::optional<double> unit_micrometres(const std::string& path, std::optional<Format> format = {});

/// What a format's own reader keeps of a file.
class Document;

/// How the numbers of an OFF, PLY or STL file are stored.
enum class Encoding { Ascii, LittleEndian, BigEndian };

/// A mesh as read, with all that is needed to write the same file again with other coordinates.
struct VDB_OFFSET_API MeshFile {
  std::string path;
  Format format = Format::Obj;
  Encoding encoding = Encoding::Ascii;
  FileBytes bytes;  ///< The whole file, decompressed.
  Polygons polygons;

  std::vector<std::string> extras;           ///< What the file holds besides positions and faces, in words.
  std::vector<std::string> remarks;          ///< What is wrong with the file and yet no reason to refuse it, in words.
  Precision precision;                       ///< What its coordinates can hold.
  std::shared_ptr<const Document> document;  ///< What its format's reader keeps of it.
  std::size_t normal_count = 0;              ///< Its normals: of vertices, corners or facets.
  std::optional<double> unit_micrometres;    ///< The length of the unit of its coordinates, if the file states it.
  std::vector<std::string> files_beside;     ///< Files that were read besides, as a .gltf names them.
  std::vector<std::string> files_named;      ///< Files that it names and that were not read, as images and materials.
  /// Of a CAD model: its surface, which the polygons are a tessellation of.
  std::shared_ptr<const ExactSurface> exact;
  double voxel_size = 0;  ///< Of the grid that the mesh is a surface of, along its first axis; 0 of other files.
  /// Vertices at equal positions are of objects that touch, and no two of one object are: not to be welded.
  bool has_touching_objects = false;

  std::string_view text() const { return bytes.view(); }
};
inline constexpr std::uint32_t kNoNormal = 0xffffffff;

/// Whether a file is a mesh alone, row by row (OBJ, OFF, PLY, STL): it can be given more vertices and faces as it is.
VDB_OFFSET_API bool has_rows(const MeshFile& file);

/// How a CAD model becomes a mesh.
struct CadReading {
  /// The most distance between triangles and the faces that they stand for, in the file's unit; if it is 0, as a share
  /// of the diagonal of the model's bounding box.
  double deflection = 0, deflection_share = 2e-4;
  double least_share = 0, most_share = 1;  ///< The deflection is between these shares of the diagonal.
  double angle_degrees = 15;               ///< The most angle between a face's normals at neighbouring vertices.
  bool fuses_bodies = false;               ///< Solids that touch or get into each other are read as one.
  double seconds = 300;       ///< How long OpenCASCADE may take for a file, all questions about it included.
  ProgressCallback progress;  ///< See run.h; all of it is Stage::Read. May cancel.
};

/// Which surface of an OpenVDB file becomes a mesh.
struct VdbReading {
  std::string grid;                ///< Its name; empty: the only level set, or the only grid of floats.
  std::optional<double> isovalue;  ///< 0 if there is none; needed where the grid is no level set.
};

struct ReadOptions {
  std::optional<Format> format;  ///< By the file's ending, if not given.
  CadReading cad;
  VdbReading vdb;
};

/// Reads a mesh, by the file's ending or as given; STL gives three vertices a facet. `.gz` and `.zst` behind that
/// ending are decompressed; "-" is standard input, and needs a format. A .gltf may name files beside it.
/// \throw ReadError if the file cannot be opened, InvalidInput (file, line or byte, what was expected, what was
/// found) for content that is no mesh. Never allocates more than a small multiple of the file's size.
VDB_OFFSET_API MeshFile read_mesh(const std::string& path, std::optional<Format> format = {});
VDB_OFFSET_API MeshFile read_mesh(const std::string& path, const ReadOptions& options);

/// Reads a mesh as read_mesh() does from bytes in memory; `name` is for messages.
VDB_OFFSET_API MeshFile parse_mesh(const std::string& name, Format format, std::string bytes);

/// What becomes of a file's normals where a face moved.
enum class Normals { Recompute, Keep };

struct WriteOptions {
  std::optional<Format> format;  ///< By the file's ending, if not given.
  Normals normals = Normals::Recompute;
  int digits = 0;  ///< Significant digits of coordinates in text, 1 .. 17; 0: as many as read back to the same number.
};

struct WriteResult {
  std::string lost;                     ///< What the target cannot hold, in words; empty if nothing.
  std::size_t disagreeing_normals = 0;  ///< OBJ normals shared by vertices with different ones now; they get the mean.
};

/// Whether a file that is written has the faces of its source, or others.
enum class Faces { Same, Shell, Pieces };

/// A mesh file that is to be written. It is decided once, by target_of(): writers keep to it, and what is offset for it
/// is judged on what it keeps of coordinates (OffsetOptions::precision).
struct Target {
  std::string path;
  Format format = Format::Obj;
  Normals normals = Normals::Recompute;
  Precision precision;

  /// A file like it, of another name.
  Target at(std::string other) const { return {std::move(other), format, normals, precision}; }
};

/// A file for the mesh of a source. \throw InvalidInput for an unknown ending, or a format that is only read
VDB_OFFSET_API Target target_of(const std::string& path, const MeshFile& source, const WriteOptions& options = {},
                                Faces faces = Faces::Same);
/// A file for a mesh that comes from no file, or is a new one as an iso-surface is. \throw as above
VDB_OFFSET_API Target target_of(const std::string& path, const WriteOptions& options = {});

/// Writes the mesh with other positions, through a temporary file that is renamed at the end; the path "-" is standard
/// output. In the source's own format every byte stays but for the coordinates of vertices that moved and the normals
/// of faces that moved, which are computed anew from the coordinates as written; binary numbers keep their width. In
/// another format the file holds positions and faces (STL: triangles) and, as far as the format can, vertex colours,
/// texture coordinates and normals. A .gltf may have files beside it, which are written with it.
/// \pre one position a vertex. \throw WriteError, ReadError if the source's file was written to meanwhile.
VDB_OFFSET_API WriteResult write_mesh(const Target& target, const MeshFile& source, std::span<const Vec3d> positions);
inline WriteResult write_mesh(const std::string& path, const MeshFile& source, std::span<const Vec3d> positions,
                              const WriteOptions& options = {}) {
  return write_mesh(target_of(path, source, options), source, positions);
}

/// The bytes that write_mesh() writes in the source's own format.
VDB_OFFSET_API std::string patched_bytes(const MeshFile& source, std::span<const Vec3d> positions);

/// Writes plain polygons, for meshes that come from no file. PLY: binary, doubles. STL: binary, triangles.
VDB_OFFSET_API void write_mesh(const Target& target, PolygonView polygons);
inline void write_mesh(const std::string& path, PolygonView polygons, const WriteOptions& options = {}) {
  write_mesh(target_of(path, options), polygons);
}

/// Writes polygons with other positions. In formats of triangles they are split as at their own positions.
/// \pre one position a vertex
VDB_OFFSET_API void write_mesh(const Target& target, PolygonView source, std::span<const Vec3d> positions);
inline void write_mesh(const std::string& path, PolygonView source, std::span<const Vec3d> positions,
                       const WriteOptions& options = {}) {
  write_mesh(target_of(path, options), source, positions);
}

/// A mesh in a file of its triangles alone.
struct InTriangles {
  std::vector<Vec3d> positions;                         ///< Of the mesh's vertices; those of no face have their own.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< As PolygonView::triangles: how the file splits the faces.
};
/// Finds where a mesh's vertices stand in a file of its triangles alone, face by face, as STL is written of it, with
/// three vertices for each, and glTF, where a vertex may be several. None if these are not its triangles, or if the
/// corners of a vertex are apart.
VDB_OFFSET_API std::optional<InTriangles> find_in_triangles(PolygonView mesh, PolygonView triangles);

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
    Planar,    ///< The flat end of a mesh along an axis: `name` is +x, -x, +y, -y, +z or -z. Faces that look along it,
               ///< within a degree, and of these those that lie farthest that way, within 0.01 % of the diagonal.
  };
  By by;
  std::string name;         ///< Empty of those by shape.
  bool is_negated = false;  ///< All faces but those.
  /// Of holes: those alone whose diameter, world units, is less or more. A cone's is the least, or if it ends in a tip
  /// the largest.
  std::optional<double> narrower_than = {}, wider_than = {};
};

/// \throw InvalidOption unless the text is `group=NAME`, `material=NAME`, `faces=FILE`, `face=N`, `name=NAME`,
/// `color=RRGGBB`, `holes`, `holes<D`, `holes>D`, `concave`, `convex`, `up`, `down` or `planar:+z` (or another axis),
/// or one of these behind `not:`.
VDB_OFFSET_API Selector parse_selector(const std::string& text);
/// The word before the equals sign, or of those by shape the word.
VDB_OFFSET_API const char* in_words(Selector::By by);

/// One number a face: 1 if any of the selectors names it that are not negated, or if all are, and none of those that
/// are names it. \throw InvalidOption for a name that no face has, which lists those that there are; for a shape that
/// none has; and if no face is left. ReadError, InvalidInput for a file that cannot be read, or holds no faces of this
/// mesh.
VDB_OFFSET_API std::vector<std::uint8_t> select_faces(const MeshFile& mesh, std::span<const Selector> selectors);

/// Reads a number for each of `count` vertices, in their order: from text (numbers between blanks and line ends, '#'
/// starts a comment) or from an array that NumPy saved (.npy, versions 1 to 3: floating or whole numbers of 1 to 8
/// bytes, either byte order, of shape (n,) or (n, 1)), as its first bytes show. `.gz` and `.zst` are decompressed;
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
