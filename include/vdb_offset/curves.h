// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Curves in the layout of a polygon mesh: "face" f lists the points that curve f runs through, at least one. It is
/// closed if it ends where it begins. Curves that meet end to end at one position go on as one.
using CurvesView = PolygonView;
using Curves = Polygons;

/// Unit normals of the points, outward, in the plane: halfway between those of the segments that meet there. Zero for
/// points on no curve, and where segments turn back on each other. \throw InvalidInput as plane_of()
VDB_OFFSET_API std::vector<Vec3d> curve_normals(CurvesView curves);

/// An open curve, and how far its ends are apart.
struct VDB_OFFSET_API OpenCurve {
  std::uint32_t first, last;  ///< Points of the input.
  double length, gap;         ///< World units.

  /// Whether the ends are so near each other that a base may have been left out between them.
  bool is_nearly_closed() const;
  /// Share of the length up to which a gap between ends counts as a base that was left out. Blunt trailing edges are a
  /// percent or so of an airfoil's length; not measured beside other shares.
  static constexpr double kNearlyClosed = 0.1;
};

/// The curves with two ends, in the order of their chains. \throw as chains_in_plane()
VDB_OFFSET_API std::vector<OpenCurve> open_curves(CurvesView curves);

/// Closes the curves that are nearly closed, by a straight segment. Returns these, as they were.
VDB_OFFSET_API std::vector<OpenCurve> close_curves(Curves& curves);

}  // namespace vdb_offset
