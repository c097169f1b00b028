// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "gltf/gltf_document.h"
#include "gltf/json.h"

namespace vdb_offset::io::gltf {

/// Bytes in pieces; `owner` keeps them.
Pieces in_slices(std::string_view bytes, std::shared_ptr<const std::string> owner = {});
Pieces in_slices(std::string text);

/// Copies of the buffers that change, with the positions, normals and tangents of a moved mesh.
class PatchedBuffers {
 public:
  PatchedBuffers(const Contents& contents, const MovedMesh& moved);

  const std::map<std::size_t, std::shared_ptr<std::string>>& by_index() const { return buffers_; }
  /// The bounds of accessors that changed, in the file's JSON text: only those numbers that are others now.
  void add_bounds(std::string_view json, std::vector<Replacement>& replacements) const;

 private:
  void put_block(const Block& block, const MovedMesh& moved);
  bool put_normal(const Block& block, std::uint64_t i, const Vec3d& normal);
  void put(const Accessor& accessor, std::uint64_t i, const Vec3d& value);
  std::vector<float> bounds_of(const Accessor& accessor, bool most) const;

  std::map<std::size_t, std::shared_ptr<std::string>> buffers_;
  std::vector<Accessor> changed_;
};

/// The files that go with a file where it is written. None of those that the source names is ever replaced, unless the
/// source itself is written again.
class FilesBeside {
 public:
  FilesBeside(const Contents& contents, const std::string& source, const std::string& target);

  /// Adds a buffer with other bytes. Returns the URI that the file has to name it by, which is the buffer's own where
  /// the source is written again.
  std::string add_changed(const Buffer& buffer, std::string bytes, WrittenDocument& written);
  /// Adds a copy of a file that stays, as the target names it by the same relative path.
  /// \throw InvalidInput if another file is there
  void add_copy(const std::string& uri, WrittenDocument& written);

  /// Whether the target is in the source's folder.
  bool in_same_folder() const { return same_folder_; }

 private:
  /// Whether a file is there that is not the target's own from before.
  bool is_of_another(const std::filesystem::path& path) const;

  std::string source_, target_;
  bool in_place_, same_folder_;
  std::set<std::string> taken_;  ///< Absolute paths of files that the source is made of, or that are written.
};

}  // namespace vdb_offset::io::gltf
