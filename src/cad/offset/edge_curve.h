// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "offset/place.h"

namespace vdb_offset::cad {

/// An edge's curve in space and on its faces, all over the same parameters.
struct EdgeCurves {
  Handle(Geom_Curve) curve;
  std::array<Handle(Geom2d_Curve), 2> pcurves;  ///< By the number of the half-edge in ModelEdge::half.
  double first = 0, last = 0;
  double tolerance = 0;  ///< The largest distance found between the curve and its faces.
  bool folds = false;    ///< The curve turns back: the edge is no more.
};

/// The curve of an edge whose two vertices are placed.
EdgeCurves edge_curves(const Model& model, int edge, const Tolerances& tolerances);

}  // namespace vdb_offset::cad
