// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/output_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include "ground/system/call_progress.h"
#include "ground/system/temporary.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

thread_local OutputFiles* innermost = nullptr;

struct Descriptor {
  int fd;
  ~Descriptor() { close(); }
  bool close() { return fd < 0 || ::close(std::exchange(fd, -1)) == 0; }
};

std::string reason() { return std::strerror(errno); }

bool are_same(const std::string& path, const std::string& other) {
  std::ifstream one(path, std::ios::binary), two(other, std::ios::binary);
  using Bytes = std::istreambuf_iterator<char>;
  return std::equal(Bytes(one), Bytes(), Bytes(two), Bytes());
}

/// Whether a file is written where it is, since it cannot be replaced by a rename: a device or a pipe.
bool is_written_in_place(const std::filesystem::path& target) {
  std::error_code ignored;
  const auto status = std::filesystem::status(target, ignored);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

/// The file that a path leads to. \throw WriteError for a folder
std::filesystem::path file_to_write(const std::string& path) {
  std::filesystem::path target = replaced_path(path);
  std::error_code unknown;
  if (std::filesystem::is_directory(target, unknown))
    throw WriteError(path + ": expected a file to write, got a folder");
  return target;
}

void write_all(const std::string& path, int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw WriteError(path + ": cannot be written: " + reason());
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace

struct OutputFiles::File {
  Temporary temporary;
  std::filesystem::path target;
  std::string path;
  bool was_there = false;   // a file that was at the target has the temporary name once the new one is in place
  bool can_go_back = true;  // false where the file system cannot exchange two files
};

std::filesystem::path replaced_path(const std::string& path) {
  constexpr int kMostLinks = 40;  // links in a row: Linux follows no more than this
  std::error_code failed;
  std::filesystem::path target = std::filesystem::absolute(path, failed);
  const auto leads_nowhere = [&] {
    return !std::filesystem::exists(target, failed) &&
           std::filesystem::is_symlink(std::filesystem::symlink_status(target, failed));
  };
  for (int i = 0; i < kMostLinks && leads_nowhere(); ++i)
    target = target.parent_path() / std::filesystem::read_symlink(target, failed);
  const std::filesystem::path whole = std::filesystem::weakly_canonical(target, failed);
  return failed ? std::filesystem::path(path) : whole;
}

OutputFiles::OutputFiles(Sync sync) : outer_(innermost), sync_(sync) { innermost = this; }

OutputFiles::~OutputFiles() {
  innermost = outer_;
  files_.clear();
  while (!folders_.empty()) folders_.pop_back();  // inner folders first: a folder can only be removed once it is empty
}

void OutputFiles::report_to(ProgressCallback progress, std::size_t files) {
  progress_ = std::move(progress);
  expected_files_ = std::max<std::size_t>(files, 1);
}

ProgressCallback OutputFiles::progress_of_next() {
  OutputFiles* asked = innermost;
  while (asked && !asked->progress_) asked = asked->outer_;
  if (!asked) return {};
  const std::size_t next = std::min(asked->begun_files_++, asked->expected_files_ - 1);
  const auto files = static_cast<double>(asked->expected_files_);
  return part_of(asked->progress_, static_cast<double>(next) / files, static_cast<double>(next + 1) / files);
}

const std::string& OutputFiles::add_file(const std::filesystem::path& target, const std::string& path) {
  const std::filesystem::path folder = target.parent_path();
  if (std::none_of(files_.begin(), files_.end(), [&](const File& f) { return f.target.parent_path() == folder; }))
    remove_stale_temporaries(folder);
  files_.push_back({new_temporary_file(target, path), target, path});
  return files_.back().temporary.path();
}

void OutputFiles::add_folders(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> missing;
  std::error_code failed;
  for (auto path = folder; !path.empty() && !std::filesystem::exists(path, failed); path = path.parent_path())
    missing.push_back(path);
  for (auto path = missing.rbegin(); path != missing.rend(); ++path) {
    // It is known before it is there, so that a signal that comes right after finds it.
    folders_.emplace_back(path->string(), Temporary::Kind::Folder);
    if (std::filesystem::create_directory(*path, failed)) continue;
    folders_.back().keep();  // what has that name already was not made here, and must not be removed
    folders_.pop_back();
    if (failed) throw WriteError(folder.string() + ": cannot be made: " + failed.message());
  }
}

void OutputFiles::commit(const std::function<void()>& when_in_place) {
  if (outer_) {
    std::move(files_.begin(), files_.end(), std::back_inserter(outer_->files_));
    std::move(folders_.begin(), folders_.end(), std::back_inserter(outer_->folders_));
  } else {
    require_one_each();
    for (File& file : files_) finish(file);
    const PuttingInPlace now;
    std::size_t done = 0;
    try {
      for (; done < files_.size(); ++done) put_in_place(files_[done]);
    } catch (const WriteError&) {
      while (done > 0) put_back(files_[--done]);
      throw;
    }
    for (File& file : files_)
      if (!file.was_there || !file.can_go_back) file.temporary.keep();
    for (Temporary& folder : folders_) folder.keep();
    if (when_in_place) when_in_place();
  }
  files_.clear();  // this removes the replaced files, which have the temporary names now
  folders_.clear();
}

/// Of several files for one target all but one go: those of an image that several outputs name are the same. \throw
/// WriteError if they differ
void OutputFiles::require_one_each() {
  std::vector<File> one_each;
  for (File& file : files_) {
    const auto other =
        std::find_if(one_each.begin(), one_each.end(), [&](const File& f) { return f.target == file.target; });
    if (other == one_each.end()) one_each.push_back(std::move(file));
    else if (!are_same(other->temporary.path(), file.temporary.path()))
      throw WriteError(file.path + ": expected a file of its own, got one that this run writes something else to, too");
  }
  files_ = std::move(one_each);
}

/// Gives a file the permissions of the one that it replaces and, if asked, waits until it is on the disk. It keeps its
/// temporary name.
void OutputFiles::finish(File& file) const {
  const Descriptor written{::open(file.temporary.path().c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC)};
  struct stat before {};
  // A umask may leave the owner no right to read the new file. The file is complete even so; only syncing is skipped.
  if (written.fd < 0 && errno != EACCES) throw WriteError(file.path + ": cannot be written: " + reason());
  file.was_there = ::stat(file.target.c_str(), &before) == 0;
  if (file.was_there && ::fchmod(written.fd, before.st_mode & 07777) != 0) {
    // Not an error: not every file system has permissions.
  }
  if (sync_ == Sync::Yes && ::fsync(written.fd) != 0 && errno != EINVAL && errno != EBADF)
    throw WriteError(file.path + ": cannot be written: " + reason());
}

void OutputFiles::put_in_place(File& file) const {
  const char *const from = file.temporary.path().c_str(), *const to = file.target.c_str();
  file.can_go_back = true;
  if (file.was_there) {
    struct stat now {};
    if (::stat(to, &now) == 0 && S_ISDIR(now.st_mode)) errno = EISDIR;
    else if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_EXCHANGE) == 0) return;
    else if (errno == EINVAL || errno == ENOSYS || errno == ENOTSUP || errno == ENOENT) {
      file.can_go_back = false;
      if (std::rename(from, to) == 0) return;
    }
  } else if (std::rename(from, to) == 0) {
    return;
  }
  throw WriteError(file.path + ": cannot be replaced: " + reason());
}

void OutputFiles::put_back(File& file) {
  const char *const temporary = file.temporary.path().c_str(), *const target = file.target.c_str();
  if (!file.was_there) ::unlink(target);
  else if (file.can_go_back) ::renameat2(AT_FDCWD, temporary, AT_FDCWD, target, RENAME_EXCHANGE);
}

void require_writable(const std::string& path) {
  if (path == "-") return;
  const std::filesystem::path target = file_to_write(path);
  struct stat is {};
  const bool missing = ::stat(target.c_str(), &is) != 0;
  if (missing && errno != ENOENT) throw WriteError(path + ": cannot be written: " + reason());
  const bool in_place = !missing && !S_ISREG(is.st_mode);
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
  if (::access(in_place ? target.c_str() : folder.c_str(), in_place ? W_OK : W_OK | X_OK) != 0)
    throw WriteError(path + ": cannot be written: " + reason());
}

void replace_file(const std::string& path, const std::function<void(const std::string&)>& write) {
  const std::filesystem::path target = file_to_write(path);
  if (is_written_in_place(target)) return write(target.string());
  OutputFiles files;
  write(files.add_file(target, path));
  files.commit();
}

void write_file(const std::string& path, const std::function<void(const Sink&)>& produce) {
  if (path == "-") return produce([](std::string_view bytes) { write_all("standard output", STDOUT_FILENO, bytes); });
  replace_file(path, [&](const std::string& temporary) {
    const int links = is_written_in_place(temporary) ? 0 : O_NOFOLLOW;  // /dev/stdout is a link
    Descriptor file{::open(temporary.c_str(), O_WRONLY | O_TRUNC | links | O_CLOEXEC)};
    if (file.fd < 0) throw WriteError(path + ": cannot be written: " + reason());
    produce([&](std::string_view bytes) { write_all(path, file.fd, bytes); });
    if (!file.close()) throw WriteError(path + ": cannot be written: " + reason());
  });
}

void write_file(const std::string& path, std::string_view bytes) {
  write_file(path, [&](const Sink& sink) { sink(bytes); });
}

}  // namespace vdb_offset
