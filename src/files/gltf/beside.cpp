// SPDX-License-Identifier: Apache-2.0
#include "gltf/rewriting.h"

#include <fmt/format.h>

#include <filesystem>

#include "bytes/compression.h"
#include "gltf/uri.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io::gltf {
namespace {

namespace fs = std::filesystem;

std::string whole_path(const fs::path& path) {
  std::error_code error;
  const fs::path found = fs::weakly_canonical(path, error);
  return (error ? fs::absolute(path) : found).string();
}

bool leaves_folder(const std::string& path) {
  const std::string normal = fs::path(path).lexically_normal().string();
  return normal == ".." || normal.starts_with("../");
}

}  // namespace

FilesBeside::FilesBeside(const Contents& contents, const std::string& source, const std::string& target)
    : source_(source), target_(target) {
  const auto folder_of = [](const std::string& path) { return whole_path(fs::path(whole_path(path)).parent_path()); };
  in_place_ = whole_path(source) == whole_path(target);
  same_folder_ = folder_of(source) == folder_of(target);
  taken_.insert(whole_path(source));
  taken_.insert(whole_path(target));
  for (const Buffer& buffer : contents.buffers)
    if (buffer.in == Buffer::In::File) taken_.insert(whole_path(buffer.path));
  for (const std::string& uri : contents.image_uris)
    if (const auto path = relative_path(uri); path && !is_data_uri(uri))
      taken_.insert(whole_path(fs::path(source).parent_path() / *path));
}

std::string FilesBeside::add_changed(const Buffer& buffer, std::string bytes, WrittenDocument& written) {
  if (target_ == "-")
    throw InvalidInput(fmt::format("{}: expected a file to write to, as its data are in {}, got standard output",
                                   source_, buffer.path));
  // What follows the buffer's own bytes in its file stays.
  bytes += buffer.file.view().substr(buffer.bytes.size());
  if (in_place_) {
    written.beside.push_back({buffer.path, std::move(bytes)});
    return buffer.uri;
  }
  // out.bin for out.gltf; what follows has the whole name in its own, so that no other output's is the same.
  const std::string whole = fs::path(target_).filename().string();
  const bool is_packed = without_compression(target_) != target_;
  for (std::size_t number = is_packed ? 1 : 0;; ++number) {
    const std::string name =
        number == 0 ? fs::path(target_).stem().string() + ".bin" : fmt::format("{}_{}.bin", whole, number);
    const fs::path path = fs::path(target_).parent_path() / name;
    if (!taken_.insert(whole_path(path)).second || is_of_another(path)) continue;
    written.beside.push_back({path.string(), std::move(bytes)});
    return as_uri(name);
  }
}

bool FilesBeside::is_of_another(const fs::path& path) const {
  std::error_code error;
  if (!fs::exists(path, error)) return false;
  if (!fs::is_regular_file(target_, error)) return true;
  // What the target was before names it, as a file that this program wrote would.
  return FileBytes::open(target_).view().find('"' + as_uri(path.filename().string()) + '"') == std::string_view::npos;
}

void FilesBeside::add_copy(const std::string& uri, WrittenDocument& written) {
  const std::optional<std::string> path = relative_path(uri);
  if (!path || target_ == "-") return;
  const fs::path from = fs::path(source_).parent_path() / *path, to = fs::path(target_).parent_path() / *path;
  std::error_code error;
  if (!fs::is_regular_file(from, error) || whole_path(from) == whole_path(to)) return;
  if (leaves_folder(*path)) {
    written.lost.push_back(fmt::format("{}, which is not below the file's folder and was not copied", *path));
    return;
  }
  std::string bytes(FileBytes::open(from.string()).view());
  if (fs::exists(to, error)) {
    if (fs::is_regular_file(to, error) && FileBytes::open(to.string()).view() == bytes) return;
    throw InvalidInput(fmt::format("{}: expected no other file at {}, where a copy of {} has to be", target_,
                                   to.string(), from.string()));
  }
  if (taken_.insert(whole_path(to)).second) written.beside.push_back({to.string(), std::move(bytes)});
}

}  // namespace vdb_offset::io::gltf
