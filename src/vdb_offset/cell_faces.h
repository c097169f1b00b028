#pragma once

#include <cstdint>
#include <span>

#include "vdb_offset/volume_mesh.h"

namespace vdb_offset {

/// How cells other than polyhedra are built: over a base of `base` corners stand as many more, or a single apex.
struct CellShape {
  std::uint32_t base;
  bool apex;
};
constexpr CellShape shape_of(CellType type) {
  return {type == CellType::Tetrahedron || type == CellType::Prism ? 3u : 4u,
          type == CellType::Tetrahedron || type == CellType::Pyramid};
}

/// Calls visit(std::span<const std::uint32_t>) with the corners of each face of a cell, ccw seen from outside.
template <class Visit>
void for_each_cell_face(CellType type, std::span<const std::uint32_t> cell, Visit&& visit) {
  using Face = std::span<const std::uint32_t>;
  if (type == CellType::Polyhedron) {
    for (std::size_t at = 1; at < cell.size(); at += cell[at] + 1) visit(cell.subspan(at + 1, cell[at]));
    return;
  }
  const auto [n, apex] = shape_of(type);
  std::uint32_t base[4];
  for (std::uint32_t k = 0; k < n; ++k) base[k] = cell[(n - k) % n];
  visit(Face(base, n));
  if (!apex) visit(cell.subspan(n, n));
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    const std::uint32_t side[4] = {cell[k], cell[next], cell[apex ? n : n + next], apex ? 0 : cell[n + k]};
    visit(Face(side, apex ? 3 : 4));
  }
}

}  // namespace vdb_offset
