// SPDX-License-Identifier: Apache-2.0
// ZIP archives in memory, by libzip. It copies entries that stay as they are packed, and writes the sizes of all before
// their bytes. What a hostile archive could have it do without measure is refused before: an entry or a directory that
// is too large, and entries that are the same bytes.
#include "threemf/zip_archive.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <iterator>
#include <new>
#include <utility>

#include "bytes/scanner.h"
#include "ground/system/memory.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

// Deflate makes at most so many bytes of one (zlib, "Technical Details").
constexpr std::uint64_t kMostRatio = 1032;
constexpr std::size_t kAtOnce = std::size_t{1} << 20;  // bytes; not measured beside others

std::string in_lower_case(std::string_view name) {
  std::string lower(name);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

[[noreturn]] void fail(const std::string& where, const std::string& expected, zip_error_t* error) {
  const std::string found = zip_error_strerror(error);
  const bool lacks_memory = zip_error_code_zip(error) == ZIP_ER_MEMORY;
  zip_error_fini(error);
  if (lacks_memory) throw std::bad_alloc();
  throw InvalidInput(fmt::format("{}: expected {}, got '{}'", where, expected, found));
}

/// An archive in memory, which is written to its source when it is closed. libzip 1.7 may free what is written over,
/// whosever it is: bytes that may change are its own.
struct OpenArchive {
  std::unique_ptr<zip_source_t, void (*)(zip_source_t*)> source{nullptr, zip_source_free};
  std::unique_ptr<zip_t, void (*)(zip_t*)> archive{nullptr, zip_discard};

  OpenArchive(const std::string& where, std::string_view bytes, int flags) {
    const bool is_kept = flags == ZIP_RDONLY || bytes.empty();
    void* const copy = is_kept ? nullptr : std::malloc(bytes.size());
    if (!is_kept && !copy) throw std::bad_alloc();
    if (copy) std::memcpy(copy, bytes.data(), bytes.size());
    zip_error_t error;
    zip_error_init(&error);
    source.reset(zip_source_buffer_create(copy ? copy : bytes.data(), bytes.size(), copy != nullptr, &error));
    if (source) archive.reset(zip_open_from_source(source.get(), flags, &error));
    if (!archive) fail(where, "a ZIP archive", &error);
    zip_source_keep(source.get());  // the archive has one of its own
  }
};

/// Refuses ends of directories of which libzip would take room for as many entries as they tell, or read a directory
/// again and again: it tries all ends that it finds where a comment may follow.
void require_modest_directory(const std::string& path, std::string_view bytes) {
  constexpr std::uint64_t kEnd = 22, kWideEnd = 56, kWideLocator = 20, kEntry = 46, kLongestComment = 0xffff;  // bytes
  constexpr std::uint64_t kLargestDirectory = std::uint64_t{1} << 20;  // some ten thousand entries; slicers make few
  constexpr int kMostEnds = 16;
  const auto number = [&](std::uint64_t at, std::size_t width) {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data() + at, width);
    return value;
  };
  std::uint64_t at = bytes.size() - std::min<std::uint64_t>(bytes.size(), kEnd + kLongestComment);
  int ends = 0;
  for (; (at = bytes.find("PK\5\6", at)) != std::string_view::npos && bytes.size() - at >= kEnd; ++at) {
    std::uint64_t count = number(at + 10, 2), size = number(at + 12, 4);
    if (at >= kWideLocator && bytes.substr(at - kWideLocator, 4) == "PK\6\7")
      if (const std::uint64_t wide = number(at - kWideLocator + 8, 8); wide <= at && at - wide >= kWideEnd) {
        count = number(wide + 32, 8);
        size = number(wide + 40, 8);
      }
    if (size > kLargestDirectory || count > size / kEntry || ++ends > kMostEnds)
      throw InvalidInput(
          fmt::format("{}, byte {}: expected the end of a directory of at most {} bytes, got {} entries in {}", path,
                      at, kLargestDirectory, count, size));
  }
}

/// Packed contents, as a source that libzip reads once and copies as it is.
struct PackedSource {
  Packed contents;
  std::size_t at = 0;
};

zip_int64_t answer(void* self, void* data, zip_uint64_t size, zip_source_cmd_t command) {
  auto& [contents, at] = *static_cast<PackedSource*>(self);
  if (command == ZIP_SOURCE_SUPPORTS)
    return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE, ZIP_SOURCE_STAT,
                                          ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, -1);
  if (command == ZIP_SOURCE_READ) {
    const std::size_t count = contents.bytes.copy(static_cast<char*>(data), size, at);
    at += count;
    return static_cast<zip_int64_t>(count);
  }
  if (command != ZIP_SOURCE_STAT) return 0;  // opened, closed, freed
  auto& stat = *static_cast<zip_stat_t*>(data);
  zip_stat_init(&stat);
  stat.valid = ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD | ZIP_STAT_CRC;
  stat.size = contents.size;
  stat.comp_size = contents.bytes.size();
  stat.comp_method = contents.method;
  stat.crc = contents.crc;
  return sizeof stat;
}

/// What is to be put into an archive.
class Changes {
 public:
  Changes(const std::string& where, std::string_view bytes, int flags)
      : where_(where), open_(where, bytes, flags), bytes_(bytes.size()) {}

  zip_t* archive() { return open_.archive.get(); }
  /// Puts the contents in by put(source), which gives the entry's index.
  template <class Put>
  std::uint64_t put(Packed contents, Put&& into) {
    bytes_ += contents.bytes.size();
    PackedSource& packed = sources_.emplace_back(PackedSource{std::move(contents)});
    zip_source_t* const source = zip_source_function(archive(), answer, &packed);
    const zip_int64_t index = source ? into(source) : -1;
    if (index < 0) zip_source_free(source);
    require(index >= 0);
    require(zip_set_file_compression(archive(), static_cast<zip_uint64_t>(index), packed.contents.method, 0) == 0);
    return static_cast<std::uint64_t>(index);
  }
  void require(bool done) {
    if (!done) fail(where_, "entries that can be copied", zip_get_error(archive()));
  }

  /// The archive as it is then.
  Pieces write() {
    require_memory(2 * bytes_, where_);
    require(zip_close(archive()) == 0);
    static_cast<void>(open_.archive.release());  // closed
    zip_source_t* const source = open_.source.get();
    const auto bytes = std::make_shared<std::vector<std::string>>();
    std::string room(kAtOnce, '\0');
    zip_int64_t count = zip_source_open(source);
    if (count == 0)
      while ((count = zip_source_read(source, room.data(), room.size())) > 0)
        bytes->emplace_back(room, 0, static_cast<std::size_t>(count));
    if (count < 0) fail(where_, "an archive that can be written", zip_source_error(source));
    return {bytes->size(), [bytes](std::size_t piece) { return (*bytes)[piece]; }};
  }

 private:
  const std::string& where_;
  std::deque<PackedSource> sources_;
  OpenArchive open_;     // freed before what it reads
  std::uint64_t bytes_;  // at most
};

}  // namespace

ZipArchive::ZipArchive(const std::string& path, std::string_view bytes)
    : path_(path), bytes_(bytes), archive_(nullptr, zip_discard) {
  require_modest_directory(path, bytes);
  archive_ = std::move(OpenArchive(path, bytes, ZIP_RDONLY).archive);
  std::uint64_t packed = 0;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive_.get(), 0); ++i) {
    const auto index = static_cast<zip_uint64_t>(i);
    zip_stat_t stat;
    const char* const name = zip_get_name(archive_.get(), index, ZIP_FL_ENC_RAW);
    if (!name || zip_stat_index(archive_.get(), index, 0, &stat) != 0)
      fail(path, "a ZIP archive", zip_get_error(archive_.get()));
    by_name_.emplace(in_lower_case(name), entries_.size());
    entries_.push_back({name, index, stat.size, stat.comp_size, stat.comp_method, stat.mtime});
    if (stat.comp_size > bytes.size() - packed)
      throw InvalidInput(fmt::format("{}: expected entries apart from each other in {} bytes, got more",
                                     label(entries_.back()), bytes.size()));
    packed += stat.comp_size;
  }
}

const ZipEntry* ZipArchive::find(std::string_view name) const {
  const auto [first, last] = by_name_.equal_range(in_lower_case(name));
  if (first == last) return nullptr;
  if (std::next(first) != last)
    throw InvalidInput(fmt::format("{}: expected one part '{}', got two", path_, in_short(name, 80)));
  return &entries_[first->second];
}

std::string ZipArchive::label(const ZipEntry& entry) const {
  return fmt::format("{}: {}", path_, in_short(entry.name, 80));
}

std::string ZipArchive::unpack(const ZipEntry& entry, std::uint64_t most) const {
  const std::string where = label(entry);
  const std::lock_guard lock(one_reader_);
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(zip_fopen_index(archive_.get(), entry.index, 0),
                                                               zip_fclose);
  if (!file) fail(where, "bytes that can be unpacked", zip_get_error(archive_.get()));
  std::string bytes;
  std::uint64_t done = 0;
  while (done < most) {
    if (done == bytes.size()) {
      const std::uint64_t next = std::min(most, done + std::max<std::uint64_t>(done, kAtOnce));
      require_memory(next, where);
      bytes.resize(next);
    }
    const zip_int64_t count = zip_fread(file.get(), bytes.data() + done, bytes.size() - done);
    if (count < 0) fail(where, "bytes that can be unpacked", zip_file_get_error(file.get()));
    if (count == 0) break;
    done += static_cast<std::uint64_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

std::string ZipArchive::read(const ZipEntry& entry) const {
  const auto require = [&](bool holds, std::string_view expected, const std::string& found) {
    if (!holds) throw InvalidInput(fmt::format("{}: expected {}, got {}", label(entry), expected, found));
  };
  require(entry.method == ZIP_CM_STORE || entry.method == ZIP_CM_DEFLATE, "stored or deflated bytes",
          fmt::format("compression method {}", entry.method));
  require(entry.size / kMostRatio <= entry.packed, "a size that deflated bytes can have",
          fmt::format("{} bytes made of {}", entry.size, entry.packed));
  constexpr std::uint64_t kLarge = std::uint64_t{1} << 26;  // bytes; less is not worth asking the system about
  if (entry.size > kLarge)
    if (const std::size_t most = available_memory() / 2; entry.size > most)
      require(false, fmt::format("at most {} MiB when unpacked, half of what is free", most >> 20),
              fmt::format("{}", entry.size >> 20));
  // One byte more than promised has room, and shows that there are too many.
  std::string bytes = unpack(entry, entry.size + 1);
  require(bytes.size() == entry.size, fmt::format("{} bytes when unpacked", entry.size),
          bytes.size() > entry.size ? "more" : fmt::format("{}", bytes.size()));
  return bytes;
}

std::string ZipArchive::read_beginning(const ZipEntry& entry, std::size_t most) const { return unpack(entry, most); }

Pieces ZipArchive::with(std::vector<Replacement>&& replacements) const {
  require_memory(bytes_.size(), path_);
  Changes changes(path_, bytes_, 0);
  for (auto& [entry, contents] : replacements) {
    const auto index = changes.put(std::move(contents), [&, at = entry->index](zip_source_t* source) {
      return zip_file_replace(changes.archive(), at, source, 0) == 0 ? static_cast<zip_int64_t>(at) : -1;
    });
    changes.require(zip_file_set_mtime(changes.archive(), index, entry->time, 0) == 0);
  }
  return changes.write();
}

Pieces new_archive(const std::string& where, const std::vector<NewEntry>& entries) {
  Changes changes(where, {}, ZIP_TRUNCATE);
  for (const NewEntry& entry : entries) {
    const auto index = changes.put(pack(where, entry.contents, ZIP_CM_DEFLATE), [&](zip_source_t* source) {
      return zip_file_add(changes.archive(), entry.name.c_str(), source, ZIP_FL_ENC_UTF_8);
    });
    constexpr zip_uint16_t kFirstDay = 1 << 5 | 1;  // of January 1980
    changes.require(zip_file_set_dostime(changes.archive(), index, 0, kFirstDay, 0) == 0);
  }
  return changes.write();
}

}  // namespace vdb_offset::io
