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

/// The models below a folder, sorted by path: files with one of the endings of meshes and curves, or, if there are
/// patterns, with a name that one of them matches. Goes through subfolders, but not through links to folders, nor into
/// `out`. \throw ReadError for a folder that cannot be read, InvalidInput if there is no model
std::vector<Model> find_models(const std::string& folder, const std::string& out,
                               std::span<const std::string> patterns);

}  // namespace vdb_offset::tool
