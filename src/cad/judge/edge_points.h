// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <array>
#include <cstdint>
#include <gp_Pnt.hxx>
#include <unordered_map>
#include <vector>

namespace vdb_offset::cad {

/// Points along the edges of a shape, in cells: finds which points are near to an edge, for many of them.
class EdgePoints {
 public:
  /// \param reach how near counts, > 0
  EdgePoints(const TopoDS_Shape& edges, double reach);

  /// Whether an edge is no farther than the reach; within a hundredth of it either answer may come.
  bool has_near(const gp_Pnt& point) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const;
  };
  Cell cell_of(const gp_Pnt& point) const;

  double reach_;
  std::unordered_map<Cell, std::vector<gp_Pnt>, CellHash> cells_;
};

}  // namespace vdb_offset::cad
