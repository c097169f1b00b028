// SPDX-License-Identifier: Apache-2.0
#include "judge/edge_points.h"

#include <BRepAdaptor_Curve.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>

namespace vdb_offset::cad {
namespace {

// Of the reach: points so far apart make an edge seem farther by a hundredth of the reach at most, sqrt(1 + 0.14²) - 1.
constexpr double kApart = 0.28;

// An edge longer than so many reaches has its points farther apart.
constexpr double kMostPoints = 1e5;

}  // namespace

EdgePoints::EdgePoints(const TopoDS_Shape& edges, double reach) : reach_(reach) {
  for (TopExp_Explorer e(edges, TopAbs_EDGE); e.More(); e.Next()) {
    const BRepAdaptor_Curve curve(TopoDS::Edge(e.Current()));
    const double first = curve.FirstParameter(), last = curve.LastParameter();
    // Points at even parameters may be apart by more than at even lengths: four times as many do for most curves.
    const double length = GCPnts_AbscissaPoint::Length(curve);
    const int steps = static_cast<int>(std::clamp(std::ceil(4 * length / (kApart * reach)), 1.0, kMostPoints));
    for (int i = 0; i <= steps; ++i) {
      const gp_Pnt point = curve.Value(first + (last - first) * i / steps);
      cells_[cell_of(point)].push_back(point);
    }
  }
}

std::size_t EdgePoints::CellHash::operator()(const Cell& cell) const {
  std::uint64_t mixed = 0;
  for (const std::int64_t part : cell) mixed = (mixed ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15u;
  return mixed ^ (mixed >> 32);
}

EdgePoints::Cell EdgePoints::cell_of(const gp_Pnt& point) const {
  const auto along = [&](double x) { return static_cast<std::int64_t>(std::floor(x / reach_)); };
  return {along(point.X()), along(point.Y()), along(point.Z())};
}

bool EdgePoints::has_near(const gp_Pnt& point) const {
  const Cell at = cell_of(point);
  for (std::int64_t x = -1; x <= 1; ++x)
    for (std::int64_t y = -1; y <= 1; ++y)
      for (std::int64_t z = -1; z <= 1; ++z) {
        const auto cell = cells_.find({at[0] + x, at[1] + y, at[2] + z});
        if (cell == cells_.end()) continue;
        for (const gp_Pnt& other : cell->second)
          if (point.SquareDistance(other) <= reach_ * reach_) return true;
      }
  return false;
}

}  // namespace vdb_offset::cad
