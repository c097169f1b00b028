// SPDX-License-Identifier: Apache-2.0
#include "offset/build.h"

#include <BRep_Builder.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Standard_Failure.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace vdb_offset::cad {
namespace {

// Cuts a spline at a pole of its face and draws the border there into the pole's point, to which it was only fitted.
void close_pole(ModelFace& face, const gp_Pnt2d& a, const gp_Pnt2d& b, const gp_Pnt& point) {
  const auto s = Handle(Geom_BSplineSurface)::DownCast(face.offset.surface);
  if (s.IsNull()) return;
  const bool across_u = std::abs(a.X() - b.X()) < std::abs(a.Y() - b.Y());
  const double at = across_u ? (a.X() + b.X()) / 2 : (a.Y() + b.Y()) / 2;
  double u0, u1, v0, v1;
  s->Bounds(u0, u1, v0, v1);
  const bool is_low = at < (across_u ? u0 + u1 : v0 + v1) / 2;
  double& end = across_u ? (is_low ? u0 : u1) : (is_low ? v0 : v1);
  const Handle(Geom_BSplineSurface) cut = Handle(Geom_BSplineSurface)::DownCast(s->Copy());
  if (std::abs(at - end) > 1e-9 && (is_low ? at > end : at < end)) {
    end = at;
    cut->Segment(u0, u1, v0, v1);
  } else if (std::abs(at - end) > 1e-9) {
    return;
  }
  const int n = across_u ? cut->NbVPoles() : cut->NbUPoles();
  const int row = is_low ? 1 : across_u ? cut->NbUPoles() : cut->NbVPoles();
  for (int i = 1; i <= n; i++) cut->SetPole(across_u ? row : i, across_u ? i : row, point);
  face.offset.surface = cut;
}

void close_poles(Model& model) {
  for (std::size_t i = 0; i < model.halves.size(); i++) {
    const HalfEdge& h = model.halves[i];
    if (h.face < 0 || model.edges[h.edge].kind != EdgeKind::Pole) continue;
    close_pole(model.faces[h.face], model.halves[h.previous].end, model.halves[h.next].start,
               model.vertices[model.halves[h.next].vertex].point);
  }
}

class ShellBuilder {
 public:
  ShellBuilder(const Model& model, const Tolerances& tolerances, KnownCurves& known)
      : model_(model), tolerances_(tolerances), known_(known) {}

  Built build() {
    for (std::size_t e = 0; e < model_.edges.size(); e++) curves_.push_back(curves_of(static_cast<int>(e)));
    if (!built_.trouble.empty()) return built_;
    add_vertices();
    for (std::size_t e = 0; e < model_.edges.size(); e++) built_.edges.push_back(edge(static_cast<int>(e)));
    TopoDS_Shell shell;
    builder_.MakeShell(shell);
    for (std::size_t f = 0; f < model_.faces.size(); f++) {
      built_.faces.push_back(model_.faces[f].is_gone ? TopoDS_Face() : face(static_cast<int>(f)));
      if (!built_.faces.back().IsNull()) builder_.Add(shell, built_.faces.back());
    }
    bool is_closed = true;
    for (const ModelEdge& e : model_.edges)
      is_closed = is_closed && (e.is_gone || e.kind == EdgeKind::Pole || (e.half[0] >= 0 && e.half[1] >= 0));
    shell.Closed(is_closed);
    built_.shell = shell;
    return built_;
  }

 private:
  EdgeCurves curves_of(int e) {
    if (model_.edges[e].is_gone || model_.edges[e].kind == EdgeKind::Pole) return {};
    const auto trouble = [&](const std::string& what) {
      built_.trouble.push_back("edge " + std::to_string(e + 1) + what);
      built_.bad_edges.push_back(e);
    };
    if (model_.edges[e].range[0] >= model_.edges[e].range[1] && !model_.edges[e].curve.IsNull()) {
      trouble(" shrinks to nothing");
      return {};
    }
    EdgeCurves c;
    try {
      c = known_.of(model_, e, tolerances_);
    } catch (const Standard_Failure& failure) {
      trouble(std::string(": ") + failure.GetMessageString());
      return c;
    }
    if (c.folds) trouble(" folds over");
    if (model_.edges[e].kind != EdgeKind::Chord && c.tolerance > 10 * tolerances_.gap + 2 * model_.edges[e].gap)
      trouble(": the faces miss each other by " + std::to_string(c.tolerance));
    return c;
  }

  void add_vertices() {
    std::vector<double> reach(model_.vertices.size());
    for (std::size_t e = 0; e < curves_.size(); e++) {
      if (curves_[e].curve.IsNull()) continue;
      const ModelEdge& m = model_.edges[e];
      const int one = m.half[0] >= 0 ? m.half[0] : m.half[1];
      const bool forward = model_.halves[one].forward;
      const int from = model_.halves[one].vertex, to = end_vertex(model_, one);
      const int first = forward ? from : to, last = forward ? to : from;
      const auto widen = [&](int v, double t) {
        const double way = curves_[e].curve->Value(t).Distance(model_.vertices[v].point);
        reach[v] = std::max({reach[v], way + curves_[e].tolerance, curves_[e].tolerance});
      };
      widen(first, curves_[e].first);
      widen(last, curves_[e].last);
    }
    for (std::size_t v = 0; v < model_.vertices.size(); v++) {
      TopoDS_Vertex vertex;
      builder_.MakeVertex(vertex, model_.vertices[v].point,
                          std::max({1e-7, reach[v] * 1.01, model_.vertices[v].residual * 1.01}));
      vertices_.push_back(vertex);
    }
  }

  TopoDS_Edge edge(int number) {
    const ModelEdge& m = model_.edges[number];
    if (m.is_gone) return {};
    TopoDS_Edge e;
    if (m.kind == EdgeKind::Pole) return pole(m);
    const EdgeCurves& c = curves_[number];
    const double tolerance = std::max(1e-7, 1.05 * c.tolerance);
    builder_.MakeEdge(e, c.curve, tolerance);
    const auto at = [&](int i) { return model_.faces[model_.halves[m.half[i]].face].offset.surface; };
    if (m.half[0] >= 0 && m.half[1] >= 0 && model_.halves[m.half[0]].face == model_.halves[m.half[1]].face) {
      // The seam of a closed face: the first trimming curve is that of the edge as the face turned forward has it.
      const bool is_reversed = model_.faces[model_.halves[m.half[0]].face].sign < 0;
      builder_.UpdateEdge(e, c.pcurves[is_reversed ? 1 : 0], c.pcurves[is_reversed ? 0 : 1], at(0), TopLoc_Location(),
                          tolerance);
    } else {
      for (int i = 0; i < 2; i++)
        if (m.half[i] >= 0) builder_.UpdateEdge(e, c.pcurves[i], at(i), TopLoc_Location(), tolerance);
    }
    builder_.Range(e, c.first, c.last);
    add_ends(e, m);
    builder_.SameParameter(e, true);
    builder_.SameRange(e, true);
    return e;
  }

  void add_ends(TopoDS_Edge& e, const ModelEdge& m) {
    const int one = m.half[0] >= 0 ? m.half[0] : m.half[1];
    const int from = model_.halves[one].vertex, to = end_vertex(model_, one);
    const bool forward = model_.halves[one].forward;
    builder_.Add(e, vertices_[forward ? from : to].Oriented(TopAbs_FORWARD));
    builder_.Add(e, vertices_[forward ? to : from].Oriented(TopAbs_REVERSED));
  }

  TopoDS_Edge pole(const ModelEdge& m) {
    const int half = m.half[0] >= 0 ? m.half[0] : m.half[1];
    const HalfEdge& h = model_.halves[half];
    const gp_Pnt2d a = model_.halves[h.previous].end, b = model_.halves[h.next].start;
    const gp_Pnt2d from = h.forward ? a : b, to = h.forward ? b : a;
    TopoDS_Edge e;
    builder_.MakeEdge(e);
    const gp_Vec2d along(from, to);
    const Handle(Geom_Surface)& s = model_.faces[h.face].offset.surface;
    builder_.UpdateEdge(e, new Geom2d_Line(from, gp_Dir2d(along)), s, TopLoc_Location(), 1e-7);
    builder_.Degenerated(e, true);
    builder_.Range(e, 0, along.Magnitude());
    add_ends(e, m);
    return e;
  }

  TopoDS_Face face(int number) {
    const ModelFace& m = model_.faces[number];
    TopoDS_Face f;
    builder_.MakeFace(f, m.offset.surface, 1e-7);
    for (int first : m.loops) {
      TopoDS_Wire wire;
      builder_.MakeWire(wire);
      // Loops go round the face as it lies in the shell; wires belong to the face turned forward, and readers of files
      // want their edges in turn.
      for (int h = first;;) {
        const HalfEdge& half = model_.halves[h];
        const bool forward = half.forward == (m.sign > 0);
        builder_.Add(wire, built_.edges[half.edge].Oriented(forward ? TopAbs_FORWARD : TopAbs_REVERSED));
        h = m.sign > 0 ? half.next : half.previous;
        if (h == first) break;
      }
      wire.Closed(true);
      builder_.Add(f, wire);
    }
    if (m.sign < 0) f.Reverse();
    return f;
  }

  const Model& model_;
  const Tolerances& tolerances_;
  KnownCurves& known_;
  BRep_Builder builder_;
  Built built_;
  std::vector<EdgeCurves> curves_;
  std::vector<TopoDS_Vertex> vertices_;
};

}  // namespace

bool KnownCurves::Key::operator<(const Key& other) const {
  return std::tie(surfaces, pcurves, numbers) < std::tie(other.surfaces, other.pcurves, other.numbers);
}

KnownCurves::Key KnownCurves::key_of(const Model& model, const ModelEdge& edge) {
  Key key;
  std::size_t count = 0;
  const auto add = [&](std::initializer_list<double> numbers) {
    for (const double each : numbers) key.numbers[count++] = each;
  };
  add({edge.range[0], edge.range[1]});
  const int one = edge.half[0] >= 0 ? edge.half[0] : edge.half[1];
  for (const int vertex : {model.halves[one].vertex, end_vertex(model, one)}) {
    const gp_Pnt& at = model.vertices[vertex].point;
    add({at.X(), at.Y(), at.Z()});
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (edge.half[i] < 0) continue;
    const HalfEdge& half = model.halves[edge.half[i]];
    key.surfaces[i] = model.faces[half.face].offset.surface;
    key.pcurves[i] = half.pcurve;
    add({half.start.X(), half.start.Y(), half.end.X(), half.end.Y()});
  }
  return key;
}

EdgeCurves KnownCurves::of(const Model& model, int edge, const Tolerances& tolerances) {
  if (model.edges[edge].kind == EdgeKind::Chord) return edge_curves(model, edge, tolerances);
  Key key = key_of(model, model.edges[edge]);
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  return known_.emplace(std::move(key), edge_curves(model, edge, tolerances)).first->second;
}

Built build_shell(Model& model, const Tolerances& tolerances, KnownCurves& known) {
  close_poles(model);
  return ShellBuilder(model, tolerances, known).build();
}

}  // namespace vdb_offset::cad
