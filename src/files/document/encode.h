// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>

#include "bytes/chunked_output.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// A part of a mesh: faces that follow each other.
struct Part {
  std::string name;
  std::size_t faces;
};

/// The content of a file that is to be written.
struct Content {
  PolygonView mesh;
  Rounding precision;  ///< Precision of coordinates in a text.
  Attributes with;
  std::vector<Part> parts;                      ///< Of all faces, in their order; or empty.
  Materials materials;                          ///< Kept in OBJ, glTF and 3MF.
  std::optional<double> unit_micrometres = {};  ///< Of the coordinates, if known; kept in 3MF.
  /// What `mesh.triangles` refers to, if these were made for this file.
  std::vector<std::array<std::uint32_t, 3>> triangles = {};
};
using SharedContent = std::shared_ptr<const Content>;

/// Encodes the content in a format. PLY: binary, coordinates are doubles. STL: binary, triangles and nothing else.
/// OBJ: all attributes, parts are groups. \pre in other formats than OBJ normals are those of vertices, and in OFF
/// and those of VTK texture coordinates as well. PLY: the faces of parts have a property `part`, 0 for the first. The
/// pieces refer to the mesh.
Pieces encode(Format format, const SharedContent& content);

bool is_gltf(Format format);
/// Whether a new file of the format has coordinates in decimal digits.
bool is_text(Format format);
/// Whether a new file of the format has coordinates in single precision.
bool is_single(Format format);
/// Whether a new file of the format has triangles alone.
bool is_of_triangles(Format format);
// Whether the format has a place for what vertices, or their corners, have.
bool holds_colours(Format format);
bool holds_texture(Format format);
bool holds_normals(Format format);
/// Whether corners of one vertex may have different normals and texture coordinates.
bool holds_corners(Format format);

/// A colour from 0 to 1 as a byte, for formats that store bytes.
std::uint8_t colour_byte(double colour);

/// Whether all colours are bytes, as far as three decimal digits resolve.
bool are_bytes(const std::vector<std::array<double, 4>>& colours);

/// Whether a float is enough for a number: both have the same shortest decimal form.
bool fits_float(double value);

}  // namespace vdb_offset::io
