// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>

#include "vdb_offset/io/volume_file.h"
#include "volume/volume_writers.h"

// What the writers of several libraries need: apart from all else, as modules have copies of it.
namespace vdb_offset::io {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

std::string as_word(const std::string& name) {
  std::string word = name;
  for (char& c : word)
    if (!is_letter(c) && !(c >= '0' && c <= '9') && c != '-' && c != '+' && c != '.') c = '_';
  return word.empty() || !is_letter(word.front()) ? "_" + word : word;
}

}  // namespace

bool is_patch_word(const std::string& name) { return name.size() <= kLongestWord && as_word(name) == name; }

bool has_polyhedra(const VolumeMesh& mesh) {
  return std::find(mesh.cell_types.begin(), mesh.cell_types.end(), CellType::Polyhedron) != mesh.cell_types.end();
}

std::vector<std::string> distinct_words(std::span<const std::string> words, std::size_t longest) {
  std::vector<std::string> distinct;
  std::unordered_set<std::string> known;
  for (const std::string& start : words) {
    std::string word = start.substr(0, longest);
    for (int n = 2; !known.insert(word).second; ++n) {
      const std::string number = fmt::format("_{}", n);
      word = start.substr(0, longest - number.size()) + number;
    }
    distinct.push_back(word);
  }
  return distinct;
}

std::vector<std::string> patch_words(const VolumeMesh& mesh, std::size_t longest) {
  std::vector<std::string> words;
  for (const BoundaryPatch& patch : mesh.patches) words.push_back(as_word(patch.name));
  return distinct_words(words, longest);
}

}  // namespace vdb_offset::io
