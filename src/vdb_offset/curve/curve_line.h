#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/curve/polyline.h"
#include "vdb_offset/curve/ribbon.h"

/// From curves to the polyline that distances are measured from, for what offsets them and what checks that.
namespace vdb_offset {

/// Curves in their plane, joined.
struct PlaneChains {
  PlaneFrame frame;
  std::vector<Vec2d> points;  ///< Of the input.
  CurveChains chains;
};
/// \throw InvalidInput for curves that do not lie in one plane, or have no segment
PlaneChains chains_in_plane(CurvesView curves);

/// What a mesh's facts are to it: "faces" are segments, components curves from end to end, boundary edges their ends,
/// and non-manifold edges the points where more than two segments meet.
MeshFacts facts_of(CurvesView curves, const PlaneChains& plane);

/// A polyline, and how its vertices are related to the curves' points.
struct DrawnLine {
  Polyline line;
  std::vector<std::uint32_t> vertex;  ///< Of each point; kNone if it is on no curve.
  std::vector<Vec2d> source;          ///< Of each vertex, in the plane.
};
/// Puts the line into a frame whose origin is this, at so much of its z.
DrawnLine draw_line(const PlaneChains& plane, const Vec3d& origin, double z);

/// An open curve, and how far its ends are apart.
struct OpenCurve {
  std::uint32_t first, last;  ///< Points of the input.
  double length, gap;         ///< World units.

  /// Whether the ends are so near each other that a base may have been left out between them.
  bool is_nearly_closed() const { return gap < kNearlyClosed * length; }
  static constexpr double kNearlyClosed = 0.1;
};
/// Those with two ends, in the order of their chains. \throw as chains_in_plane()
std::vector<OpenCurve> open_curves(CurvesView curves);

/// Closes those that are nearly closed, by a straight segment. Returns which.
std::vector<OpenCurve> close_curves(Curves& curves);

}  // namespace vdb_offset
