// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bytes/scanner.h"
#include "document/rows.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// Removes an extra from the list of what would be lost. Returns whether it was listed.
bool is_kept(Attributes& attributes, const std::string& extra);
bool has_extra(const MeshFile& source, std::string_view extra);
bool all_finite(const std::vector<Vec2d>& points);
bool any_named(const std::vector<std::uint32_t>& of_corner);

/// A scanner of a text from one of its bytes on, by the syntax of its rows.
Scanner scanner_at(const MeshFile& source, std::uint64_t byte);

/// The normals of rows, which are those of vertices or corners.
void read_normals_of_rows(const MeshFile& source, Attributes& attributes);

/// Numbers that stand with vertices, `width` for each.
struct Columns {
  std::size_t width = 0;
  std::vector<double> number;
};

/// Takes the first `width` columns, three or four, as colours, with `white` as the largest value. Returns false, and
/// takes nothing, if a value is out of range or there are no such columns.
bool take_colours(const Columns& columns, std::size_t width, double white, Attributes& attributes);
/// Takes two columns, from `first` on, as texture coordinates of vertices.
bool take_texture(const Columns& columns, std::size_t first, Attributes& attributes);

/// The words behind the last of some numbers of a text, as numbers; NaN for a word that is no number. None if there are
/// different numbers of words, or more than are known to mean anything.
std::optional<Columns> read_tails(const MeshFile& source, const ByteOffsets& last);

}  // namespace vdb_offset::io
