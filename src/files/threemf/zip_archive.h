// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "bytes/chunked_output.h"
#include "threemf/zip_packing.h"

namespace vdb_offset::io {

/// A number in an archive's headers: ZIP64 has wide ones.
struct ZipField {
  std::uint64_t at = 0;
  std::uint8_t bytes = 4;
};

/// What an archive's directory and the header before the entry's bytes say of it.
struct ZipEntry {
  std::string_view name;
  std::uint16_t flags = 0, method = 0;
  std::uint32_t crc = 0;
  std::uint64_t size = 0, packed = 0;  ///< Bytes, as they are and as the archive holds them.
  std::uint64_t header_at = 0, data_at = 0, end_at = 0, directory_at = 0;
  ZipField size_field, packed_field, offset_field;  ///< In the directory.
  ZipField local_size_field, local_packed_field;    ///< Before the bytes.
};

/// A ZIP archive in memory (PKWARE's APPNOTE 6.3, with ZIP64; neither encrypted nor in several files).
class ZipArchive {
 public:
  /// Keeps references to both. \throw InvalidInput if it is no such archive, or its entries overlap
  ZipArchive(const std::string& path, std::string_view bytes);

  /// The entry of a name, in any case (as ECMA-376 compares names of parts), or null. \throw InvalidInput if there are
  /// two.
  const ZipEntry* find(std::string_view name) const;
  const std::vector<ZipEntry>& entries() const { return entries_; }

  /// The entry's bytes. \throw InvalidInput if they are not what the headers promise, OutOfBudget
  std::string read(const ZipEntry& entry) const;
  /// Its first bytes, `most` at most, whatever follows.
  std::string read_beginning(const ZipEntry& entry, std::size_t most) const;

  struct Replacement {
    const ZipEntry* entry;
    Packed contents;
  };
  /// The archive with other contents in some entries; all other bytes stay, but for the numbers that say where entries
  /// lie. Keeps references to the archive's bytes alone. \throw InvalidInput if it grows beyond what its headers can
  /// hold
  Pieces with(std::vector<Replacement> replacements) const;

 private:
  void read_end();
  void read_directory(std::uint64_t begin, std::uint64_t size, std::uint64_t count);
  std::uint64_t read_entry(std::uint64_t at, std::uint64_t end);
  void read_wide_fields(std::initializer_list<ZipField*> fields, std::uint64_t extra, std::uint64_t extra_end) const;
  void read_local_header(ZipEntry& entry) const;
  std::uint64_t descriptor_end(const ZipEntry& entry) const;
  void require_apart() const;
  std::string label(const ZipEntry& entry) const;
  void require_readable(const ZipEntry& entry) const;

  std::uint64_t number(std::uint64_t at, int bytes) const;
  std::uint64_t number(const ZipField& field) const { return number(field.at, field.bytes); }
  bool holds(std::uint64_t at, std::uint64_t size) const { return at <= bytes_.size() && size <= bytes_.size() - at; }
  [[noreturn]] void fail(std::uint64_t at, std::string_view expected, std::string_view found) const;

  const std::string& path_;
  std::string_view bytes_;
  std::vector<ZipEntry> entries_;                              // in the directory's order
  std::unordered_multimap<std::string, std::size_t> by_name_;  // in lower case
  std::uint64_t directory_at_ = 0, wide_end_at_ = 0;
  // Where these stand; at 0 if they do not.
  ZipField directory_field_, narrow_directory_field_, wide_end_field_;
};

}  // namespace vdb_offset::io
