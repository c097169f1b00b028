// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/cells.h"

#include "vdb_offset/run.h"

#include <algorithm>
#include <set>

namespace vdb_offset {
namespace {

/// Whether a byte is an ASCII letter. Not by <cctype>, which depends on the locale.
bool is_ascii_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_word_character(char c) {
  return is_ascii_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

std::string cleaned(std::string name) {
  if (name.empty()) return "wall";
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !is_word_character(c); }, '_');
  return is_ascii_letter(name[0]) ? name : "wall_" + name;
}

}  // namespace

void require_names(const WallNames& walls, std::size_t faces) {
  if (walls.of_face.empty()) return;
  if (walls.of_face.size() != faces)
    throw InvalidInput("layers: expected " + std::to_string(faces) + " names of faces, got " +
                       std::to_string(walls.of_face.size()));
  for (const std::uint32_t name : walls.of_face)
    if (name >= walls.names.size())
      throw InvalidInput("layers: expected names below " + std::to_string(walls.names.size()) + ", got " +
                         std::to_string(name));
}

std::vector<std::string> patch_names(const WallNames& walls) {
  if (walls.of_face.empty()) return {"wall"};
  std::set<std::string> taken = {"outer", "sides"};
  std::vector<std::string> names;
  for (const std::string& wall : walls.names) {
    const std::string first = cleaned(wall);
    std::string name = first;
    for (std::size_t n = 2; !taken.insert(name).second; ++n) name = first + "_" + std::to_string(n);
    names.push_back(name);
  }
  return names;
}

WallNames names_of_pieces(WallNames walls, const Refinement& refinement) {
  if (walls.of_face.empty()) return walls;
  std::vector<std::uint32_t> of_face;
  of_face.reserve(refinement.parent.size());
  for (const std::uint32_t parent : refinement.parent) of_face.push_back(walls.of_face[parent]);
  walls.of_face = std::move(of_face);
  return walls;
}

}  // namespace vdb_offset
