// SPDX-License-Identifier: Apache-2.0
#include "offset/model.h"

#include <BRepTools.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>

#include "offset/mend_pcurve.h"

namespace vdb_offset::cad {
namespace {

// Adds one wire of a face as half-edges. `face` is turned forward, as pcurves are asked for.
bool add_wire(Model& model, int f, const TopoDS_Wire& wire, const TopoDS_Face& face,
              const TopTools_IndexedMapOfShape& edges, double off) {
  std::vector<TopoDS_Edge> turns;
  for (BRepTools_WireExplorer e(wire, face); e.More(); e.Next()) turns.push_back(e.Current());
  int n = 0;
  for (TopExp_Explorer e(wire, TopAbs_EDGE); e.More(); e.Next()) n++;
  if (turns.empty() || static_cast<int>(turns.size()) != n) return false;
  const bool is_reversed = model.faces[f].sign < 0;
  if (is_reversed) std::reverse(turns.begin(), turns.end());
  const int base = static_cast<int>(model.halves.size());
  for (int i = 0; i < n; i++) {
    HalfEdge h;
    h.edge = edges.FindIndex(turns[i]) - 1;
    h.face = f;
    h.next = base + (i + 1) % n;
    h.previous = base + (i + n - 1) % n;
    h.forward = (turns[i].Orientation() == TopAbs_FORWARD) != is_reversed;
    double first, last;
    h.pcurve = BRep_Tool::CurveOnSurface(turns[i], face, first, last);
    if (h.pcurve.IsNull()) return false;
    while (const auto t = Handle(Geom2d_TrimmedCurve)::DownCast(h.pcurve)) h.pcurve = t->BasisCurve();
    ModelEdge& edge = model.edges[h.edge];
    if (edge.curve.IsNull()) {  // A pole has no curve but that in (u, v).
      edge.first = first;
      edge.last = last;
    } else {
      h.pcurve = mended_pcurve(h.pcurve, edge.curve, model.faces[f].surface, edge.first, edge.last, off);
    }
    const gp_Pnt2d a = h.pcurve->Value(edge.first), b = h.pcurve->Value(edge.last);
    h.start = h.forward ? a : b;
    h.end = h.forward ? b : a;
    h.origin = h.start;
    model.halves.push_back(h);
    const int at = h.forward ? 0 : 1;
    if (edge.half[at] >= 0) return false;
    edge.half[at] = base + i;
  }
  model.faces[f].loops.push_back(base);
  model.faces[f].sides += n;
  return true;
}

void add_edges(Model& model, const TopTools_IndexedMapOfShape& edges) {
  for (int i = 1; i <= edges.Extent(); i++) {
    ModelEdge e;
    e.source = TopoDS::Edge(edges(i).Oriented(TopAbs_FORWARD));
    if (BRep_Tool::Degenerated(e.source)) e.kind = EdgeKind::Pole;
    else e.curve = BRep_Tool::Curve(e.source, e.first, e.last);
    while (const auto t = Handle(Geom_TrimmedCurve)::DownCast(e.curve)) e.curve = t->BasisCurve();
    e.range = {e.first, e.last};
    model.edges.push_back(e);
  }
}

}  // namespace

void evaluate(const Geom_Curve& curve, double t, gp_Pnt& p, gp_Vec& tangent) {
  const double inside = curve.IsPeriodic() ? t : std::clamp(t, curve.FirstParameter(), curve.LastParameter());
  curve.D1(inside, p, tangent);
  p.Translate(tangent * (t - inside));
}

int previous_drawn(const Model& model, int half) {
  int h = model.halves[half].previous;
  while (model.edges[model.halves[h].edge].kind == EdgeKind::Pole && h != half) h = model.halves[h].previous;
  return h;
}

int next_drawn(const Model& model, int half) {
  int h = model.halves[half].next;
  while (model.edges[model.halves[h].edge].kind == EdgeKind::Pole && h != half) h = model.halves[h].next;
  return h;
}

int end_vertex(const Model& model, int half) { return model.halves[model.halves[half].next].vertex; }

void add_vertices(Model& model) {
  for (int start = 0; start < static_cast<int>(model.halves.size()); start++) {
    if (model.halves[start].vertex >= 0 || model.edges[model.halves[start].edge].kind == EdgeKind::Pole) continue;
    // To the beginning of the ring, if it is open: back over the twin's successor.
    int first = start;
    bool is_open = false;
    while (true) {
      const int twin = model.halves[first].twin;
      if (twin < 0) {
        is_open = true;
        break;
      }
      first = next_drawn(model, twin);
      if (first == start) break;
    }
    ModelVertex v;
    v.is_open = is_open;
    const int number = static_cast<int>(model.vertices.size());
    for (int h = first;;) {
      v.ring.push_back(h);
      model.halves[h].vertex = number;
      // The pole before it starts here, too.
      for (int p = model.halves[h].previous; model.edges[model.halves[p].edge].kind == EdgeKind::Pole;
           p = model.halves[p].previous)
        model.halves[p].vertex = number;
      const int twin = model.halves[previous_drawn(model, h)].twin;
      if (twin < 0 || twin == first) break;
      h = twin;
    }
    const HalfEdge& h = model.halves[first];
    const ModelEdge& e = model.edges[h.edge];
    if (!e.curve.IsNull()) v.source = e.curve->Value(h.forward ? e.first : e.last);
    model.vertices.push_back(v);
  }
}

Model read_model(const TopoDS_Shape& shell, double off) {
  Model model;
  TopTools_IndexedMapOfShape edges;
  TopExp::MapShapes(shell, TopAbs_EDGE, edges);
  add_edges(model, edges);
  for (TopExp_Explorer e(shell, TopAbs_FACE); e.More(); e.Next()) {
    ModelFace f;
    f.source = TopoDS::Face(e.Current());
    f.sign = f.source.Orientation() == TopAbs_REVERSED ? -1 : 1;
    f.surface = surface_of(f.source);
    BRepTools::UVBounds(f.source, f.box.u0, f.box.u1, f.box.v0, f.box.v1);
    model.faces.push_back(f);
    const int number = static_cast<int>(model.faces.size()) - 1;
    const TopoDS_Face forward = TopoDS::Face(f.source.Oriented(TopAbs_FORWARD));
    int wires = 0;
    for (TopExp_Explorer w(forward, TopAbs_WIRE); w.More(); w.Next(), wires++)
      if (!add_wire(model, number, TopoDS::Wire(w.Current()), forward, edges, off)) {
        model.failure = "face " + std::to_string(number + 1) + " has a wire that is no closed way round";
        return model;
      }
    if (wires == 0) {
      model.failure = "face " + std::to_string(number + 1) + " has no wire";
      return model;
    }
  }
  for (ModelEdge& e : model.edges)
    if (e.half[0] >= 0 && e.half[1] >= 0) {
      model.halves[e.half[0]].twin = e.half[1];
      model.halves[e.half[1]].twin = e.half[0];
    }
  add_vertices(model);
  return model;
}

}  // namespace vdb_offset::cad
