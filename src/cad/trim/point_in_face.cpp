// SPDX-License-Identifier: Apache-2.0
#include "trim/point_in_face.h"

#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <TopoDS.hxx>

namespace vdb_offset::cad {

std::vector<gp_Pnt2d> points_in_face(const TopoDS_Face& face, std::size_t wanted) {
  constexpr int kCoarsest = 6, kFinest = 64;  // divisions of the face's box; odd ones after the first
  const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
  double u0, u1, v0, v1;
  BRepTools::UVBounds(forward, u0, u1, v0, v1);
  const BRepTopAdaptor_FClass2d classifier(forward, 1e-9);
  std::vector<gp_Pnt2d> points;
  for (int n = kCoarsest; n < kFinest && points.size() < wanted; n = 2 * n + 1) {
    points.clear();
    for (int i = 0; i < n; i++)
      for (int k = 0; k < n; k++) {
        const gp_Pnt2d uv(u0 + (u1 - u0) * (i + 0.5) / n, v0 + (v1 - v0) * (k + 0.5) / n);
        if (classifier.Perform(uv) == TopAbs_IN) points.push_back(uv);
      }
  }
  return points;
}

}  // namespace vdb_offset::cad
