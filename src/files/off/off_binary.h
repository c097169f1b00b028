// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "vdb_offset/io/mesh_file.h"

/// Binary OFF files, as Geomview has them: the line "[ST][C][N]OFF BINARY", then numbers of four bytes, big-endian:
/// numbers of vertices, faces and edges; for each vertex its coordinates, normal, colour and texture coordinates; for
/// each face its number of corners, these, and a number of colour components, and these.
namespace vdb_offset::io::off {

/// Where the numbers of attributes are in a vertex's record; 0 for an attribute that vertices do not have.
struct Layout {
  std::size_t normal = 0, colour = 0, texture = 0;
  std::size_t width = 3;
};
Layout layout_of(const MeshFile& file);

/// The first byte behind the first line of a binary file; none for a text.
std::optional<std::size_t> binary_begin(const MeshFile& file);

/// The number, or the integer, that begins at a byte of the file.
double number_at(const MeshFile& file, std::uint64_t at);
std::int64_t integer_at(const MeshFile& file, std::uint64_t at);

/// The first byte of each face, and the byte behind the last face.
std::vector<std::uint64_t> face_offsets(const MeshFile& file);

}  // namespace vdb_offset::io::off
