// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "document/encode.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// A format of meshes: what its files are called, what reads and writes them, and what they have a place for.
struct FormatRow {
  std::array<std::string_view, 3> endings;  ///< The first is its name; empty: no more.
  Format format;
  /// Takes a file with `path`, `format` and `bytes` set, and fills in the rest. \throw InvalidInput for content that is
  /// no such mesh
  void (*parse)(MeshFile& file, const ReadOptions& how);
  Pieces (*encode)(Format format, const SharedContent& content);  ///< A new file; null where it is read only.
  // Of new files.
  bool is_text = false;          ///< Coordinates are decimal digits.
  bool is_single = false;        ///< Coordinates have single precision.
  bool is_of_triangles = false;  ///< Faces are triangles.
  bool holds_colours = false;    ///< Of vertices.
  bool holds_texture = false;    ///< Texture coordinates and normals.
  bool holds_corners = false;    ///< Corners of one vertex may have different ones.
};

/// The row of a format in the table of all (format_table.cpp).
const FormatRow& row_of(Format format);

}  // namespace vdb_offset::io
