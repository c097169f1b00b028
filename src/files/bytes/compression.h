// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace vdb_offset::io {

enum class Compression { None, Gzip, Zstd };

/// The compression that a file's ending stands for: .gz, .zst.
Compression compression_of(std::string_view path);

/// The path without .gz or .zst.
std::string_view without_compression(std::string_view path);

/// Decompresses all members (gzip) or frames (zstd) of `bytes`. \throw InvalidInput (`path`, byte, what was expected)
/// if they are damaged, end early, or would not fit into memory, OutOfBudget if they would pass its limit.
std::string decompress(Compression compression, const std::string& path, std::string_view bytes);

/// Compresses bytes to one member or frame. A file may consist of several.
std::string compress(Compression compression, const std::string& bytes);

/// Compresses bytes in zlib's own format, as blocks of VTK's files are.
std::string compress_block(const std::string& bytes);

}  // namespace vdb_offset::io
