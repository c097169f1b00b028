// SPDX-License-Identifier: Apache-2.0
// Packs the contents of entries: each piece is deflated by itself, in parallel, and ends on a whole byte, so that
// pieces follow each other as one stream; their checksums are combined. libzip, which would deflate with one thread,
// takes the stream as it is (zip_archive.cpp).
#include "threemf/zip_packing.h"

#include <zip.h>
#include <zlib.h>

#include <memory>
#include <new>
#include <utility>

#include "ground/system/memory.h"
#include "ground/system/parallel.h"

namespace vdb_offset::io {
namespace {

/// One piece of a deflated stream, which ends on a whole byte, so that another may follow.
std::string deflated(const std::string& bytes, bool is_last) {
  constexpr int kBareWindow = -15;  // zlib's parameter for a window of 32 KiB without any header
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kBareWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, &deflateEnd);
  constexpr std::size_t kFlush = 16;  // bytes; what a flush adds at most
  std::string packed(deflateBound(&stream, bytes.size()) + kFlush, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, is_last ? Z_FINISH : Z_SYNC_FLUSH);
  packed.resize(stream.total_out);
  return packed;
}

}  // namespace

Packed pack(const std::string& where, const Pieces& contents, std::uint16_t method) {
  Packed packed{method, 0, 0, {}};
  std::vector<std::string> pieces(contents.count);
  std::vector<std::uint32_t> crc(contents.count);
  std::vector<std::uint64_t> size(contents.count);
  for_each_index(
      contents.count,
      [&](std::size_t i) {
        std::string bytes = contents.make(i);
        require_memory(bytes.size(), where);
        crc[i] = static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
        size[i] = bytes.size();
        pieces[i] = method == ZIP_CM_STORE ? std::move(bytes) : deflated(bytes, i + 1 == contents.count);
      },
      1);
  for (std::size_t i = 0; i < contents.count; ++i) {
    packed.crc = static_cast<std::uint32_t>(crc32_combine(packed.crc, crc[i], static_cast<z_off_t>(size[i])));
    packed.size += size[i];
    packed.bytes += std::exchange(pieces[i], {});
  }
  return packed;
}

}  // namespace vdb_offset::io
