#include "vdb_offset/wall_names.h"

#include <algorithm>
#include <set>

namespace vdb_offset {
namespace {

/// By hand, as <cctype> depends on the locale.
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

}  // namespace vdb_offset
