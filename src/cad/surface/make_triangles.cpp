// SPDX-License-Identifier: Apache-2.0
#include "surface/make_triangles.h"

#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <cmath>

#include "surface/face_grid.h"

namespace vdb_offset::cad {

bool has_triangles(const TopoDS_Face& face) {
  TopLoc_Location place;
  const Handle(Poly_Triangulation)& mesh = BRep_Tool::Triangulation(face, place);
  return !mesh.IsNull() && mesh->NbTriangles() > 0;
}

bool has_area(const TopoDS_Face& face) {
  GProp_GProps area, around;
  BRepGProp::SurfaceProperties(face, area);
  BRepGProp::LinearProperties(face, around);
  return std::abs(area.Mass()) > BRep_Tool::MaxTolerance(face, TopAbs_EDGE) * around.Mass() / 2;
}

void make_triangles(const TopoDS_Shape& shape, const IMeshTools_Parameters& parameters) {
  const BRepMesh_IncrementalMesh mesher(shape, parameters);
  for (TopExp_Explorer found(shape, TopAbs_FACE); found.More(); found.Next()) {
    const TopoDS_Face& face = TopoDS::Face(found.Current());
    if (has_triangles(face) || !has_area(face)) continue;
    try {
      FaceGrid(face, parameters).make_triangles();
    } catch (const Standard_Failure&) {  // NOLINT(bugprone-empty-catch): then it has none, which is reported
    }
  }
}

}  // namespace vdb_offset::cad
