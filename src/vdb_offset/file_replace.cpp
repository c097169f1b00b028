#include "vdb_offset/file_replace.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "vdb_offset/error.h"

namespace vdb_offset {
namespace {

/// Removes the temporary file unless it was renamed away.
struct Remover {
  std::string path;
  ~Remover() {
    if (!path.empty()) ::unlink(path.c_str());
  }
};

std::string reason() { return std::strerror(errno); }

}  // namespace

void require_writable(const std::string& path) {
  const std::filesystem::path target(path);
  if (std::filesystem::is_directory(target)) throw WriteError(path + ": expected a file to write, got a folder");
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) throw WriteError(path + ": cannot be written: " + reason());
}

void replace_file(const std::string& path, const std::function<void(const std::string&)>& write) {
  const std::filesystem::path target(path);
  if (std::filesystem::is_directory(target)) throw WriteError(path + ": expected a file to write, got a folder");
  // A device or a pipe cannot be replaced by a rename; it is written to as it is.
  std::error_code ignored;
  if (std::filesystem::exists(target, ignored) && !std::filesystem::is_regular_file(target, ignored))
    return write(path);
  // The ending stays last: writers that choose a format by it must see the same one.
  const std::string name = fmt::format(".tmp-{}-{}", ::getpid(), target.filename().string());
  Remover temporary{(target.parent_path() / name).string()};
  write(temporary.path);
  if (std::rename(temporary.path.c_str(), path.c_str()) != 0)
    throw WriteError(path + ": cannot be replaced: " + reason());
  temporary.path.clear();
}

void write_file(const std::string& path, const std::string& bytes) {
  replace_file(path, [&](const std::string& temporary) {
    const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) throw WriteError(path + ": cannot be written: " + reason());
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t count = ::write(file, bytes.data() + at, bytes.size() - at);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) {
        const std::string why = reason();
        ::close(file);
        throw WriteError(fmt::format("{}: cannot be written: {}", path, why));
      }
      at += static_cast<std::size_t>(count);
    }
    if (::close(file) != 0) throw WriteError(path + ": cannot be written: " + reason());
  });
}

}  // namespace vdb_offset
