// SPDX-License-Identifier: Apache-2.0
#include "join/opencascade_joins.h"

#include <BRepOffsetAPI_MakeOffsetShape.hxx>
#include <BRep_Builder.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Solid.hxx>

namespace vdb_offset::cad {
namespace {

/// The solids of a shape; closed shells count as solids.
TopoDS_Shape solids_in(const TopoDS_Shape& shape) {
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  int count = 0;
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next(), ++count)
    builder.Add(all, solid.Current());
  for (TopExp_Explorer shell(shape, TopAbs_SHELL, TopAbs_SOLID); shell.More(); shell.Next(), ++count) {
    TopoDS_Solid solid;
    builder.MakeSolid(solid);
    builder.Add(solid, shell.Current());
    builder.Add(all, solid);
  }
  if (count == 0) return {};
  return count == 1 ? TopExp_Explorer(all, TopAbs_SOLID).Current() : TopoDS_Shape(all);
}

}  // namespace

OffsetCadResult opencascade_offset(const OffsetCadRequest& request, Join join) {
  BRepOffsetAPI_MakeOffsetShape make;
  make.PerformByJoin(request.source, request.distance, 1e-6, BRepOffset_Skin, join == Join::Intersection,
                     Standard_False, join == Join::Intersection ? GeomAbs_Intersection : GeomAbs_Arc);
  OffsetCadResult result;
  if (make.IsDone()) result.shape = solids_in(make.Shape());
  if (result.shape.IsNull()) {
    result.gaps.emplace_back("OpenCASCADE makes no offset");
    return result;
  }
  TopTools_IndexedMapOfShape there;
  TopExp::MapShapes(result.shape, TopAbs_FACE, there);
  for (TopExp_Explorer face(request.source, TopAbs_FACE); face.More(); face.Next()) {
    TopoDS_Shape& made = result.made_of.emplace_back();
    for (const TopoDS_Shape& each : make.Generated(face.Current()))
      if (each.ShapeType() == TopAbs_FACE && there.Contains(each)) made = each;
    result.faces.push_back(made.IsNull() ? CadFace::Swallowed : CadFace::Kept);
  }
  return result;
}

}  // namespace vdb_offset::cad
