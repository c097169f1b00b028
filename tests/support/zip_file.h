// SPDX-License-Identifier: Apache-2.0
// ZIP archives byte by byte (APPNOTE 6.3), apart from the library's own, and with what it does not write: entries
// stored, described behind their bytes, with wide numbers, extra fields and comments, and wrong ones.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

#include "support/bytes.h"

struct ZipItem {
  std::string name, bytes;
  bool deflated = true;
  bool described_behind = false;  ///< As programs write that cannot go back.
  bool wide = false;              ///< Numbers of 64 bits in the directory.
  std::string comment = {};
  // What is told in the place of the truth, if not ~0.
  std::uint32_t told_crc = ~0U, told_size = ~0U;
  std::string packed = {};  ///< In the place of what the bytes come to.
};

inline std::string deflated(const std::string& bytes) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

inline std::string zip_file(const std::vector<ZipItem>& items, const std::string& comment = {}) {
  std::string file, directory;
  const auto u16 = [](std::size_t value) { return raw(static_cast<std::uint16_t>(value)); };
  const auto u32 = [](std::size_t value) { return raw(static_cast<std::uint32_t>(value)); };
  const auto u64 = [](std::size_t value) { return raw(static_cast<std::uint64_t>(value)); };
  for (const ZipItem& item : items) {
    const std::string packed = !item.packed.empty() ? item.packed : item.deflated ? deflated(item.bytes) : item.bytes;
    const auto true_crc = static_cast<std::uint32_t>(
        crc32(0, reinterpret_cast<const Bytef*>(item.bytes.data()), static_cast<uInt>(item.bytes.size())));
    const std::size_t crc = item.told_crc == ~0U ? true_crc : item.told_crc,
                      size = item.told_size == ~0U ? item.bytes.size() : item.told_size, at = file.size();
    const std::string common =
        u16(item.described_behind ? 8 : 0) + u16(item.deflated ? 8 : 0) + u16(0x6b2d) + u16(0x5a8f);
    const std::string extra = "\x55\x54" + u16(5) + std::string("\1abcd");  // a time, as Info-ZIP writes it
    const auto told = [&](std::size_t value) { return u32(item.described_behind ? 0 : value); };
    file += "PK\3\4" + u16(20) + common + told(crc) + told(packed.size()) + told(size) + u16(item.name.size()) +
            u16(extra.size()) + item.name + extra + packed;
    if (item.described_behind) file += "PK\7\10" + u32(crc) + u32(packed.size()) + u32(size);
    const std::string wide = u16(1) + u16(24) + u64(size) + u64(packed.size()) + u64(at),
                      more = item.wide ? extra + wide : extra;
    const auto narrow = [&](std::size_t value) { return u32(item.wide ? 0xffffffff : value); };
    directory += "PK\1\2" + u16(0x031e) + u16(20) + common + u32(crc) + narrow(packed.size()) + narrow(size) +
                 u16(item.name.size()) + u16(more.size()) + u16(item.comment.size()) + u16(0) + u16(0) +
                 u32(0x81a40000) + narrow(at) + item.name + more + item.comment;
  }
  const std::size_t at = file.size();
  file += directory;
  bool wide = false;
  for (const ZipItem& item : items) wide = wide || item.wide;
  if (wide)
    file += "PK\6\6" + u64(44) + u16(45) + u16(45) + u32(0) + u32(0) + u64(items.size()) + u64(items.size()) +
            u64(directory.size()) + u64(at) + "PK\6\7" + u32(0) + u64(at + directory.size()) + u32(1);
  return file + "PK\5\6" + u32(0) + u16(items.size()) + u16(items.size()) + u32(directory.size()) +
         u32(wide ? 0xffffffff : at) + u16(comment.size()) + comment;
}
