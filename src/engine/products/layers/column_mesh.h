// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "products/layers/column_cells.h"

namespace vdb_offset {

/// The cells of one column as a mesh of their own, one layer after the other. Points are numbered within the column:
/// those of the wall first, in the order of the ring's numbers, so that faces that are not flat are split as in the
/// whole mesh (see cell_volume()).
class ColumnMesh {
 public:
  /// A column's corners.
  struct Base {
    std::span<const std::uint32_t> ring;
    std::span<const std::uint32_t> feet = {};  ///< The point of the wall of each; empty: all have their own.
    std::span<const SideSplit> splits = {};    ///< Of each side in the first layer; empty: none is split.
  };

  /// Starts a column. `flat(k)` is whether corner k rises in no layer.
  template <class Flat>
  void begin(const Base& base, Flat&& flat) {
    corners_ = static_cast<std::uint32_t>(base.ring.size());
    is_first_alike_ = base.feet.empty();
    upper_.number(base.ring, {}, flat);
    upper_.make_cells({});
    if (is_first_alike_) return;
    first_.number(base.ring, base.feet, flat);
    first_.make_cells(base.splits);
  }

  /// The cells in one layer. `stack(k)` are the positions of corner k in all layers, from the wall outward.
  template <class Stack>
  const VolumeMesh& at(std::size_t layer, Stack&& stack) {
    Cells& cells = in(layer);
    for (std::uint32_t k = 0; k < corners_; ++k) {
      const std::uint32_t p = cells.ring[k];
      cells.mesh.points[cells.points.foot(p)] = stack(k)[cells.points.flat(p) ? 0 : layer];
      if (!cells.points.flat(p)) cells.mesh.points[cells.points.at(p, 1)] = stack(k)[layer + 1];
    }
    cells.set_middle();
    return cells.mesh;
  }
  const std::vector<CellType>& types(std::size_t layer) { return in(layer).mesh.cell_types; }

 private:
  struct Cells {
    template <class Flat>
    void number(std::span<const std::uint32_t> numbers, std::span<const std::uint32_t> feet, Flat&& flat) {
      const auto corners = static_cast<std::uint32_t>(numbers.size());
      const auto foot = [&](std::uint32_t k) { return feet.empty() ? numbers[k] : feet[k]; };
      ring.resize(corners);
      by_number.resize(corners);
      points.shared.clear();
      // The first corner on a point of the wall comes before those that share one with it.
      const auto shares = [&](std::uint32_t k) {
        for (std::uint32_t i = 0; i < feet.size(); ++i)
          if (foot(i) == foot(k) && numbers[i] < numbers[k]) return true;
        return false;
      };
      std::iota(by_number.begin(), by_number.end(), 0);
      std::sort(by_number.begin(), by_number.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::make_tuple(shares(a), foot(a), numbers[a]) < std::make_tuple(shares(b), foot(b), numbers[b]);
      });
      points.vertex.resize(corners);
      points.in_layer.assign(corners, kNone);
      points.rising.clear();
      for (std::uint32_t p = 0; p < corners; ++p) {
        ring[by_number[p]] = p;
        if (shares(by_number[p]))
          for (std::uint32_t q = 0; q < p; ++q)
            if (foot(by_number[q]) == foot(by_number[p])) {
              points.shared.push_back(q);
              break;
            }
        if (flat(by_number[p])) continue;
        points.in_layer[p] = points.risen();
        points.rising.push_back(p);
      }
    }

    void make_cells(std::span<const SideSplit> splits) {
      const std::uint32_t risen = points.wall() + points.risen();
      const ColumnCells cells(points, ring, 0, {splits, risen});
      has_middle = cells.has_middle();
      mesh.points.resize(risen + (has_middle ? 1 : 0));
      mesh.cell_types.clear();
      mesh.corners.clear();
      mesh.cell_begin.clear();
      cells.visit_cells(
          [&](CellType type) {
            mesh.cell_types.push_back(type);
            mesh.cell_begin.push_back(mesh.corners.size());
          },
          [&](std::uint32_t corner) { mesh.corners.push_back(corner); });
      mesh.cell_begin.push_back(mesh.corners.size());
    }
    void set_middle() {
      if (has_middle)
        mesh.points.back() =
            ColumnCells(points, ring, 0).middle([&](std::uint32_t p) -> const Vec3d& { return mesh.points[p]; });
    }

    LayerPoints points;
    std::vector<std::uint32_t> ring, by_number;  // the points of the corners, and the corners in the order of points
    VolumeMesh mesh;
    bool has_middle = false;
  };

  Cells& in(std::size_t layer) { return layer == 0 && !is_first_alike_ ? first_ : upper_; }

  Cells first_, upper_;
  std::uint32_t corners_ = 0;
  bool is_first_alike_ = true;
};

}  // namespace vdb_offset
