// SPDX-License-Identifier: Apache-2.0
// The headers of archives: APPNOTE 6.3, sections 4.3 and 4.5.
#include "threemf/zip_archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <iterator>

#include "bytes/scanner.h"
#include "ground/system/memory.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

constexpr std::string_view kLocalMark("PK\3\4"), kDirectoryMark("PK\1\2"), kEndMark("PK\5\6"), kWideEndMark("PK\6\6"),
    kWideLocatorMark("PK\6\7"), kDescriptorMark("PK\7\10");
constexpr std::uint64_t kLocalHeader = 30, kDirectoryHeader = 46, kArchiveEnd = 22, kWideEnd = 56,
                        kWideLocator = 20;                     // bytes
constexpr std::uint64_t kToldElsewhere = 0xffffffff;           // in 32 bits: the number is one of ZIP64
constexpr std::uint16_t kEncrypted = 1, kDescribedBehind = 8;  // flags
// Deflate makes at most so many bytes of one (zlib, "Technical Details").
constexpr std::uint64_t kMostRatio = 1032;

std::string in_lower_case(std::string_view name) {
  std::string lower(name);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

}  // namespace

ZipArchive::ZipArchive(const std::string& path, std::string_view bytes) : path_(path), bytes_(bytes) {
  read_end();
  require_apart();
}

void ZipArchive::fail(std::uint64_t at, std::string_view expected, std::string_view found) const {
  throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", path_, at, expected, found));
}

std::uint64_t ZipArchive::number(std::uint64_t at, int bytes) const {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes_.data() + at, static_cast<std::size_t>(bytes));
  return value;
}

void ZipArchive::read_end() {
  if (bytes_.size() < kArchiveEnd) fail(bytes_.size(), "a ZIP archive", "the end of the file");
  // A comment of up to 65,535 bytes may follow.
  const std::uint64_t last = bytes_.size() - kArchiveEnd, first = last - std::min<std::uint64_t>(last, 0xffff);
  std::uint64_t at = last + 1;
  do {
    if (at == first) fail(bytes_.size(), "the end of a ZIP archive's directory ('PK' 5 6) before", "none");
    at = bytes_.rfind(kEndMark, at - 1);
    if (at == std::string_view::npos || at < first)
      fail(bytes_.size(), "the end of a ZIP archive's directory ('PK' 5 6) before", "none");
  } while (at + kArchiveEnd + number(at + 20, 2) > bytes_.size());
  std::uint64_t count = number(at + 10, 2), size = number(at + 12, 4);
  directory_field_ = {at + 16, 4};
  const bool is_wide = at >= kWideLocator && bytes_.substr(at - kWideLocator, 4) == kWideLocatorMark;
  if (number(at + 4, 4) != 0 && !is_wide) fail(at, "an archive in one file", "one of several");
  if (is_wide) {
    wide_end_field_ = {at - kWideLocator + 8, 8};
    wide_end_at_ = number(wide_end_field_);
    if (!holds(wide_end_at_, kWideEnd) || bytes_.substr(wide_end_at_, 4) != kWideEndMark)
      fail(at - kWideLocator, "the place of ZIP64's end of the directory", fmt::format("{}", wide_end_at_));
    count = number(wide_end_at_ + 32, 8);
    size = number(wide_end_at_ + 40, 8);
    if (number(directory_field_) != kToldElsewhere) narrow_directory_field_ = directory_field_;
    directory_field_ = {wide_end_at_ + 48, 8};
    at = wide_end_at_;
  }
  directory_at_ = number(directory_field_);
  if (directory_at_ > at || size > at - directory_at_)
    fail(at, fmt::format("a directory before byte {}", at), fmt::format("{} bytes at {}", size, directory_at_));
  read_directory(directory_at_, size, count);
}

void ZipArchive::read_directory(std::uint64_t begin, std::uint64_t size, std::uint64_t count) {
  if (count > size / kDirectoryHeader)
    fail(begin, fmt::format("at most {} entries in {} bytes", size / kDirectoryHeader, size), fmt::format("{}", count));
  require_memory(count * sizeof(ZipEntry), path_);
  entries_.reserve(count);
  std::uint64_t at = begin;
  for (std::uint64_t i = 0; i < count; ++i) at = read_entry(at, begin + size);
}

std::uint64_t ZipArchive::read_entry(std::uint64_t at, std::uint64_t end) {
  const auto require = [&](std::uint64_t bytes) {
    if (end - at < bytes) fail(at, "an entry of the archive's directory", "the end of the directory");
  };
  require(kDirectoryHeader);
  if (bytes_.substr(at, 4) != kDirectoryMark)
    fail(at, "an entry of the archive's directory ('PK' 1 2)", fmt::format("'{}'", in_short(bytes_.substr(at, 4))));
  const std::uint64_t name = number(at + 28, 2), extra = number(at + 30, 2), comment = number(at + 32, 2);
  require(kDirectoryHeader + name + extra + comment);
  ZipEntry entry;
  entry.directory_at = at;
  entry.name = bytes_.substr(at + kDirectoryHeader, name);
  entry.flags = static_cast<std::uint16_t>(number(at + 8, 2));
  entry.method = static_cast<std::uint16_t>(number(at + 10, 2));
  entry.crc = static_cast<std::uint32_t>(number(at + 16, 4));
  entry.packed_field = {at + 20, 4};
  entry.size_field = {at + 24, 4};
  entry.offset_field = {at + 42, 4};
  const std::uint64_t extra_at = at + kDirectoryHeader + name;
  read_wide_fields({&entry.size_field, &entry.packed_field, &entry.offset_field}, extra_at, extra_at + extra);
  entry.packed = number(entry.packed_field);
  entry.size = number(entry.size_field);
  entry.header_at = number(entry.offset_field);
  read_local_header(entry);
  by_name_.emplace(in_lower_case(entry.name), entries_.size());
  entries_.push_back(entry);
  return extra_at + extra + comment;
}

void ZipArchive::read_wide_fields(std::initializer_list<ZipField*> fields, std::uint64_t extra,
                                  std::uint64_t extra_end) const {
  for (std::uint64_t at = extra; extra_end - at >= 4;) {
    const std::uint64_t size = number(at + 2, 2), begin = at + 4;
    if (size > extra_end - begin) return;  // what other programs put here need not be well-formed
    if (number(at, 2) == 1) {
      // Only those numbers are here that have no place in 32 bits.
      std::uint64_t next = begin;
      for (ZipField* const field : fields) {
        if (number(*field) != kToldElsewhere || begin + size - next < 8) continue;
        *field = {next, 8};
        next += 8;
      }
      return;
    }
    at = begin + size;
  }
}

void ZipArchive::read_local_header(ZipEntry& entry) const {
  const std::uint64_t at = entry.header_at;
  if (!holds(at, kLocalHeader) || bytes_.substr(at, 4) != kLocalMark)
    fail(entry.directory_at, "the place of an entry ('PK' 3 4)", fmt::format("{}", at));
  const std::uint64_t name = number(at + 26, 2), extra = number(at + 28, 2), extra_at = at + kLocalHeader + name;
  entry.data_at = extra_at + extra;
  if (!holds(entry.data_at, entry.packed))
    fail(entry.directory_at, fmt::format("{} bytes of an entry at {}", entry.packed, entry.data_at),
         fmt::format("a file of {}", bytes_.size()));
  entry.local_packed_field = {at + 18, 4};
  entry.local_size_field = {at + 22, 4};
  read_wide_fields({&entry.local_size_field, &entry.local_packed_field}, extra_at, entry.data_at);
  entry.end_at = descriptor_end(entry);
}

/// Behind the bytes of an entry whose numbers were not known before it.
std::uint64_t ZipArchive::descriptor_end(const ZipEntry& entry) const {
  std::uint64_t at = entry.data_at + entry.packed;
  if (!(entry.flags & kDescribedBehind)) return at;
  const std::uint64_t none = at;
  if (bytes_.substr(at, 4) == kDescriptorMark) at += 4;
  for (const int width : {4, 8}) {
    if (!holds(at, static_cast<std::uint64_t>(4 + 2 * width)) || number(at, 4) != entry.crc) continue;
    if (number(at + 4, width) == entry.packed &&
        number(at + 4 + static_cast<std::uint64_t>(width), width) == entry.size)
      return at + 4 + 2 * static_cast<std::uint64_t>(width);
  }
  return none;
}

void ZipArchive::require_apart() const {
  std::vector<const ZipEntry*> order;
  for (const ZipEntry& entry : entries_) order.push_back(&entry);
  std::sort(order.begin(), order.end(), [](auto* a, auto* b) { return a->header_at < b->header_at; });
  std::uint64_t end = 0;
  for (const ZipEntry* const entry : order) {
    if (entry->header_at < end || entry->end_at > directory_at_)
      fail(entry->directory_at, "an entry apart from others and from the directory",
           fmt::format("one from {} to {}", entry->header_at, entry->end_at));
    end = entry->end_at;
  }
}

const ZipEntry* ZipArchive::find(std::string_view name) const {
  const auto [first, last] = by_name_.equal_range(in_lower_case(name));
  if (first == last) return nullptr;
  const ZipEntry& entry = entries_[first->second];
  if (std::next(first) != last) fail(entry.directory_at, fmt::format("one part '{}'", in_short(name, 80)), "two");
  return &entry;
}

std::string ZipArchive::label(const ZipEntry& entry) const {
  return fmt::format("{}: {}", path_, in_short(entry.name, 80));
}

void ZipArchive::require_readable(const ZipEntry& entry) const {
  const auto require = [&](bool holds, std::string_view expected, const std::string& found) {
    if (!holds)
      throw InvalidInput(
          fmt::format("{}, byte {}: expected {}, got {}", label(entry), entry.header_at, expected, found));
  };
  require(!(entry.flags & kEncrypted), "bytes that are not encrypted", "encrypted ones");
  require(entry.method == kStored || entry.method == kDeflated, "stored or deflated bytes",
          fmt::format("compression method {}", entry.method));
  require(entry.method == kDeflated || entry.size == entry.packed, fmt::format("{} stored bytes", entry.size),
          fmt::format("{}", entry.packed));
  require(entry.size / kMostRatio <= entry.packed, "a size that deflated bytes can have",
          fmt::format("{} bytes made of {}", entry.size, entry.packed));
  constexpr std::uint64_t kLarge = std::uint64_t{1} << 26;  // bytes; less is not worth asking the system about
  if (entry.size <= kLarge) return;
  if (const std::size_t most = available_memory() / 2; entry.size > most)
    throw InvalidInput(fmt::format("{}: expected at most {} MiB when unpacked, half of what is free, got {}",
                                   label(entry), most >> 20, entry.size >> 20));
}

std::string ZipArchive::read(const ZipEntry& entry) const {
  require_readable(entry);
  const std::string where = label(entry);
  const std::string_view packed = bytes_.substr(entry.data_at, entry.packed);
  if (entry.method == kStored) require_memory(packed.size(), where);
  std::string bytes = entry.method == kStored ? std::string(packed) : unpack(where, packed, entry.size);
  if (const std::uint32_t crc = crc_of(bytes); crc != entry.crc)
    throw InvalidInput(fmt::format("{}: expected bytes of the checksum {:08x}, got {:08x}", where, entry.crc, crc));
  return bytes;
}

std::string ZipArchive::read_beginning(const ZipEntry& entry, std::size_t most) const {
  require_readable(entry);
  const std::string_view packed = bytes_.substr(entry.data_at, entry.packed);
  return entry.method == kStored ? std::string(packed.substr(0, most)) : unpack_beginning(label(entry), packed, most);
}

}  // namespace vdb_offset::io
