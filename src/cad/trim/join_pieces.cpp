// SPDX-License-Identifier: Apache-2.0
#include "trim/join_pieces.h"

#include <BOPAlgo_BuilderFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRep_Tool.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <map>

#include "offset/offset_surface.h"
#include "trim/point_in_face.h"

namespace vdb_offset::cad {
namespace {

bool has_edge(const TopoDS_Face& face, TopAbs_Orientation turn, const TopoDS_Shape& edge) {
  for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
    if (e.Current().IsSame(edge) && e.Current().Orientation() == turn) return true;
  return false;
}

// Whether a piece lies over another one that has the same edges.
bool lies_over(const FacePiece& piece, const FacePiece& other, double near) {
  const std::vector<gp_Pnt2d> points = points_in_face(piece.face, 1);
  if (points.empty()) return false;
  const gp_Pnt point = surface_of(piece.face)->Value(points.front().X(), points.front().Y());
  const BRepExtrema_DistShapeShape way(BRepBuilderAPI_MakeVertex(point).Vertex(), other.face);
  return way.IsDone() && way.Value() < near;
}

// Pieces that lie over each other become one if they look the same way (as where two sides in one plane grow together),
// and none if they look at each other.
void join_doubles(std::vector<FacePiece>& pieces, double near) {
  TopTools_IndexedMapOfShape edges;
  std::map<std::vector<int>, std::vector<std::size_t>> by_edges;
  std::vector<char> is_gone(pieces.size(), 0);
  for (std::size_t i = 0; i < pieces.size(); i++) {
    std::map<int, TopAbs_Orientation> sides;
    for (TopExp_Explorer e(pieces[i].face, TopAbs_EDGE); e.More(); e.Next())
      sides.emplace(edges.Add(e.Current()), e.Current().Orientation());
    std::vector<int> key;
    key.reserve(sides.size());
    for (const auto& [edge, turn] : sides) key.push_back(edge);
    for (const std::size_t k : by_edges[key]) {
      if (is_gone[k] || is_gone[i] || !lies_over(pieces[i], pieces[k], near)) continue;
      is_gone[i] = 1;
      is_gone[k] = !has_edge(pieces[k].face, sides.begin()->second, edges(sides.begin()->first));
    }
    by_edges[key].push_back(i);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pieces.size(); i++)
    if (!is_gone[i]) pieces[kept++] = pieces[i];
  pieces.resize(kept);
}

bool is_drawn(const TopoDS_Shape& edge) { return !BRep_Tool::Degenerated(TopoDS::Edge(edge)); }

// How often each edge is used by pieces.
std::map<int, int> uses_of(const std::vector<FacePiece>& pieces, TopTools_IndexedMapOfShape& edges) {
  std::map<int, int> uses;
  for (const FacePiece& piece : pieces)
    for (TopExp_Explorer e(piece.face, TopAbs_EDGE); e.More(); e.Next())
      if (is_drawn(e.Current())) uses[edges.Add(e.Current())]++;
  return uses;
}

// Cuts of two pairs of faces may lead along one way, and are two edges then.
void sew(std::vector<FacePiece>& pieces, double near) {
  TopTools_IndexedMapOfShape edges;
  const std::map<int, int> uses = uses_of(pieces, edges);
  if (std::none_of(uses.begin(), uses.end(), [](const auto& use) { return use.second == 1; })) return;
  BRepBuilderAPI_Sewing sewing(near);
  for (const FacePiece& piece : pieces) sewing.Add(piece.face);
  sewing.Perform();
  for (FacePiece& piece : pieces) {
    if (!sewing.IsModified(piece.face)) continue;
    const TopoDS_Shape& sewn = sewing.Modified(piece.face);
    if (sewn.ShapeType() == TopAbs_FACE) piece.face = TopoDS::Face(sewn.Oriented(piece.face.Orientation()));
  }
}

// Takes pieces out that hang on others by one edge: what sticks out of a miter into the open.
void peel(std::vector<FacePiece>& pieces) {
  for (std::size_t count = pieces.size() + 1; pieces.size() < count;) {
    count = pieces.size();
    TopTools_IndexedMapOfShape edges;
    const std::map<int, int> uses = uses_of(pieces, edges);
    pieces.erase(std::remove_if(pieces.begin(), pieces.end(),
                                [&](const FacePiece& piece) {
                                  for (TopExp_Explorer e(piece.face, TopAbs_EDGE); e.More(); e.Next())
                                    if (is_drawn(e.Current()) && uses.at(edges.FindIndex(e.Current())) == 1)
                                      return true;
                                  return false;
                                }),
                 pieces.end());
  }
}

// Takes edges out of a piece that has it to both of their sides, unless it is closed there.
void close_slits(FacePiece& piece) {
  TopTools_ListOfShape sides;
  bool has_slit = false;
  for (TopExp_Explorer e(piece.face.Oriented(TopAbs_FORWARD), TopAbs_EDGE); e.More(); e.Next()) {
    const bool is_slit = is_drawn(e.Current()) && !BRep_Tool::IsClosed(TopoDS::Edge(e.Current()), piece.face) &&
                         has_edge(TopoDS::Face(piece.face.Oriented(TopAbs_FORWARD)),
                                  TopAbs::Reverse(e.Current().Orientation()), e.Current());
    has_slit = has_slit || is_slit;
    if (!is_slit) sides.Append(e.Current());
  }
  if (!has_slit) return;
  BOPAlgo_BuilderFace whole;
  whole.SetFace(TopoDS::Face(piece.face.Oriented(TopAbs_FORWARD)));
  whole.SetShapes(sides);
  whole.Perform();
  if (whole.HasErrors() || whole.Areas().Extent() != 1) throw Standard_Failure("a slit in a face is not closed");
  piece.face = TopoDS::Face(whole.Areas().First().Oriented(piece.face.Orientation()));
}

}  // namespace

void join_pieces(std::vector<FacePiece>& pieces, double near) {
  join_doubles(pieces, near);
  sew(pieces, 0.1 * near);
  peel(pieces);
  for (FacePiece& piece : pieces) close_slits(piece);
}

}  // namespace vdb_offset::cad
