// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "space/curve/polyline.h"
#include "space/curve/ribbon.h"

/// Makes of curves the polyline that distances are measured from, for offsets of curves and for their check.
namespace vdb_offset {

/// Curves in their plane, joined.
struct PlaneChains {
  PlaneFrame frame;
  std::vector<Vec2d> points;  ///< The points of the input, in the plane.
  CurveChains chains;
};
/// Finds the curves' plane, and joins them in it. \throw InvalidInput for curves that do not lie in one plane, or have
/// no segment
PlaneChains chains_in_plane(CurvesView curves);

/// Facts about curves in the terms of a mesh: "faces" are segments, components curves from end to end, boundary edges
/// their ends, and non-manifold edges the points where more than two segments meet.
MeshFacts facts_of(CurvesView curves, const PlaneChains& plane);

/// A polyline, and how its vertices are related to the curves' points.
struct DrawnLine {
  Polyline line;
  std::vector<std::uint32_t> vertex;  ///< Of each point: its vertex; kNone if it is on no curve.
  std::vector<Vec2d> source;          ///< Of each vertex: its position in the plane.
};
/// Makes the polyline, in the frame with this origin, at the height z.
DrawnLine draw_line(const PlaneChains& plane, const Vec3d& origin, double z);

}  // namespace vdb_offset
