// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <catch2/catch.hpp>
#include <numbers>
#include "products/volume/foam_measures.h"
#include "support/volume_meshes.h"

namespace vdb_offset::test::cell_rows {

/// Hexahedra in a row along x, a unit high and deep; `across` is how far their faces at x = 0, 1, 2 ... are moved in y.
inline VolumeMesh row_of_cells(const std::vector<double>& across) {
  VolumeMesh mesh;
  const auto cells = static_cast<std::uint32_t>(across.size() - 1);
  for (std::size_t i = 0; i < across.size(); ++i)
    for (const auto& [y, z] : {std::pair(0., 0.), {1., 0.}, {1., 1.}, {0., 1.}})
      mesh.points.emplace_back(double(i), across[i] + y, z);
  BoundaryPatch patch{"all", BoundaryPatch::Kind::Wall, {}, {0}, {}};
  const auto add = [&](const CornerList& face, std::uint32_t c) {
    patch.corners.insert(patch.corners.end(), face.begin(), face.end());
    patch.face_begin.push_back(static_cast<std::uint32_t>(patch.corners.size()));
    patch.cell.push_back(c);
  };
  for (std::uint32_t c = 0; c < cells; ++c) {
    const std::uint32_t a = 4 * c, b = a + 4;
    add_cell(mesh, CellType::Hexahedron, {a, a + 1, a + 2, a + 3, b, b + 1, b + 2, b + 3});
    for (std::uint32_t k = 0; k < 4; ++k) add({a + k, a + (k + 1) % 4, b + (k + 1) % 4, b + k}, c);
  }
  add({0, 3, 2, 1}, 0);
  add({4 * cells, 4 * cells + 1, 4 * cells + 2, 4 * cells + 3}, cells - 1);
  mesh.patches = {patch};
  return mesh;
}

inline FoamQuality quality_of(const VolumeMesh& mesh) { return measure_foam(mesh, VolumeFaces(mesh)); }

}  // namespace vdb_offset::test::cell_rows
