// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bytes/chunked_output.h"

namespace vdb_offset::io {

/// The contents of an entry as the archive holds them.
struct Packed {
  std::uint16_t method = 0;  ///< As the format numbers them.
  std::uint32_t crc = 0;
  std::uint64_t size = 0;  ///< Bytes before.
  std::string bytes;
};

/// Packs pieces in parallel, each on its own, so that the bytes do not depend on the number of threads.
/// \throw OutOfBudget
Packed pack(const std::string& where, const Pieces& contents, std::uint16_t method);

/// An entry of a new archive.
struct NewEntry {
  std::string name;
  Pieces contents;
};
/// A new archive, with the same bytes each time: all entries are of the first day that the format has.
Pieces new_archive(const std::string& where, const std::vector<NewEntry>& entries);

}  // namespace vdb_offset::io
