// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "vdb_offset/io/file_bytes.h"
namespace vdb_offset::io {

/// A file to be, in pieces that can be made in any order and from several threads at once.
struct Pieces {
  std::size_t count;
  std::function<std::string(std::size_t)> make;
};

/// Lines or records of one kind; append(bytes, i) adds number i.
struct Section {
  std::size_t items;
  std::function<void(std::string&, std::size_t)> append;
};

/// A header, then all items of the sections.
Pieces in_sections(const std::string& header, std::vector<Section> sections);

/// One file made of several, one after the other.
Pieces in_a_row(std::vector<Pieces> files);

/// Writes the pieces in order to `path` through replace_file() (output_files.h), a few of them in memory at
/// a time; compressed, piece by piece, if the path ends in .gz or .zst. \throw WriteError
void write_pieces(const std::string& path, const Pieces& pieces);

/// Writes pieces that were made of the bytes of a file, `source`, as write_pieces() does: if these bytes have changed
/// since, nothing is put in place.
/// \throw ReadError
void write_pieces_of(const std::string& source, const FileBytes& bytes, const std::string& path, const Pieces& pieces);

/// All pieces as one text in memory.
std::string join(const Pieces& pieces);

}  // namespace vdb_offset::io
