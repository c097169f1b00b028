// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "vdb_offset/api.h"

namespace vdb_offset::io {

/// The bytes of a file, shared by its copies: a regular file is mapped, so that its text is in memory once at most and
/// can be dropped under pressure; a pipe is read to its end; `.gz` and `.zst` are decompressed.
class VDB_OFFSET_API FileBytes {
 public:
  FileBytes() = default;
  explicit FileBytes(std::string bytes);

  /// "-" is standard input. \throw ReadError if the file cannot be opened or read, InvalidInput if what is compressed
  /// is damaged or larger than memory.
  static FileBytes open(const std::string& path);

  std::string_view view() const { return view_; }
  /// Shows other bytes in the place of the file's, which is still the one that must stay unchanged.
  void show(std::string bytes);

  /// \throw ReadError if the file has been written to since it was mapped, so that what was read of it may be
  /// neither the old nor the new. (A mapped file that is cut short ends in the signal SIGBUS when read.)
  void require_unchanged(const std::string& path) const;

 private:
  struct Mapping;

  std::shared_ptr<const std::string> owned_;
  std::shared_ptr<const Mapping> mapping_;
  std::string_view view_;
};

}  // namespace vdb_offset::io
