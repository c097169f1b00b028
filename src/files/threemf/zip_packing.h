// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bytes/chunked_output.h"

namespace vdb_offset::io {

// How a ZIP archive holds the bytes of an entry.
inline constexpr std::uint16_t kStored = 0, kDeflated = 8;

/// The contents of an entry as the archive holds them: all pieces in a row.
struct Packed {
  std::uint16_t method = kDeflated;
  std::uint32_t crc = 0;
  std::uint64_t size = 0, packed = 0;  ///< Bytes, before and after.
  std::vector<std::string> pieces;
};

/// Packs pieces in parallel, each on its own, so that the bytes do not depend on the number of threads.
/// \throw OutOfBudget
Packed pack(const std::string& where, const Pieces& contents, std::uint16_t method);

/// Unpacks deflated bytes that are to be `size`. Takes no memory for bytes that do not come.
/// \throw InvalidInput if they are others, OutOfBudget; `where` begins the message
std::string unpack(const std::string& where, std::string_view packed, std::uint64_t size);

/// The first bytes of what unpack() makes, `most` at most.
std::string unpack_beginning(const std::string& where, std::string_view packed, std::size_t most);

std::uint32_t crc_of(std::string_view bytes);

/// An entry of a new archive.
struct NewEntry {
  std::string name;
  Pieces contents;
};
/// A new archive, with the same bytes each time: all entries are of the first day that the format has.
Pieces new_archive(const std::string& where, const std::vector<NewEntry>& entries);

}  // namespace vdb_offset::io
