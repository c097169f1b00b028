// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/file_bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "bytes/compression.h"
#include "ground/system/memory.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

struct Descriptor {
  int fd;
  explicit Descriptor(int opened) : fd(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd > STDIN_FILENO) ::close(fd);
  }
};

[[noreturn]] void cannot(const std::string& path, const char* what) {
  throw ReadError(fmt::format("{}: cannot be {}: {}", path, what, std::strerror(errno)));
}

std::string read_to_end(const std::string& path, int fd) {
  std::string bytes;
  constexpr std::size_t kReadAtOnce = 1 << 20;  // bytes; more than a pipe hands over at a time
  for (;;) {
    const std::size_t before = bytes.size();
    if (before + kReadAtOnce > bytes.capacity()) {
      const std::size_t more = before + before / 2 + kReadAtOnce;
      require_memory(more, path);
      bytes.reserve(more);
    }
    bytes.resize(before + kReadAtOnce);
    const ssize_t got = ::read(fd, bytes.data() + before, kReadAtOnce);
    if (got < 0 && errno != EINTR) cannot(path, "read");
    bytes.resize(before + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got == 0) return bytes;
  }
}

struct stat status_of(const std::string& path, int fd) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) cannot(path, "read");
  return status;
}

}  // namespace

struct FileBytes::Mapping {
  Descriptor file;
  struct stat status;
  void* address;

  Mapping(const std::string& path, int fd) : file(fd), status(status_of(path, fd)) {
    address = ::mmap(nullptr, size(), PROT_READ, MAP_PRIVATE, fd, 0);
    if (address == MAP_FAILED) cannot(path, "mapped");
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ~Mapping() { ::munmap(address, size()); }

  std::size_t size() const { return static_cast<std::size_t>(status.st_size); }
  std::string_view view() const { return {static_cast<const char*>(address), size()}; }
};

FileBytes::FileBytes(std::string bytes) { show(std::move(bytes)); }

void FileBytes::show(std::string bytes) {
  owned_ = std::make_shared<const std::string>(std::move(bytes));
  view_ = *owned_;
}

FileBytes FileBytes::open(const std::string& path) {
  if (path == "-") return FileBytes(read_to_end("standard input", STDIN_FILENO));
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) cannot(path, "opened");
  auto file = std::make_unique<Descriptor>(fd);
  const struct stat status = status_of(path, fd);
  if (S_ISDIR(status.st_mode)) throw ReadError(path + ": expected a file, got a folder");
  FileBytes bytes;
  if (S_ISREG(status.st_mode) && status.st_size > 0) {
    file->fd = -1;
    bytes.mapping_ = std::make_shared<const Mapping>(path, fd);
    bytes.view_ = bytes.mapping_->view();
  } else {
    bytes = FileBytes(read_to_end(path, fd));
  }
  const Compression compression = compression_of(path);
  return compression == Compression::None ? bytes : FileBytes(decompress(compression, path, bytes.view()));
}

void FileBytes::require_unchanged(const std::string& path) const {
  if (!mapping_) return;
  const struct stat now = status_of(path, mapping_->file.fd), &then = mapping_->status;
  if (now.st_size != then.st_size || now.st_mtim.tv_sec != then.st_mtim.tv_sec ||
      now.st_mtim.tv_nsec != then.st_mtim.tv_nsec)
    throw ReadError(path + ": expected a file that stays as it is, got one that was written to while it was read");
}

}  // namespace vdb_offset::io
