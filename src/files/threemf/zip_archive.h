// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <ctime>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "bytes/chunked_output.h"
#include "threemf/zip_packing.h"

struct zip;  // libzip's

namespace vdb_offset::io {

/// What an archive's directory says of an entry.
struct ZipEntry {
  std::string name;
  std::uint64_t index = 0;             ///< In the directory.
  std::uint64_t size = 0, packed = 0;  ///< Bytes, as they are and as the archive holds them.
  std::uint16_t method = 0;
  std::time_t time = 0;
};

/// A ZIP archive in memory.
class ZipArchive {
 public:
  /// Keeps references to both. \throw InvalidInput if it is no archive
  ZipArchive(const std::string& path, std::string_view bytes);

  /// The entry of a name, in any case (as ECMA-376 compares names of parts), or null. \throw InvalidInput if there are
  /// two.
  const ZipEntry* find(std::string_view name) const;
  const std::vector<ZipEntry>& entries() const { return entries_; }

  /// The entry's bytes. \throw InvalidInput if they are not what the directory promises, OutOfBudget
  std::string read(const ZipEntry& entry) const;
  /// Its first bytes, `most` at most, whatever follows.
  std::string read_beginning(const ZipEntry& entry, std::size_t most) const;

  struct Replacement {
    const ZipEntry* entry;
    Packed contents;
  };
  /// The archive with other contents in some entries; all others are copied as they are packed. \throw InvalidInput,
  /// OutOfBudget
  Pieces with(std::vector<Replacement>&& replacements) const;

 private:
  std::string label(const ZipEntry& entry) const;
  /// Unpacks the entry to its end, or to `most` bytes.
  std::string unpack(const ZipEntry& entry, std::uint64_t most) const;

  const std::string& path_;
  std::string_view bytes_;
  std::unique_ptr<zip, void (*)(zip*)> archive_;
  mutable std::mutex one_reader_;                              // libzip keeps a place in the archive
  std::vector<ZipEntry> entries_;                              // in the directory's order
  std::unordered_multimap<std::string, std::size_t> by_name_;  // in lower case
};

}  // namespace vdb_offset::io
