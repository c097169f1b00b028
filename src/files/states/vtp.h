// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "vdb_offset/polygons.h"

namespace vdb_offset::io {

/// Numbers of the points or cells of a file, under a name. Spans outlive it.
struct VtpArray {
  std::string name;
  std::variant<std::span<const float>, std::span<const std::uint8_t>, std::span<const std::uint32_t>> numbers;
};

/// Words that the numbers of an array stand for, from 0 on.
struct VtpWords {
  std::string name;
  std::vector<std::string> words;
};

/// A surface, or lines, with what a viewer can colour it by.
struct VtpData {
  PolygonView cells;  ///< Faces; of lines: the points that each runs through.
  bool are_lines = false;
  std::vector<VtpArray> of_points, of_cells;
  std::vector<VtpWords> words;
};

/// Writes VTK's XML of polygons: points in double precision, raw appended, not compressed. \throw WriteError
void write_vtp(const std::string& path, const VtpData& data);

}  // namespace vdb_offset::io
