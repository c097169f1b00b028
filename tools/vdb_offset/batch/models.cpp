// SPDX-License-Identifier: Apache-2.0
#include "batch/models.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "file_plan.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

namespace fs = std::filesystem;

// Of meshes and curves. Not .txt and .json: most such files in a folder of models are notes and reports;
// nor what cannot be written, as outputs have the endings of models by default.
constexpr std::string_view kEndings[] = {".obj", ".ply",  ".stl", ".off",  ".3mf", ".glb", ".gltf", ".vtp", ".vtk",
                                         ".vtu", ".step", ".stp", ".brep", ".svg", ".dxf", ".dat",  ".xy"};

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

bool has_ending_of_model(const std::string& name) {
  std::string ending = lower(name.substr(ending_of(name)));
  for (const std::string_view packed : {".gz", ".zst"})
    if (ending.ends_with(packed)) ending.resize(ending.size() - packed.size());
  return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings);
}

bool is_selected(const std::string& path, std::span<const std::string> patterns) {
  const std::string name = path.substr(path.rfind('/') + 1);
  // (Macs put a file of their own, ._NAME, beside each.)
  if (patterns.empty()) return has_ending_of_model(name) && !name.starts_with("._");
  return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
    const bool of_path = pattern.find('/') != std::string::npos;
    return ::fnmatch(pattern.c_str(), (of_path ? path : name).c_str(), 0) == 0;
  });
}

void go_through(const fs::path& folder, const std::string& below, const fs::path& out,
                std::span<const std::string> patterns, FoundModels& found) {
  std::error_code failed;
  fs::directory_iterator entries(folder, failed);
  if (failed) {
    found.unreadable.push_back(fmt::format("{}: {}", folder.string(), failed.message()));
    return;
  }
  for (const fs::directory_entry& entry : entries) {
    const std::string path = below + entry.path().filename().string();
    std::error_code unknown;
    if (!entry.is_symlink(unknown) && entry.is_directory(unknown)) {
      if (entry.path() != out && entry.path().filename() != kStateFolder)
        go_through(entry.path(), path + "/", out, patterns, found);
    } else if (entry.is_regular_file(unknown) && is_selected(path, patterns)) {
      found.models.push_back({path, ending_of(path)});
    }
  }
}

}  // namespace

FoundModels find_models(const std::string& folder, const std::string& out, std::span<const std::string> patterns) {
  FoundModels found;
  go_through(folder, "", out, patterns, found);
  if (found.models.empty())
    throw InvalidInput(fmt::format("{}: expected a model ({}), got none{}", folder,
                                   patterns.empty() ? fmt::format("{}", fmt::join(kEndings, " "))
                                                    : fmt::format("--models {}", fmt::join(patterns, " ")),
                                   found.unreadable.empty() ? "" : "; " + found.unreadable.front()));
  std::sort(found.models.begin(), found.models.end(), [](const Model& a, const Model& b) { return a.path < b.path; });
  return found;
}

}  // namespace vdb_offset::tool
