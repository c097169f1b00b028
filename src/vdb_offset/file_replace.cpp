#include "vdb_offset/file_replace.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>

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

}  // namespace

void require_writable(const std::string& path) {
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
  Remover temporary{(target.parent_path() / (name + target.extension().string())).string()};
  write(temporary.path);
  if (std::filesystem::exists(status)) std::filesystem::permissions(temporary.path, status.permissions(), ignored);
  if (std::rename(temporary.path.c_str(), target.c_str()) != 0)
    throw WriteError(path + ": cannot be replaced: " + reason());
  temporary.path.clear();
}

void write_file(const std::string& path, const std::string& bytes, const std::function<void()>& before_rename) {
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
    if (before_rename) before_rename();
  });
}

}  // namespace vdb_offset
