// SPDX-License-Identifier: Apache-2.0
#include "batch/fingerprint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#define XXH_INLINE_ALL  // NOLINT(readability-identifier-naming): it is xxHash's
#include <xxhash.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "batch/process/stop.h"

namespace vdb_offset::tool {
namespace {

class Hash {
 public:
  Hash() { XXH3_128bits_reset(state_.get()); }

  void add(const void* bytes, std::size_t size) { XXH3_128bits_update(state_.get(), bytes, size); }
  void add(std::string_view text) {
    const std::uint64_t size = text.size();
    add(&size, sizeof size);
    add(text.data(), text.size());
  }
  /// Adds the bytes of a file, and their number.
  void add_file(const std::string& path);

  /// Adds what changes with each writing of a file.
  void add_stamp(const std::string& path);

  std::string digits() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  }

 private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> state_{XXH3_createState()};
};

void Hash::add_file(const std::string& path) {
  constexpr std::size_t kChunk = 1 << 20;  // bytes read at once
  constexpr std::uint64_t kUnread = ~std::uint64_t{0};
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // not to wait for the writer of a pipe
  struct stat facts {};
  const bool readable = file >= 0 && ::fstat(file, &facts) == 0 && S_ISREG(facts.st_mode);
  std::uint64_t size = readable ? 0 : kUnread;
  std::vector<char> chunk(readable ? kChunk : 0);
  for (ssize_t count = 1; size != kUnread && count > 0 && !stop_signal();) {
    count = ::read(file, chunk.data(), chunk.size());
    if (count > 0) add(chunk.data(), static_cast<std::size_t>(count));
    size = count < 0 ? kUnread : size + static_cast<std::uint64_t>(count);
  }
  if (file >= 0) ::close(file);
  add(&size, sizeof size);
}

void Hash::add_stamp(const std::string& path) {
  struct stat facts {};
  if (::stat(path.c_str(), &facts) != 0) facts = {};
  for (const auto number :
       {static_cast<std::int64_t>(facts.st_dev), static_cast<std::int64_t>(facts.st_ino),
        static_cast<std::int64_t>(facts.st_size), static_cast<std::int64_t>(facts.st_mtim.tv_sec),
        static_cast<std::int64_t>(facts.st_mtim.tv_nsec), static_cast<std::int64_t>(facts.st_ctim.tv_sec),
        static_cast<std::int64_t>(facts.st_ctim.tv_nsec)})
    add(&number, sizeof number);
}

}  // namespace

std::string stamp_of(std::span<const std::string> words, std::span<const std::string> files) {
  Hash hash;
  for (const std::string& word : words) hash.add(word);
  for (const std::string& file : files) hash.add_stamp(file);
  return hash.digits();
}

std::string fingerprint_of(std::string_view text) {
  Hash hash;
  hash.add(text);
  return hash.digits();
}

std::string fingerprint_of(std::span<const std::string> words, std::span<const std::string> files) {
  Hash hash;
  for (const std::string& word : words) hash.add(word);
  for (const std::string& file : files) hash.add_file(file);
  return hash.digits();
}

}  // namespace vdb_offset::tool
