// SPDX-License-Identifier: Apache-2.0
#include "small_models.h"

#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Solid.hxx>
#include <cmath>
#include <gp_Trsf.hxx>
#include <numbers>

TopoDS_Shape rounded_block() {
  const TopoDS_Shape block = BRepPrimAPI_MakeBox(30, 20, 15).Shape();
  BRepFilletAPI_MakeFillet fillet(block);
  for (TopExp_Explorer edge(block, TopAbs_EDGE); edge.More(); edge.Next()) fillet.Add(3, TopoDS::Edge(edge.Current()));
  return fillet.Shape();
}

TopoDS_Shape dumbbell() {
  const TopoDS_Shape bar = BRepPrimAPI_MakeBox(gp_Pnt(9, 4, 4), gp_Pnt(17, 6, 6)).Shape();
  const TopoDS_Shape one = BRepAlgoAPI_Fuse(BRepPrimAPI_MakeBox(10, 10, 10).Shape(), bar).Shape();
  return BRepAlgoAPI_Fuse(one, BRepPrimAPI_MakeBox(gp_Pnt(16, 0, 0), gp_Pnt(26, 10, 10)).Shape()).Shape();
}

TopoDS_Shape pyramid() {
  constexpr int kSides = 12;
  const auto corner = [](int k) {
    const double angle = 2 * std::numbers::pi * k / kSides;
    return gp_Pnt(10 * std::cos(angle), 10 * std::sin(angle), 0);
  };
  BRepBuilderAPI_Sewing sewing;
  BRepBuilderAPI_MakePolygon base;
  for (int k = 0; k < kSides; ++k) {
    base.Add(corner(k));
    BRepBuilderAPI_MakePolygon side(corner(k), corner(k + 1), gp_Pnt(0, 0, 10), true);
    sewing.Add(BRepBuilderAPI_MakeFace(side.Wire()).Face());
  }
  base.Close();
  sewing.Add(BRepBuilderAPI_MakeFace(base.Wire()).Face());
  sewing.Perform();
  TopoDS_Solid solid;
  BRep_Builder().MakeSolid(solid);
  BRep_Builder().Add(solid, TopExp_Explorer(sewing.SewedShape(), TopAbs_SHELL).Current());
  BRepLib::OrientClosedSolid(solid);
  return solid;
}

TopoDS_Shape block_and_plate() {
  TopoDS_Compound both;
  BRep_Builder().MakeCompound(both);
  BRep_Builder().Add(both, BRepPrimAPI_MakeBox(30, 20, 15).Shape());
  BRep_Builder().Add(both, BRepPrimAPI_MakeBox(gp_Pnt(40, 0, 0), gp_Pnt(70, 20, 0.5)).Shape());
  return both;
}

TopoDS_Shape turned_cube() {
  TopoDS_Compound faces;
  BRep_Builder().MakeCompound(faces);
  int number = 0;
  for (TopExp_Explorer face(BRepPrimAPI_MakeBox(10, 10, 10).Shape(), TopAbs_FACE); face.More(); face.Next())
    BRep_Builder().Add(faces, number++ % 2 == 0 ? face.Current() : face.Current().Reversed());
  return faces;
}

TopoDS_Shape touching() {
  BRep_Builder builder;
  TopoDS_Compound both;
  builder.MakeCompound(both);
  builder.Add(both, BRepPrimAPI_MakeBox(1, 1, 1).Shape());
  builder.Add(both, BRepPrimAPI_MakeBox(gp_Pnt(1, 0, 0), gp_Pnt(2, 1, 1)).Shape());
  return both;
}

TopoDS_Shape crossed() {
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  builder.Add(all, BRepPrimAPI_MakeBox(gp_Pnt(-10, -2, -2), gp_Pnt(10, 2, 2)).Shape());
  builder.Add(all, BRepPrimAPI_MakeBox(gp_Pnt(-2, -10, -2), gp_Pnt(2, 10, 2)).Shape());
  builder.Add(all, BRepPrimAPI_MakeBox(gp_Pnt(20, 20, 20), gp_Pnt(22, 22, 22)).Shape());
  return all;
}

TopoDS_Shape on_top_of_each_other(const TopoDS_Shape& one, double height) {
  gp_Trsf up;
  up.SetTranslation(gp_Vec(0, 0, height));
  BRep_Builder builder;
  TopoDS_Compound both;
  builder.MakeCompound(both);
  builder.Add(both, one);
  builder.Add(both, BRepBuilderAPI_Transform(one, up, true).Shape());
  return both;
}
