// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "products/layers/column_cells.h"

namespace vdb_offset {

/// The cells of one column as a mesh of their own, one layer after the other. Points are numbered within the column:
/// those of the wall first, in the order of the ring's numbers, so that faces that are not flat are split as in the
/// whole mesh (see cell_volume()).
class ColumnMesh {
 public:
  /// Starts a column. `flat(k)` is whether corner k rises in no layer.
  template <class Flat>
  void begin(std::span<const std::uint32_t> ring, Flat&& flat) {
    const auto corners = static_cast<std::uint32_t>(ring.size());
    ring_.resize(corners);
    by_number_.resize(corners);
    std::iota(by_number_.begin(), by_number_.end(), 0);
    std::sort(by_number_.begin(), by_number_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return ring[a] < ring[b]; });
    points_.vertex.resize(corners);
    points_.in_layer.assign(corners, kNone);
    points_.rising.clear();
    for (std::uint32_t p = 0; p < corners; ++p) {
      ring_[by_number_[p]] = p;
      if (flat(by_number_[p])) continue;
      points_.in_layer[p] = points_.risen();
      points_.rising.push_back(p);
    }
    make_cells();
  }

  /// The cells in one layer. `stack(k)` are the positions of corner k in all layers, from the wall outward.
  template <class Stack>
  const VolumeMesh& at(std::size_t layer, Stack&& stack) {
    for (std::uint32_t k = 0; k < ring_.size(); ++k) {
      const std::uint32_t p = ring_[k];
      mesh_.points[p] = stack(k)[points_.flat(p) ? 0 : layer];
      if (!points_.flat(p)) mesh_.points[points_.at(p, 1)] = stack(k)[layer + 1];
    }
    return mesh_;
  }
  const std::vector<CellType>& types() const { return mesh_.cell_types; }

 private:
  void make_cells() {
    mesh_.points.resize(ring_.size() + points_.risen());
    mesh_.cell_types.clear();
    mesh_.corners.clear();
    mesh_.cell_begin.clear();
    ColumnCells(points_, ring_, 0)
        .visit_cells(
            [&](CellType type) {
              mesh_.cell_types.push_back(type);
              mesh_.cell_begin.push_back(mesh_.corners.size());
            },
            [&](std::uint32_t corner) { mesh_.corners.push_back(corner); });
    mesh_.cell_begin.push_back(mesh_.corners.size());
  }

  LayerPoints points_;
  std::vector<std::uint32_t> ring_, by_number_;  // the points of the corners, and the corners in the order of points
  VolumeMesh mesh_;
};

}  // namespace vdb_offset
