// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

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

/// Where the three numbers of a point or a normal stand in a file's bytes. Of two numbers the third stands where the
/// second does.
struct NumberTriple {
  std::uint64_t at[3];
};

/// Where the numbers of many points or normals stand, in ascending order: one by one in a text, at equal distances in a
/// binary file.
class ByteOffsets {
 public:
  ByteOffsets() = default;
  /// Record r starts at first + r * stride and holds `per_record` triples, `step` bytes apart; `offset` is where the
  /// three numbers of a triple lie from its start.
  ByteOffsets(std::size_t count, std::uint64_t first, std::uint64_t stride, std::array<std::uint64_t, 3> offset,
              std::size_t per_record = 1, std::uint64_t step = 0)
      : count_(count), first_(first), stride_(stride), offset_(offset), per_record_(per_record), step_(step) {}
  explicit ByteOffsets(std::vector<NumberTriple> triples) : count_(triples.size()), triples_(std::move(triples)) {}

  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }

  NumberTriple operator[](std::size_t i) const {
    if (!triples_.empty()) return triples_[i];
    const std::uint64_t at = first_ + i / per_record_ * stride_ + i % per_record_ * step_;
    return {{at + offset_[0], at + offset_[1], at + offset_[2]}};
  }
  /// The first triple of which a number stands at `byte` or behind it.
  std::size_t first_from(std::uint64_t byte) const {
    std::size_t lower = 0;
    for (std::size_t upper = count_; lower < upper;) {
      const std::size_t middle = lower + (upper - lower) / 2;
      const NumberTriple triple = (*this)[middle];
      if (std::max({triple.at[0], triple.at[1], triple.at[2]}) >= byte) upper = middle;
      else lower = middle + 1;
    }
    return lower;
  }

 private:
  std::size_t count_ = 0;
  std::uint64_t first_ = 0, stride_ = 0;
  std::array<std::uint64_t, 3> offset_{};
  std::size_t per_record_ = 1;
  std::uint64_t step_ = 0;
  std::vector<NumberTriple> triples_;
};

}  // namespace vdb_offset::io
