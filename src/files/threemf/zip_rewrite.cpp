// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "threemf/zip_archive.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

/// Headers of an archive that are given other numbers.
class EditedBytes {
 public:
  /// `bytes` begin at `first` in the file `path`.
  EditedBytes(const std::string& path, std::string_view bytes, std::uint64_t first)
      : path_(path), bytes_(bytes), first_(first) {}

  void set(const ZipField& field, std::uint64_t value) {
    if (field.bytes == 4 && value >= 0xffffffff)  // which would say that ZIP64 has the number
      throw InvalidInput(
          fmt::format("{}: expected to need less than 4 GiB as it is written, got byte {}", path_, value));
    std::memcpy(bytes_.data() + (field.at - first_), &value, field.bytes);
  }
  void set_checksum(std::uint64_t at, std::uint32_t crc) {
    std::memcpy(bytes_.data() + (at - first_), &crc, sizeof crc);
  }
  /// The sizes and the checksum of an entry are known before its bytes now.
  void clear_flag(std::uint64_t at) { bytes_[at - first_] = static_cast<char>(bytes_[at - first_] & ~8); }

  std::string take() { return std::move(bytes_); }

 private:
  const std::string& path_;
  std::string bytes_;
  std::uint64_t first_;
};

std::string local_header(const std::string& path, std::string_view archive, const ZipEntry& entry,
                         const Packed& contents) {
  EditedBytes header(path, archive.substr(entry.header_at, entry.data_at - entry.header_at), entry.header_at);
  header.clear_flag(entry.header_at + 6);
  header.set_checksum(entry.header_at + 14, contents.crc);
  header.set(entry.local_packed_field, contents.packed);
  header.set(entry.local_size_field, contents.size);
  return header.take();
}

}  // namespace

Pieces ZipArchive::with(std::vector<Replacement> replacements) const {
  std::sort(replacements.begin(), replacements.end(),
            [](const Replacement& a, const Replacement& b) { return a.entry->header_at < b.entry->header_at; });
  // A piece is either made already, or bytes of the archive as it is.
  struct Piece {
    std::string made;
    std::string_view kept;
  };
  const auto pieces = std::make_shared<std::vector<Piece>>();
  std::uint64_t copied = 0;
  for (Replacement& replacement : replacements) {
    const ZipEntry& entry = *replacement.entry;
    pieces->push_back({{}, bytes_.substr(copied, entry.header_at - copied)});
    pieces->push_back({local_header(path_, bytes_, entry, replacement.contents), {}});
    for (std::string& piece : replacement.contents.pieces) pieces->push_back({std::move(piece), {}});
    copied = entry.end_at;
  }
  pieces->push_back({{}, bytes_.substr(copied, directory_at_ - copied)});

  const auto moved = [&](std::uint64_t at) {
    std::uint64_t to = at;
    for (const auto& [entry, contents] : replacements)
      if (entry->end_at <= at) to += entry->data_at + contents.packed - entry->end_at;
    return to;
  };
  EditedBytes end(path_, bytes_.substr(directory_at_), directory_at_);
  for (const ZipEntry& entry : entries_) end.set(entry.offset_field, moved(entry.header_at));
  for (const auto& [entry, contents] : replacements) {
    end.clear_flag(entry->directory_at + 8);
    end.set_checksum(entry->directory_at + 16, contents.crc);
    end.set(entry->packed_field, contents.packed);
    end.set(entry->size_field, contents.size);
  }
  for (const ZipField& field : {directory_field_, narrow_directory_field_})
    if (field.at > 0) end.set(field, moved(directory_at_));
  if (wide_end_field_.at > 0) end.set(wide_end_field_, moved(wide_end_at_));
  pieces->push_back({end.take(), {}});
  return {pieces->size(), [pieces](std::size_t i) {
            const Piece& piece = (*pieces)[i];
            return piece.made.empty() ? std::string(piece.kept) : piece.made;
          }};
}

}  // namespace vdb_offset::io
