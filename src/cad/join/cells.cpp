// SPDX-License-Identifier: Apache-2.0
#include "join/cells.h"

#include <BOPAlgo_MakerVolume.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepTools.hxx>
#include <BRepTools_History.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_ConicalSurface.hxx>
#include <ShapeUpgrade_UnifySameDomain.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <vector>

#include "judge/soup.h"
#include "trim/point_in_face.h"
#include "trim/solids_of_pieces.h"

namespace vdb_offset::cad {
namespace {

constexpr int kMostFaces = 150;
constexpr double kEnlarged = 3;         // distances, beyond sharp edges
constexpr double kBeside = 1e-3;        // distances: how far from a cell's border it is asked where the cell lies
constexpr std::size_t kMostPoints = 5;  // of a cell

/// Whether points lie within the offset of a solid: by the half-spaces of the faces at the nearest point of it.
class Within {
 public:
  Within(const TopoDS_Shape& source, double distance)
      : source_(source), distance_(distance), soup_(source, 0.02 * std::abs(distance), 0.1 * std::abs(distance), 0.25) {
    TopExp::MapShapesAndAncestors(source, TopAbs_EDGE, TopAbs_FACE, of_edge_);
    TopExp::MapShapesAndAncestors(source, TopAbs_VERTEX, TopAbs_FACE, of_vertex_);
    BRep_Builder().MakeCompound(faces_);
    for (TopExp_Explorer face(source, TopAbs_FACE); face.More(); face.Next())
      BRep_Builder().Add(faces_, face.Current());
  }

  bool contains(const gp_Pnt& point) const {
    const SoupPoint foot = soup_.closest(point);
    if (foot.is_inside) return gp_Vec(foot.point, point).Dot(soup_.outside(foot)) < distance_;
    const BRepExtrema_DistShapeShape nearest(BRepBuilderAPI_MakeVertex(point).Vertex(), faces_);
    if (!nearest.IsDone() || nearest.NbSolution() == 0) return false;
    const gp_Pnt at = nearest.PointOnShape2(1);
    const TopoDS_Shape support = nearest.SupportOnShape2(1);
    double most = -INFINITY, least = INFINITY;
    for (const TopoDS_Shape& face : faces_at(support)) {
      const double height = gp_Vec(at, point).Dot(outside(TopoDS::Face(face), at));
      most = std::max(most, height);
      least = std::min(least, height);
    }
    return soup_.contains(point) ? least < distance_ : most < distance_;
  }

 private:
  TopTools_ListOfShape faces_at(const TopoDS_Shape& support) const {
    if (support.ShapeType() == TopAbs_EDGE && of_edge_.Contains(support)) return of_edge_.FindFromKey(support);
    if (support.ShapeType() == TopAbs_VERTEX && of_vertex_.Contains(support)) return of_vertex_.FindFromKey(support);
    TopTools_ListOfShape one;
    one.Append(support);
    return one;
  }

  gp_Vec outside(const TopoDS_Face& face, const gp_Pnt& at) const {
    const BRepExtrema_DistShapeShape foot(BRepBuilderAPI_MakeVertex(at).Vertex(), face);
    double u = 0, v = 0;
    Box2 box{};
    BRepTools::UVBounds(face, box.u0, box.u1, box.v0, box.v1);
    const TopoDS_Shape support = foot.SupportOnShape2(1);
    if (support.ShapeType() == TopAbs_FACE) {
      foot.ParOnFaceS2(1, u, v);
    } else if (support.ShapeType() == TopAbs_EDGE) {
      double t = 0, first = 0, last = 0;
      foot.ParOnEdgeS2(1, t);
      const gp_Pnt2d uv = BRep_Tool::CurveOnSurface(TopoDS::Edge(support), face, first, last)->Value(t);
      u = uv.X(), v = uv.Y();
    } else {
      const gp_Pnt2d uv = BRep_Tool::Parameters(TopoDS::Vertex(support), face);
      u = uv.X(), v = uv.Y();
    }
    return unit_normal(*surface_of(face), u, v, box) * (face.Orientation() == TopAbs_REVERSED ? -1 : 1);
  }

  const TopoDS_Shape source_;
  const double distance_;
  const Soup soup_;
  TopoDS_Compound faces_;
  TopTools_IndexedDataMapOfShapeListOfShape of_edge_, of_vertex_;
};

class Cells {
 public:
  explicit Cells(const OffsetCadRequest& request) : request_(request), far_(std::abs(request.distance)) {}

  OffsetCadResult run() {
    if (!enlarge()) return fail("faces have no offsets to divide space with");
    BOPAlgo_MakerVolume maker;
    maker.SetArguments(arguments_);
    maker.SetIntersect(true);
    maker.SetAvoidInternalShapes(true);
    maker.SetNonDestructive(true);
    maker.Perform();
    if (maker.HasErrors()) return fail("the offsets of faces enclose nothing");
    const std::vector<FacePiece> outer = outer_pieces(maker);
    result_.shape = solids_of_pieces(outer);
    if (result_.shape.IsNull()) return fail("cells of the faces' offsets do not join to solids");
    unify(outer);
    return std::move(result_);
  }

 private:
  OffsetCadResult fail(const char* why) {
    result_ = {};
    result_.gaps.emplace_back(why);
    return std::move(result_);
  }

  /// Makes faces of the enlarged offsets; false if one cannot be made.
  bool enlarge() {
    for (TopExp_Explorer shell(request_.source, TopAbs_SHELL); shell.More(); shell.Next()) {
      const Model model = offset_faces(shell.Current(), request_, result_.faces.size());
      if (!model.failure.empty() || result_.faces.size() + model.faces.size() > kMostFaces) return false;
      for (int f = 0; f < static_cast<int>(model.faces.size()); ++f) {
        const ModelFace& face = model.faces[static_cast<std::size_t>(f)];
        result_.faces.push_back(made_by(face.offset.made));
        result_.fit_error = std::max(result_.fit_error, face.offset.error);
        if (face.offset.surface.IsNull()) continue;
        const TopoDS_Face enlarged = enlarge(face, sides_of(model, f));
        if (enlarged.IsNull()) return false;
        number_of_.Bind(enlarged, static_cast<int>(result_.faces.size()) - 1);
        arguments_.Append(enlarged);
      }
    }
    return !arguments_.IsEmpty();
  }

  /// Where a face has to reach farther: at sharp edges, and all round beside one that is gone.
  static Sides sides_of(const Model& model, int face) {
    for (const HalfEdge& half : model.halves)
      if (half.face == face && half.twin >= 0 && model.faces[model.halves[half.twin].face].offset.surface.IsNull())
        return {};
    return sharp_sides(model, face);
  }

  TopoDS_Face enlarge(const ModelFace& face, const Sides& sides) const {
    const Handle(Geom_Surface)& surface = face.offset.surface;
    Box2 box = face.box, whole{};
    surface->Bounds(whole.u0, whole.u1, whole.v0, whole.v1);
    gp_Pnt middle;
    gp_Vec du, dv;
    surface->D1((box.u0 + box.u1) / 2, (box.v0 + box.v1) / 2, middle, du, dv);
    const double u = kEnlarged * far_ / std::max(1e-9, du.Magnitude()),
                 v = kEnlarged * far_ / std::max(1e-9, dv.Magnitude());
    if (sides.u0) box.u0 -= u;
    if (sides.u1) box.u1 += u;
    if (sides.v0) box.v0 -= v;
    if (sides.v1) box.v1 += v;
    bound(box.u0, box.u1, whole.u0, whole.u1, surface->IsUPeriodic() ? surface->UPeriod() : 0);
    bound(box.v0, box.v1, whole.v0, whole.v1, surface->IsVPeriodic() ? surface->VPeriod() : 0);
    if (const auto cone = Handle(Geom_ConicalSurface)::DownCast(surface)) {
      const double apex = -cone->RefRadius() / std::sin(cone->SemiAngle());
      if (box.v0 < apex && apex < box.v1) ((box.v0 + box.v1) / 2 > apex ? box.v0 : box.v1) = apex;
    }
    const BRepBuilderAPI_MakeFace made(surface, box.u0, box.u1, box.v0, box.v1, 1e-6);
    return made.IsDone() ? made.Face() : TopoDS_Face();
  }

  static void bound(double& low, double& high, double least, double most, double period) {
    if (period > 0) {
      if (high - low >= period - 1e-6) high = low + period;
      return;
    }
    low = std::max(low, least);
    high = std::min(high, most);
  }

  /// The faces of cells within the offset that no other such cell has.
  std::vector<FacePiece> outer_pieces(BOPAlgo_MakerVolume& maker) {
    TopTools_DataMapOfShapeInteger of;  // by piece of an argument
    for (const TopoDS_Shape& argument : arguments_) {
      const int number = number_of_.Find(argument);
      if (maker.IsDeleted(argument)) continue;
      of.Bind(argument, number);
      for (const TopoDS_Shape& piece : maker.Modified(argument)) of.Bind(piece, number);
    }
    const Within within(request_.source, request_.distance);
    TopTools_IndexedMapOfShape found;
    std::vector<FacePiece> pieces;
    std::vector<int> count;
    for (TopExp_Explorer cell(maker.Shape(), TopAbs_SOLID); cell.More(); cell.Next()) {
      if (!is_within(cell.Current(), within)) continue;
      for (TopExp_Explorer face(cell.Current(), TopAbs_FACE); face.More(); face.Next()) {
        const auto number = static_cast<std::size_t>(found.Add(face.Current())) - 1;
        if (number < count.size()) {
          ++count[number];
          continue;
        }
        count.push_back(1);
        pieces.push_back({TopoDS::Face(face.Current()), of.IsBound(face.Current()) ? of.Find(face.Current()) : -1});
      }
    }
    std::vector<FacePiece> outer;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (count[i] == 1) outer.push_back(pieces[i]);
    return outer;
  }

  /// By points beside its faces, of which most decide.
  bool is_within(const TopoDS_Shape& cell, const Within& within) const {
    std::size_t yes = 0, no = 0;
    for (TopExp_Explorer face(cell, TopAbs_FACE); face.More() && yes + no < kMostPoints; face.Next()) {
      const TopoDS_Face at = TopoDS::Face(face.Current());
      const std::vector<gp_Pnt2d> uv = points_in_face(at, 1);
      if (uv.empty()) continue;
      gp_Pnt point;
      gp_Vec du, dv;
      surface_of(at)->D1(uv.front().X(), uv.front().Y(), point, du, dv);
      gp_Vec inward = du.Crossed(dv);
      if (inward.Magnitude() < 1e-14) continue;
      inward.Normalize();
      if (at.Orientation() != TopAbs_REVERSED) inward.Reverse();
      const gp_Pnt beside = point.Translated(inward * (kBeside * far_));
      ++(within.contains(beside) ? yes : no);
    }
    return yes > no;
  }

  /// Joins pieces of one face.
  void unify(const std::vector<FacePiece>& outer) {
    ShapeUpgrade_UnifySameDomain unify(result_.shape, true, true, false);
    unify.Build();
    const Handle(BRepTools_History) history = unify.History();
    std::vector<FacePiece> pieces;
    TopTools_IndexedMapOfShape known;
    for (const FacePiece& piece : outer) {
      const TopTools_ListOfShape& now = history->Modified(piece.face);
      const TopoDS_Shape face = now.IsEmpty() ? TopoDS_Shape(piece.face) : now.First();
      if (known.Contains(face)) continue;
      known.Add(face);
      pieces.push_back({TopoDS::Face(face), piece.of});
    }
    result_.shape = unify.Shape();
    result_.made_of = faces_left(pieces, result_.faces.size());
    for (std::size_t k = 0; k < result_.faces.size(); ++k)
      if (result_.made_of[k].IsNull()) result_.faces[k] = CadFace::Swallowed;
  }

  const OffsetCadRequest& request_;
  const double far_;
  OffsetCadResult result_;
  TopTools_ListOfShape arguments_;
  TopTools_DataMapOfShapeInteger number_of_;  // of the source's faces, by enlarged offset
};

}  // namespace

OffsetCadResult cells_offset(const OffsetCadRequest& request) { return Cells(request).run(); }

}  // namespace vdb_offset::cad
