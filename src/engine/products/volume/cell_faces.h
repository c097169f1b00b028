// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "vdb_offset/cells.h"

namespace vdb_offset {

/// A face of a cell: the numbers of its corners among the cell's corners, ccw seen from outside.
struct LocalFace {
  std::uint8_t size;
  std::uint8_t local_corners[4];
};
/// The faces of a type of cells.
struct LocalFaces {
  std::uint8_t count;
  LocalFace faces[6];
};

/// The faces of cells other than polyhedra, by CellType.
inline constexpr LocalFaces kCellFaces[kCellTypeCount] = {
    {4, {{3, {0, 2, 1}}, {3, {0, 1, 3}}, {3, {1, 2, 3}}, {3, {2, 0, 3}}}},
    {5, {{4, {0, 3, 2, 1}}, {3, {0, 1, 4}}, {3, {1, 2, 4}}, {3, {2, 3, 4}}, {3, {3, 0, 4}}}},
    {5, {{3, {0, 2, 1}}, {3, {3, 4, 5}}, {4, {0, 1, 4, 3}}, {4, {1, 2, 5, 4}}, {4, {2, 0, 3, 5}}}},
    {6,
     {{4, {0, 3, 2, 1}},
      {4, {4, 5, 6, 7}},
      {4, {0, 1, 5, 4}},
      {4, {1, 2, 6, 5}},
      {4, {2, 3, 7, 6}},
      {4, {3, 0, 4, 7}}}},
    {0, {}},
    {3, {{2, {0, 1}}, {2, {1, 2}}, {2, {2, 0}}}},
    {4, {{2, {0, 1}}, {2, {1, 2}}, {2, {2, 3}}, {2, {3, 0}}}}};

/// Calls visit(std::span<const std::uint32_t>) with the corners of each face of a cell, ccw seen from outside.
template <class Visit>
void for_each_cell_face(CellType type, std::span<const std::uint32_t> cell, Visit&& visit) {
  if (type == CellType::Polyhedron) {
    for (std::size_t at = 1; at < cell.size(); at += cell[at] + 1) visit(cell.subspan(at + 1, cell[at]));
    return;
  }
  const LocalFaces& faces = kCellFaces[static_cast<std::size_t>(type)];
  for (std::size_t f = 0; f < faces.count; ++f) {
    std::uint32_t corners[4];
    for (std::size_t k = 0; k < faces.faces[f].size; ++k) corners[k] = cell[faces.faces[f].local_corners[k]];
    visit(std::span<const std::uint32_t>(corners, faces.faces[f].size));
  }
}

}  // namespace vdb_offset
