// SPDX-License-Identifier: Apache-2.0
#include "batch/models.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "outputs.h"
#include "vdb_offset/error.h"

namespace vdb_offset::tool {
namespace {

namespace fs = std::filesystem;

// Of meshes and curves. Not .txt and .json: most such files in a folder of models are notes and reports.
constexpr std::string_view kEndings[] = {".obj", ".ply", ".stl", ".off", ".svg", ".dat", ".xy"};

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
  if (patterns.empty()) return has_ending_of_model(name);
  return std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
    const bool of_path = pattern.find('/') != std::string::npos;
    return ::fnmatch(pattern.c_str(), (of_path ? path : name).c_str(), 0) == 0;
  });
}

void go_through(const fs::path& folder, const std::string& below, const fs::path& out,
                std::span<const std::string> patterns, std::vector<Model>& models) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string path = below + entry.path().filename().string();
    if (entry.is_directory()) {
      if (!entry.is_symlink() && entry.path() != out) go_through(entry.path(), path + "/", out, patterns, models);
    } else if (entry.is_regular_file() && is_selected(path, patterns)) {
      models.push_back({path, ending_of(path)});
    }
  }
}

}  // namespace

std::vector<Model> find_models(const std::string& folder, const std::string& out,
                               std::span<const std::string> patterns) {
  std::vector<Model> models;
  try {
    go_through(folder, "", out, patterns, models);
  } catch (const fs::filesystem_error& error) {
    throw ReadError(
        fmt::format("{}: expected a folder that can be read, got: {}", error.path1().string(), error.code().message()));
  }
  if (models.empty())
    throw InvalidInput(fmt::format("{}: expected a model ({}), got none", folder,
                                   patterns.empty() ? fmt::format("{}", fmt::join(kEndings, " "))
                                                    : fmt::format("--models {}", fmt::join(patterns, " "))));
  std::sort(models.begin(), models.end(), [](const Model& a, const Model& b) { return a.path < b.path; });
  return models;
}

}  // namespace vdb_offset::tool
