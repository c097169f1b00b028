// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include "ground/numbers/rounding.h"
#include "products/volume/cell_quality.h"
#include "support/curve_oracles.h"
#include "support/folder.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"

namespace vdb_offset::test::grown_curves {

struct GrownCurves {
  LayersResult layers;
  CurveCells cells;
  LayerReport report;
};

inline GrownCurves grow(const Curves& curves, std::vector<Distances> heights) {
  GrownCurves grown;
  grown.layers = grow_curve_layers(curves.view(), heights, {});
  grown.cells = make_curve_cells(curves.view(), grown.layers);
  grown.report = report_layers(grown.cells.segments.view(), grown.layers, {}, grown.cells.facts,
                               measure_curve_cells(grown.cells, grown.layers));
  return grown;
}

inline std::vector<Distances> rising(double total, int count) {
  std::vector<Distances> heights;
  for (int k = 1; k <= count; ++k) heights.emplace_back(total * k * (k + 1) / (count * (count + 1)));
  return heights;
}

/// What the report says is so by brute force: heights are exact by their shares, all cells turn the right way and fill
/// what the boundary encloses, and the boundary does not cross itself unless the curves do.
inline void check_layers(const Curves& curves, const GrownCurves& grown) {
  const LayersResult& layers = grown.layers;
  const double rounding = 1e-12 * layers.statistics.facts.diagonal;
  for (std::size_t p = 0; p < curves.positions.size(); ++p)
    for (std::size_t k = 0; k < layers.count(); ++k) {
      const double target = layers.share[p] * std::abs(layers.heights[k][p]);
      if (layers.share[p] < 1 && k + 1 == layers.count()) continue;  // may have come to rest a little beside
      CHECK(distance_to(curves, layers.stacks.of(p)[k + 1]) == Approx(target).epsilon(1e-6).margin(rounding));
    }
  const VolumeMesh& mesh = grown.cells.mesh;
  double sum = 0;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    CHECK(scaled_jacobian(mesh, c) > 0);
    sum += cell_volume(mesh, c);
  }
  CHECK(sum == Approx(grown.report.volume).epsilon(1e-9));
  CHECK(grown.report.all.inverted_cells == 0);
  CHECK(layers.statistics.limit.left.total() == 0);
  if (!meeting(curves, curves.positions).empty()) return;
  CHECK(new_crossings(curves, layers.stacks.surface(layers.count())) == 0);
  Curves boundary;
  boundary.positions = mesh.points;
  for (const BoundaryPatch& patch : mesh.patches)
    for (std::size_t f = 0; f < patch.face_count(); ++f) boundary.add_face({patch.face(f)[0], patch.face(f)[1]});
  CHECK(meeting(boundary, boundary.positions).empty());
}

}  // namespace vdb_offset::test::grown_curves
