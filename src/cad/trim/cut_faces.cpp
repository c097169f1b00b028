// SPDX-License-Identifier: Apache-2.0
#include "trim/cut_faces.h"

#include <BOPAlgo_Builder.hxx>
#include <BOPAlgo_BuilderFace.hxx>
#include <BOPDS_DS.hxx>
#include <BOPDS_FaceInfo.hxx>
#include <BOPDS_PaveBlock.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <cmath>
#include <set>

#include "trim/point_in_face.h"

namespace vdb_offset::cad {
namespace {

// How often the borders of a face go round a point of its (u, v).
int turns_round(const TopoDS_Face& face, const gp_Pnt2d& point) {
  constexpr int kSteps = 64;
  const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
  double angle = 0;
  for (TopExp_Explorer e(forward, TopAbs_EDGE); e.More(); e.Next()) {
    double first, last;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(TopoDS::Edge(e.Current()), forward, first, last);
    if (curve.IsNull()) throw Standard_Failure("an edge has no curve on its face");
    const double sign = e.Current().Orientation() == TopAbs_REVERSED ? -1 : 1;
    gp_Vec2d before(point, curve->Value(first));
    for (int i = 1; i <= kSteps; i++) {
      const gp_Vec2d now(point, curve->Value(first + (last - first) * i / kSteps));
      angle += sign * std::atan2(before.Crossed(now), before.Dot(now));
      before = now;
    }
  }
  return static_cast<int>(std::lround(angle / (2 * M_PI)));
}

class Cutter {
 public:
  explicit Cutter(const TopoDS_Shape& shape) {
    TopExp::MapShapes(shape, TopAbs_FACE, faces_);
    TopTools_IndexedMapOfShape edges;
    TopExp::MapShapes(shape, TopAbs_EDGE, edges);
    // OpenCASCADE does not look for what meets within one argument: edges are arguments, so that those of one face are
    // cut, too.
    for (int i = 1; i <= edges.Extent(); i++)
      if (!BRep_Tool::Degenerated(TopoDS::Edge(edges(i)))) builder_.AddArgument(edges(i));
    for (int i = 1; i <= faces_.Extent(); i++) builder_.AddArgument(faces_(i));
    builder_.SetRunParallel(false);
    builder_.SetNonDestructive(true);
    builder_.Perform();
    if (builder_.HasErrors()) throw Standard_Failure("faces that meet are not cut");
  }

  std::vector<FacePiece> pieces() {
    std::vector<FacePiece> all;
    for (int i = 1; i <= faces_.Extent(); i++) {
      const TopoDS_Face& face = TopoDS::Face(faces_(i));
      const auto add = [&](const TopoDS_Shape& piece) {
        all.push_back({TopoDS::Face(piece.Oriented(face.Orientation())), i - 1});
      };
      const TopTools_ListOfShape& parts = builder_.Modified(face);
      if (!BRepCheck_Analyzer(face).IsValid())
        for (const TopoDS_Face& cell : cells_inside(face)) add(cell);
      else if (parts.IsEmpty()) add(face);
      else
        for (const TopoDS_Shape& part : parts) add(part);
    }
    return all;
  }

 private:
  // OpenCASCADE takes a border that turns the wrong way for that of a hole: here borders cross, and each edge may
  // border cells to both of its sides.
  std::vector<TopoDS_Face> cells_inside(const TopoDS_Face& face) {
    TopTools_ListOfShape sides;
    for (const int edge : edges_on(face)) {
      const TopoDS_Shape& shape = builder_.PDS()->Shape(edge);
      sides.Append(shape.Oriented(TopAbs_FORWARD));
      sides.Append(shape.Oriented(TopAbs_REVERSED));
    }
    BOPAlgo_BuilderFace cells;
    cells.SetFace(TopoDS::Face(face.Oriented(TopAbs_FORWARD)));
    cells.SetShapes(sides);
    cells.Perform();
    if (cells.HasErrors()) throw Standard_Failure("a face whose borders cross is not cut");
    std::vector<TopoDS_Face> inside;
    for (const TopoDS_Shape& cell : cells.Areas()) {
      const std::vector<gp_Pnt2d> points = points_in_face(TopoDS::Face(cell), 1);
      if (!points.empty() && turns_round(face, points.front()) > 0) inside.push_back(TopoDS::Face(cell));
    }
    return inside;
  }

  // The edges on a face after cutting: of its borders, and where others meet it.
  std::set<int> edges_on(const TopoDS_Face& face) {
    const BOPDS_DS& all = *builder_.PDS();
    std::set<int> edges;
    const BOPDS_FaceInfo& on_face = all.FaceInfo(all.Index(face));
    for (const BOPDS_IndexedMapOfPaveBlock* blocks :
         {&on_face.PaveBlocksOn(), &on_face.PaveBlocksIn(), &on_face.PaveBlocksSc()})
      for (int i = 1; i <= blocks->Extent(); i++) {
        const Handle(BOPDS_PaveBlock) block = all.RealPaveBlock(blocks->FindKey(i));  // one of those in one place
        edges.insert(block->HasEdge() ? block->Edge() : block->OriginalEdge());
      }
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
      if (builder_.Modified(e.Current()).IsEmpty()) edges.insert(all.Index(e.Current()));
    return edges;
  }

  BOPAlgo_Builder builder_;
  TopTools_IndexedMapOfShape faces_;
};

}  // namespace

std::vector<FacePiece> cut_faces(const TopoDS_Shape& shape) { return Cutter(shape).pieces(); }

}  // namespace vdb_offset::cad
