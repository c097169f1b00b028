// SPDX-License-Identifier: Apache-2.0
// Packs and unpacks the contents of ZIP archives, and makes new archives. Each piece of an entry is deflated by itself,
// in parallel, and ends on a whole byte, so that pieces follow each other as one stream; their checksums are combined.
// The bytes depend on the pieces alone, and not on threads or the date: entries of a new archive are of the first day
// that the format has. Sizes and offsets beyond 32 bits get wide fields. Unpacking takes memory step by step as bytes
// come, and refuses an entry that gives more or fewer than it promised. Checksums of what is read are not compared
// here, and archives are rewritten elsewhere (zip_rewrite.cpp).
#include "threemf/zip_packing.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <new>

#include "bytes/append_number.h"
#include "ground/system/memory.h"
#include "ground/system/parallel.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

// zlib's parameter for a window of 32 KiB without any header.
constexpr int kBareWindow = -15;
constexpr std::size_t kUnpackAtOnce = std::size_t{1} << 20;  // bytes; not measured beside others
constexpr std::uint64_t kWide = 0xffffffff;  // what a field of 32 bits holds where one of 64 bits has the number

/// One piece of a deflated stream, which ends on a whole byte, so that another may follow.
std::string deflated(const std::string& bytes, bool is_last) {
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

/// A header of an entry, before its bytes or in the directory, with the wide numbers that it needs.
std::string entry_header(const NewEntry& entry, const Packed& contents, std::uint64_t offset, bool in_directory) {
  const bool is_wide = contents.size >= kWide || contents.packed >= kWide || offset >= kWide;
  constexpr std::uint16_t kFirstDay = 1 << 5 | 1;  // of January 1980
  std::string wide, header;
  if (is_wide) {
    append_binary(wide, std::uint16_t{1});
    append_binary(wide, static_cast<std::uint16_t>(in_directory ? 24 : 16));
    append_binary(wide, contents.size);
    append_binary(wide, contents.packed);
    if (in_directory) append_binary(wide, offset);
  }
  const auto narrow = [&](std::uint64_t number) { return static_cast<std::uint32_t>(is_wide ? kWide : number); };
  const auto version = static_cast<std::uint16_t>(is_wide ? 45 : 20);
  header += in_directory ? "PK\1\2" : "PK\3\4";
  if (in_directory) append_binary(header, version);
  append_binary(header, version);
  append_binary(header, std::uint16_t{0});
  append_binary(header, contents.method);
  append_binary(header, std::uint16_t{0});
  append_binary(header, kFirstDay);
  append_binary(header, contents.crc);
  append_binary(header, narrow(contents.packed));
  append_binary(header, narrow(contents.size));
  append_binary(header, static_cast<std::uint16_t>(entry.name.size()));
  append_binary(header, static_cast<std::uint16_t>(wide.size()));
  if (in_directory) {
    header.append(10, '\0');  // no comment, the first file, no attributes
    append_binary(header, narrow(offset));
  }
  return header + entry.name + wide;
}

/// What stands behind the directory.
std::string archive_end(std::uint64_t at, std::uint64_t size, std::uint64_t count) {
  std::string end;
  const bool is_wide = at >= kWide;
  if (is_wide) {
    end += "PK\6\6";
    append_binary(end, std::uint64_t{44});
    append_binary(end, std::uint16_t{45});
    append_binary(end, std::uint16_t{45});
    append_binary(end, std::uint64_t{0});  // two numbers: this file is the first, with the directory
    append_binary(end, count);
    append_binary(end, count);
    append_binary(end, size);
    append_binary(end, at);
    end += "PK\6\7";
    append_binary(end, std::uint32_t{0});
    append_binary(end, at + size);
    append_binary(end, std::uint32_t{1});
  }
  end += "PK\5\6";
  append_binary(end, std::uint32_t{0});
  append_binary(end, static_cast<std::uint16_t>(count));
  append_binary(end, static_cast<std::uint16_t>(count));
  append_binary(end, static_cast<std::uint32_t>(size));
  append_binary(end, static_cast<std::uint32_t>(is_wide ? kWide : at));
  append_binary(end, std::uint16_t{0});
  return end;
}

[[noreturn]] void damaged_entry(const std::string& where, const std::string& expected, const std::string& found) {
  throw InvalidInput(fmt::format("{}: expected {}, got {}", where, expected, found));
}

/// Takes the bytes out of a deflated stream, some at a time.
class Inflater {
 public:
  Inflater(const std::string& where, std::string_view packed) : where_(where), rest_(packed) {
    if (inflateInit2(&stream_, kBareWindow) != Z_OK) throw std::bad_alloc();
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  bool at_end() const { return at_end_; }

  /// How many bytes came, `most` at most. \throw InvalidInput
  std::size_t read(char* to, std::size_t most) {
    constexpr std::size_t kCounted = std::size_t{1} << 30;  // zlib counts in 32 bits
    if (stream_.avail_in == 0) {
      const std::string_view next = rest_.substr(0, kCounted);
      if (next.empty() && is_hungry_) damaged_entry(where_, "deflated bytes to their end", "the end of the entry");
      stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(next.data()));
      stream_.avail_in = static_cast<uInt>(next.size());
      rest_.remove_prefix(next.size());
    }
    const auto room = static_cast<uInt>(std::min(most, kCounted));
    stream_.next_out = reinterpret_cast<Bytef*>(to);
    stream_.avail_out = room;
    const int status = inflate(&stream_, Z_NO_FLUSH);
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      damaged_entry(where_, "deflated bytes", stream_.msg ? fmt::format("'{}'", stream_.msg) : "something else");
    at_end_ = status == Z_STREAM_END;
    is_hungry_ = stream_.avail_out > 0;
    return room - stream_.avail_out;
  }

 private:
  const std::string& where_;
  std::string_view rest_;
  z_stream stream_{};
  bool at_end_ = false, is_hungry_ = false;
};

}  // namespace

Packed pack(const std::string& where, const Pieces& contents, std::uint16_t method) {
  Packed packed;
  packed.method = method;
  packed.pieces.resize(contents.count);
  std::vector<std::uint32_t> crc(contents.count);
  std::vector<std::uint64_t> size(contents.count);
  for_each_index(
      contents.count,
      [&](std::size_t i) {
        std::string bytes = contents.make(i);
        require_memory(bytes.size(), where);
        crc[i] = crc_of(bytes);
        size[i] = bytes.size();
        packed.pieces[i] = method == kStored ? std::move(bytes) : deflated(bytes, i + 1 == contents.count);
      },
      1);
  for (std::size_t i = 0; i < contents.count; ++i) {
    packed.crc = static_cast<std::uint32_t>(crc32_combine(packed.crc, crc[i], static_cast<z_off_t>(size[i])));
    packed.size += size[i];
    packed.packed += packed.pieces[i].size();
  }
  return packed;
}

std::string unpack(const std::string& where, std::string_view packed, std::uint64_t size) {
  Inflater inflater(where, packed);
  std::string bytes;
  std::size_t done = 0;
  while (!inflater.at_end()) {
    if (done > size) damaged_entry(where, fmt::format("{} bytes when unpacked", size), "more");
    // One byte more than promised has room, and shows that there are too many.
    if (done == bytes.size()) {
      const std::uint64_t next = std::min<std::uint64_t>(size + 1, done + std::max(done, kUnpackAtOnce));
      require_memory(next, where);
      bytes.resize(next);
    }
    done += inflater.read(bytes.data() + done, bytes.size() - done);
  }
  if (done != size) damaged_entry(where, fmt::format("{} bytes when unpacked", size), fmt::format("{}", done));
  bytes.resize(size);
  return bytes;
}

std::string unpack_beginning(const std::string& where, std::string_view packed, std::size_t most) {
  Inflater inflater(where, packed);
  std::string bytes(most, '\0');
  std::size_t done = 0;
  while (!inflater.at_end() && done < most) done += inflater.read(bytes.data() + done, most - done);
  bytes.resize(done);
  return bytes;
}

std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

Pieces new_archive(const std::string& where, const std::vector<NewEntry>& entries) {
  const auto bytes = std::make_shared<std::vector<std::string>>();
  std::string directory;
  std::uint64_t at = 0;
  for (const NewEntry& entry : entries) {
    Packed contents = pack(where, entry.contents, kDeflated);
    directory += entry_header(entry, contents, at, true);
    // The offset stands in the directory alone.
    bytes->push_back(entry_header(entry, contents, 0, false));
    at += bytes->back().size() + contents.packed;
    for (std::string& piece : contents.pieces) bytes->push_back(std::move(piece));
  }
  bytes->push_back(directory + archive_end(at, directory.size(), entries.size()));
  return {bytes->size(), [bytes](std::size_t piece) { return (*bytes)[piece]; }};
}

}  // namespace vdb_offset::io
