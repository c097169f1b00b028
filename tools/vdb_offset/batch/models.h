// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

namespace vdb_offset::tool {

/// A model of a batch. Names are bytes, whatever they mean.
struct Model {
  std::string path;    ///< Below the folder of models.
  std::size_t ending;  ///< Where its ending begins in the path, that of `.obj.gz` before `.obj`.
};

/// The name of the folder in OUT in which a batch keeps what it knows of its models.
inline constexpr const char* kStateFolder = ".batch";

struct FoundModels {
  std::vector<Model> models;
  std::vector<std::string> unreadable;  ///< Folders that were left out, and why.
};

/// The models below a folder, sorted by path: files with one of the endings of meshes and curves, or, if there are
/// patterns, with a name that one of them matches. Goes through subfolders, but not through links to folders, nor into
/// `out` and what other batches know. \throw InvalidInput if there is no model
FoundModels find_models(const std::string& folder, const std::string& out, std::span<const std::string> patterns);

}  // namespace vdb_offset::tool
