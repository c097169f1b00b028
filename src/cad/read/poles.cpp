// SPDX-License-Identifier: Apache-2.0
#include "read/poles.h"

#include <BRepLib.hxx>
#include <BRepTools_ReShape.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Curve.hxx>
#include <Precision.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>

namespace vdb_offset::cad {
namespace {

bool is_point(const TopoDS_Edge& edge) {
  constexpr int kSteps = 8;
  double first, last;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
  const TopoDS_Vertex vertex = TopExp::FirstVertex(edge);
  if (curve.IsNull() || vertex.IsNull() || !vertex.IsSame(TopExp::LastVertex(edge))) return false;
  const gp_Pnt at = BRep_Tool::Pnt(vertex);
  for (int i = 0; i <= kSteps; ++i)
    if (curve->Value(first + (last - first) * i / kSteps).Distance(at) > ::Precision::Confusion()) return false;
  return true;
}

/// Whether there are edges along poles.
bool mark_poles(const TopoDS_Shape& shell) {
  BRep_Builder builder;
  bool is_any = false;
  for (TopExp_Explorer e(shell, TopAbs_EDGE); e.More(); e.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(e.Current());
    if (BRep_Tool::Degenerated(edge) || !is_point(edge)) continue;
    builder.UpdateEdge(edge, Handle(Geom_Curve)(), ::Precision::Confusion());
    builder.Degenerated(edge, true);
    is_any = true;
  }
  return is_any;
}

}  // namespace

TopoDS_Shape closed_at_poles(const TopoDS_Shape& shape) {
  BRep_Builder builder;
  BRepTools_ReShape solids;
  bool is_any = false;
  for (TopExp_Explorer s(shape, TopAbs_SHELL, TopAbs_SOLID); s.More(); s.Next()) {
    TopoDS_Shape shell = s.Current();
    if (!mark_poles(shell) || !BRep_Tool::IsClosed(shell)) continue;
    shell.Closed(true);
    TopoDS_Solid solid;
    builder.MakeSolid(solid);
    builder.Add(solid, shell);
    BRepLib::OrientClosedSolid(solid);
    solids.Replace(s.Current(), solid);
    is_any = true;
  }
  return is_any ? solids.Apply(shape) : shape;
}

}  // namespace vdb_offset::cad
