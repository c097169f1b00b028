#pragma once

#include <memory>

#include "vdb_offset/base/rounding.h"
#include "vdb_offset/io/attributes.h"
#include "vdb_offset/io/base/chunked_output.h"

namespace vdb_offset::io {

/// Faces that follow each other and belong together.
struct Part {
  std::string name;
  std::size_t faces;
};

/// What a file is made of.
struct Content {
  PolygonView mesh;
  Rounding precision;  ///< Of coordinates in a text.
  Attributes with;
  std::vector<Part> parts;  ///< One behind the other: all faces, or no part at all.
  Materials materials;      ///< Kept in OBJ.
};
using SharedContent = std::shared_ptr<const Content>;

/// The content as a file of that format. PLY: binary, coordinates are doubles. STL: binary, triangles and nothing else.
/// OBJ: all attributes, parts are groups; the others: \pre normals are those of vertices, for OFF texture coordinates
/// are, too. PLY: the faces of parts have a property `part`, 0 for the first. The pieces refer to the mesh.
Pieces encode(Format format, const SharedContent& content);

/// A colour from 0 to 1, as the formats that store bytes have it.
std::uint8_t colour_byte(double colour);

}  // namespace vdb_offset::io
