// SPDX-License-Identifier: Apache-2.0
// Compresses and decompresses bytes by gzip and zstd, as a file's ending says. Members of gzip and frames of zstd
// follow each other in a file, and all of them are taken, a chunk at a time. The result may take half of the memory
// that is free and no more than the run's limit; data that are damaged or end early are refused, with the byte.
// compress() makes one member or frame, so that a file can be put together from pieces that were compressed by
// themselves, on several threads. compress_block() makes zlib's own format for VTK's files. Bytes without such an
// ending pass through as they are; whether a file's first bytes fit its ending is not asked.
#include "bytes/compression.h"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <vector>

#include "bytes/scanner.h"
#include "ground/system/memory.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

constexpr std::size_t kChunk = std::size_t{1}
                               << 20;  // bytes that are decompressed at a time; not measured beside other sizes
// zlib's parameter for a window of 32 KiB (15) and the format of gzip (16).
constexpr int kGzipWindow = 15 + 16;

/// Collects decompressed bytes, and refuses more of them than memory allows.
class Output {
 public:
  explicit Output(const std::string& path) : path_(path), most_(available_memory() / 2) {}

  /// Appends bytes. The buffer grows by half, or by just what is needed if half does not fit into memory beside it.
  void append(const char* data, std::size_t size) {
    if (size > most_ - bytes_.size())
      throw InvalidInput(
          fmt::format("{}: expected at most {} MiB when decompressed, half of what is free", path_, most_ >> 20));
    if (const std::size_t needed = bytes_.size() + size; needed > bytes_.capacity()) {
      std::size_t more = std::max(needed, std::min(bytes_.capacity() + bytes_.capacity() / 2, most_));
      if (!fits_memory(more)) more = needed;
      require_memory(more, path_);
      bytes_.reserve(more);
    }
    bytes_.append(data, size);
  }
  std::string take() { return std::move(bytes_); }

 private:
  const std::string& path_;
  std::size_t most_;
  std::string bytes_;
};

[[noreturn]] void damaged(const std::string& path, std::size_t at, const char* expected, const char* found) {
  throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", path, at, expected, found));
}

std::string from_gzip(const std::string& path, std::string_view bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, kGzipWindow) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, &inflateEnd);
  Output output(path);
  std::vector<char> chunk(kChunk);
  std::size_t given = 0;
  for (int status = Z_OK; status != Z_STREAM_END || given < bytes.size() || stream.avail_in > 0;) {
    if (status == Z_STREAM_END) inflateReset(&stream);
    if (stream.avail_in == 0) {  // zlib counts in 32 bits: it gets its input in parts
      const std::string_view next = bytes.substr(given, std::size_t{1} << 30);
      if (next.empty()) damaged(path, bytes.size(), "the end of the gzip data", "the end of the file");
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(next.data()));
      stream.avail_in = static_cast<uInt>(next.size());
      given += next.size();
    }
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    status = inflate(&stream, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      damaged(path, given - stream.avail_in, "gzip data", stream.msg ? stream.msg : "something else");
    output.append(chunk.data(), chunk.size() - stream.avail_out);
  }
  return output.take();
}

std::string from_zstd(const std::string& path, std::string_view bytes) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  Output output(path);
  std::vector<char> chunk(kChunk);
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  for (std::size_t left = 1; in.pos < in.size || left != 0;) {
    ZSTD_outBuffer out{chunk.data(), chunk.size(), 0};
    const std::size_t before = in.pos;
    left = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(left)) damaged(path, in.pos, "zstd data", ZSTD_getErrorName(left));
    output.append(chunk.data(), out.pos);
    const bool stuck = in.pos == before && out.pos == 0;
    if (stuck && left != 0) damaged(path, bytes.size(), "the end of the zstd data", "the end of the file");
  }
  return output.take();
}

std::string to_gzip(const std::string& bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, &deflateEnd);
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  return packed;
}

std::string to_zstd(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (ZSTD_isError(size)) throw std::bad_alloc();
  packed.resize(size);
  return packed;
}

constexpr std::array<std::pair<std::string_view, Compression>, 2> kEndings = {
    {{".gz", Compression::Gzip}, {".zst", Compression::Zstd}}};

}  // namespace

Compression compression_of(std::string_view path) {
  for (const auto& [ending, compression] : kEndings)
    if (path.size() > ending.size() && is_word(path.substr(path.size() - ending.size()), ending)) return compression;
  return Compression::None;
}

std::string_view without_compression(std::string_view path) {
  return compression_of(path) == Compression::None ? path : path.substr(0, path.rfind('.'));
}

std::string decompress(Compression compression, const std::string& path, std::string_view bytes) {
  if (compression == Compression::None) return std::string(bytes);
  return compression == Compression::Gzip ? from_gzip(path, bytes) : from_zstd(path, bytes);
}

std::string compress(Compression compression, const std::string& bytes) {
  if (compression == Compression::None) return bytes;
  return compression == Compression::Gzip ? to_gzip(bytes) : to_zstd(bytes);
}

std::string compress_block(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), Z_BEST_SPEED) != Z_OK)
    throw std::bad_alloc();
  packed.resize(size);
  return packed;
}

}  // namespace vdb_offset::io
