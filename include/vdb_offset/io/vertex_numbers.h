// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

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

/// The numbers that a PLY file holds for its vertices under that name.
/// \throw InvalidInput if the file is no PLY, has no such property of single numbers, or holds one that is not finite.
VDB_OFFSET_API std::vector<double> vertex_property(const MeshFile& source, const std::string& name);

}  // namespace vdb_offset::io
