#include "vdb_offset/file_replace.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <utility>

#include "vdb_offset/error.h"

namespace vdb_offset {
namespace {

struct Remover;
// For a signal handler, which may not do more than read it: the innermost one, as writing a file may end in writing
// another one.
std::atomic<const Remover*> last_remover = nullptr;

/// Removes the temporary file unless it was renamed away.
struct Remover {
  std::string path;
  const Remover* const outer;
  explicit Remover(std::string temporary) : path(std::move(temporary)), outer(last_remover) { last_remover = this; }
  Remover(const Remover&) = delete;
  Remover& operator=(const Remover&) = delete;
  ~Remover() {
    last_remover = outer;
    if (!path.empty()) ::unlink(path.c_str());
  }
  void release() {
    last_remover = outer;
    path.clear();
  }
};

struct Descriptor {
  int fd;
  ~Descriptor() { close(); }
  bool close() { return fd < 0 || ::close(std::exchange(fd, -1)) == 0; }
};

/// The file that a path names: a link stays a link, and what it points to is replaced.
std::filesystem::path resolved(const std::string& path) {
  std::error_code unknown;
  std::filesystem::path target = std::filesystem::weakly_canonical(path, unknown);
  if (unknown) target = path;
  if (std::filesystem::is_directory(target, unknown))
    throw WriteError(path + ": expected a file to write, got a folder");
  return target;
}

std::string reason() { return std::strerror(errno); }

void write_all(const std::string& path, int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw WriteError(path + ": cannot be written: " + reason());
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace

void require_writable(const std::string& path) {
  if (path == "-") return;
  const std::filesystem::path target = resolved(path);
  std::error_code ignored;
  const bool in_place = std::filesystem::exists(target, ignored) && !std::filesystem::is_regular_file(target, ignored);
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
  if (::access(in_place ? target.c_str() : folder.c_str(), in_place ? W_OK : W_OK | X_OK) != 0)
    throw WriteError(path + ": cannot be written: " + reason());
}

void replace_file(const std::string& path, const std::function<void(const std::string&)>& write) {
  const std::filesystem::path target = resolved(path);
  std::error_code ignored;
  const auto status = std::filesystem::status(target, ignored);
  // A device or a pipe cannot be replaced by a rename; it is written to as it is.
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return write(target.string());
  // The ending stays last: writers that choose a format by it must see the same one.
  const std::string name = fmt::format(".tmp-{}-{}", ::getpid(), std::hash<std::string>{}(target.string()) % 1000000);
  Remover temporary((target.parent_path() / (name + target.extension().string())).string());
  write(temporary.path);
  if (std::filesystem::exists(status)) std::filesystem::permissions(temporary.path, status.permissions(), ignored);
  if (std::rename(temporary.path.c_str(), target.c_str()) != 0)
    throw WriteError(path + ": cannot be replaced: " + reason());
  temporary.release();
}

void write_file(const std::string& path, const std::function<void(const Sink&)>& produce,
                const std::function<void()>& before_rename) {
  if (path == "-") {
    produce([](std::string_view bytes) { write_all("standard output", STDOUT_FILENO, bytes); });
    if (before_rename) before_rename();
    return;
  }
  replace_file(path, [&](const std::string& temporary) {
    Descriptor file{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
    if (file.fd < 0) throw WriteError(path + ": cannot be written: " + reason());
    produce([&](std::string_view bytes) { write_all(path, file.fd, bytes); });
    if (!file.close()) throw WriteError(path + ": cannot be written: " + reason());
    if (before_rename) before_rename();
  });
}

void write_file(const std::string& path, std::string_view bytes, const std::function<void()>& before_rename) {
  write_file(
      path, [&](const Sink& sink) { sink(bytes); }, before_rename);
}

void remove_temporary_file() noexcept {
  for (const Remover* remover = last_remover; remover; remover = remover->outer) ::unlink(remover->path.c_str());
}

}  // namespace vdb_offset
