// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "products/volume/cell_quality.h"
#include "products/volume/volume_faces.h"
#include "vdb_offset/fill.h"
#include "vdb_offset/layers.h"

/// Layers that are filled up, and what such meshes have to be.
namespace vdb_offset::test {

/// Fills a domain that all of can be seen from its middle.
inline FilledDomain fill_from_middle(const FillDomain& domain) {
  FilledDomain filled;
  filled.added.emplace_back(0.0);
  const auto middle = static_cast<std::uint32_t>(domain.points.size());
  for (const auto& [a, b, c] : domain.triangles) filled.cells.push_back({a, c, b, middle});
  return filled;
}

/// Layers on a mesh, and what fills the rest.
struct Filled {
  LayersResult layers;
  VolumeMesh mesh;
  FillReport report;
};

inline Filled fill(const Polygons& wall, double thickness, const Filler& filler, FillOptions options = {},
                   const std::vector<std::uint8_t>& only = {}) {
  Filled made;
  OffsetOptions how;
  how.only = only;
  how.border = Border::Free;
  made.layers = grow_layers(wall.view(), std::vector<Distances>{thickness / 2, thickness}, how);
  LayerCellFacts facts;
  VolumeMesh cells = make_cells(wall.view(), made.layers, {}, &facts);
  made.mesh = fill_volume(wall.view(), made.layers, facts, {}, std::move(cells), options, filler, &made.report);
  return made;
}

inline const BoundaryPatch* patch_of(const VolumeMesh& mesh, const std::string& name) {
  const auto found = std::ranges::find(mesh.patches, name, &BoundaryPatch::name);
  return found == mesh.patches.end() ? nullptr : &*found;
}

/// Requires all faces to match, and the cells to have the volume that the boundary encloses.
inline void require_mesh(const VolumeMesh& mesh, double volume) {
  CHECK_NOTHROW(VolumeFaces(mesh));
  CHECK(enclosed_volume(mesh) == Approx(volume).epsilon(1e-12));
  double sum = 0, least = 1;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    sum += cell_volume(mesh, c);
    least = std::min(least, cell_volume(mesh, c));
  }
  CHECK(sum == Approx(volume).epsilon(1e-9));
  CHECK(least > 0);
  for (const VolumeField& field : mesh.cell_fields) CHECK(field.values.size() == mesh.cell_count());
  for (const VolumeField& field : mesh.point_fields) CHECK(field.values.size() == mesh.points.size());
}

}  // namespace vdb_offset::test
