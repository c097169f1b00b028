// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// The format that was given, or else that of the file's ending. \throw InvalidInput for an ending that is unknown.
Format require_format(const std::string& path, const std::optional<Format>& given);
/// As require_format(), for a file that is to be written. \throw InvalidInput for a format that is read only as well.
Format require_written_format(const std::string& path, const std::optional<Format>& given);

/// Vertex indices are 32 bits wide; the largest value means "none".
inline constexpr std::uint64_t kMostVertices = 0xfffffffe;

}  // namespace vdb_offset::io
