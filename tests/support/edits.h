// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "vdb_offset/numbers.h"

/// What tests change in files and meshes before they read or write them.

inline std::vector<vdb_offset::Vec3d> shifted(std::vector<vdb_offset::Vec3d> positions, const vdb_offset::Vec3d& by) {
  for (vdb_offset::Vec3d& p : positions) p += by;
  return positions;
}

/// The text with the first `from` replaced, which has to be there.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// The text with every `from` replaced, of which there may be none.
inline std::string replaced_everywhere(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}
