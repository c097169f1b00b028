#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace vdb_offset::io {

/// A file to be, in pieces that can be made in any order and from several threads at once.
struct Pieces {
  std::size_t count;
  std::function<std::string(std::size_t)> make;
};

/// Writes the pieces one behind the other to `path` (file_replace.h), a few of them in memory at a time; compressed,
/// piece by piece, if the path ends in .gz or .zst. \throw WriteError
void write_pieces(const std::string& path, const Pieces& pieces, const std::function<void()>& before_rename);

/// All of them in memory.
std::string join(const Pieces& pieces);

}  // namespace vdb_offset::io
