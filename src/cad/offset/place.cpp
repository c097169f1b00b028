// SPDX-License-Identifier: Apache-2.0
#include "offset/place.h"

#include <BRep_Tool.hxx>
#include <Geom_ElementarySurface.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp_Mat.hxx>

namespace vdb_offset::cad {
namespace {

// Normals farther apart are a sharp edge even if the gap is small beside the distance.
constexpr double kSmoothAngle = 0.06;

double distance_at(const ModelFace& f, gp_Pnt2d uv) { return f.distance(uv.X(), uv.Y()); }

gp_Vec outside(const ModelFace& f, gp_Pnt2d uv) { return unit_normal(*f.surface, uv.X(), uv.Y(), f.box) * f.sign; }

// Whether the offsets of the two faces of a smooth edge are one surface, as far round the edge as its ends may go.
bool is_one_surface(const Model& model, const ModelEdge& e, const Tolerances& tolerances) {
  const HalfEdge &a = model.halves[e.half[0]], &b = model.halves[e.half[1]];
  const Handle(Geom_Surface)& s = model.faces[a.face].offset.surface, &t = model.faces[b.face].offset.surface;
  if (a.face == b.face || s->DynamicType() != t->DynamicType() || !s->IsKind(STANDARD_TYPE(Geom_ElementarySurface)))
    return false;
  const double reach = 3 * tolerances.distance;
  for (const double part : {0.0, 0.5, 1.0}) {
    const double at = e.first + (e.last - e.first) * part;
    const gp_Pnt2d p = a.pcurve->Value(at), q = b.pcurve->Value(at);
    gp_Pnt point;
    gp_Vec du, dv;
    s->D1(p.X(), p.Y(), point, du, dv);
    for (const auto& [u, v] : {std::array{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}}) {
      const double speed = (du * std::abs(u) + dv * std::abs(v)).Magnitude();
      if (speed < 1e-12) continue;
      double apart = 0;
      project(*t, s->Value(p.X() + u * reach / speed, p.Y() + v * reach / speed), q, &apart);
      if (apart > tolerances.gap) return false;
    }
  }
  return true;
}

// Where a point of a curve lies that is closest to `point`'s plane across the curve, from a start close by.
double across(const Geom_Curve& curve, const gp_Pnt& point, double start) {
  double t = start;
  for (int i = 0; i < 30; i++) {
    gp_Pnt p;
    gp_Vec d;
    evaluate(curve, t, p, d);
    const double speed = d.SquareMagnitude();
    if (speed < 1e-30) break;
    const double step = gp_Vec(p, point).Dot(d) / speed;
    t += step;
    if (std::abs(step) * std::sqrt(speed) < 1e-12) break;
  }
  return t;
}

}  // namespace

void classify_edges(Model& model, const Tolerances& tolerances) {
  constexpr double kAlong[] = {0.003, 0.03, 0.12, 0.25, 0.38, 0.5, 0.62, 0.75, 0.88, 0.97, 0.997};
  for (ModelEdge& e : model.edges) {
    if (e.kind == EdgeKind::Pole || e.is_gone) continue;
    if (e.half[0] < 0 || e.half[1] < 0) {
      e.kind = EdgeKind::Smooth;
      continue;
    }
    const HalfEdge &a = model.halves[e.half[0]], &b = model.halves[e.half[1]];
    if (a.pcurve.IsNull() || b.pcurve.IsNull()) continue;
    const ModelFace &fa = model.faces[a.face], &fb = model.faces[b.face];
    if (fa.offset.surface.IsNull() || fb.offset.surface.IsNull()) {
      e.kind = EdgeKind::Sharp;
      continue;
    }
    double gap = 0, source_gap = 0, angle = 0;
    for (double part : kAlong) {
      const double t = e.first + (e.last - e.first) * part;
      const gp_Pnt2d p = a.pcurve->Value(t), q = b.pcurve->Value(t);
      gap = std::max(gap, fa.offset.surface->Value(p.X(), p.Y()).Distance(fb.offset.surface->Value(q.X(), q.Y())));
      source_gap = std::max(source_gap, fa.surface->Value(p.X(), p.Y()).Distance(fb.surface->Value(q.X(), q.Y())));
      const gp_Vec n = outside(fa, p), m = outside(fb, q);
      if (n.Magnitude() > 0.5 && m.Magnitude() > 0.5) angle = std::max(angle, n.Angle(m));
    }
    const bool is_smooth = angle < kSmoothAngle && gap <= source_gap + tolerances.gap;
    e.kind = is_smooth || a.face == b.face ? EdgeKind::Smooth : EdgeKind::Sharp;
    e.gap = e.kind == EdgeKind::Smooth ? gap : 0;
    e.is_within = e.kind == EdgeKind::Smooth && is_one_surface(model, e, tolerances);
    const double middle = (e.first + e.last) / 2;
    const double apart =
        distance_at(fa, a.pcurve->Value(middle)) * fa.sign - distance_at(fb, b.pcurve->Value(middle)) * fb.sign;
    e.is_step = e.kind == EdgeKind::Sharp && angle < kSmoothAngle && std::abs(apart) > tolerances.gap;
  }
}

Sides sharp_sides(const Model& model, int face) {
  const ModelFace& f = model.faces[face];
  Sides sides{false, false, false, false};
  const double near_u = 0.02 * (f.box.u1 - f.box.u0), near_v = 0.02 * (f.box.v1 - f.box.v0);
  for (int first : f.loops)
    for (int half = first;;) {
      const HalfEdge& h = model.halves[half];
      const ModelEdge& e = model.edges[h.edge];
      for (int i = 0; i <= 8 && h.twin >= 0; i++) {
        const HalfEdge& t = model.halves[h.twin];
        const double at = e.first + (e.last - e.first) * i / 8;
        const gp_Pnt2d p = h.pcurve->Value(at), q = t.pcurve->Value(at);
        const gp_Vec n = outside(f, p), m = outside(model.faces[t.face], q);
        if (n.Magnitude() < 0.5 || m.Magnitude() < 0.5 || n.Angle(m) < 0.01) continue;
        sides.u0 = sides.u0 || p.X() - f.box.u0 < near_u;
        sides.u1 = sides.u1 || f.box.u1 - p.X() < near_u;
        sides.v0 = sides.v0 || p.Y() - f.box.v0 < near_v;
        sides.v1 = sides.v1 || f.box.v1 - p.Y() < near_v;
      }
      half = h.next;
      if (half == first) break;
    }
  return sides;
}

gp_Pnt moved_start(const Model& model, int half) {
  const HalfEdge& h = model.halves[half];
  const ModelFace& f = model.faces[h.face];
  return f.surface->Value(h.origin.X(), h.origin.Y())
      .Translated(outside(f, h.origin) * (distance_at(f, h.origin) * f.sign));
}

gp_Vec start_normal(const Model& model, int half) {
  const HalfEdge& h = model.halves[half];
  return outside(model.faces[h.face], h.origin);
}

gp_Pnt miter_point_of(const Model& model, const gp_Pnt& source, const std::vector<int>& halves) {
  double a[3][3] = {}, b[3] = {};
  for (int h : halves) {
    const gp_Vec n = start_normal(model, h);
    const double d = gp_Vec(source, moved_start(model, h)).Dot(n);
    for (int i = 0; i < 3; i++) {
      b[i] += n.Coord(i + 1) * d;
      for (int k = 0; k < 3; k++) a[i][k] += n.Coord(i + 1) * n.Coord(k + 1);
    }
  }
  for (int i = 0; i < 3; i++) a[i][i] += 1e-7;
  const gp_Mat m(a[0][0], a[0][1], a[0][2], a[1][0], a[1][1], a[1][2], a[2][0], a[2][1], a[2][2]);
  return source.Translated(gp_Vec(gp_XYZ(b[0], b[1], b[2]).Multiplied(m.Inverted())));
}

namespace {

// Whether a spoke's end is to be on its trimming curve.
bool is_on_curve(const Model& model, int half) {
  const HalfEdge& h = model.halves[half];
  const ModelEdge& e = model.edges[h.edge];
  return e.kind == EdgeKind::Smooth && !h.pcurve.IsNull() && !e.strays[h.forward ? 0 : 1];
}

}  // namespace

bool let_stray(Model& model, const std::vector<int>& spokes, bool may_stray) {
  bool is_any = false;
  for (int s : spokes) {
    ModelEdge& e = model.edges[model.halves[s].edge];
    e.strays[model.halves[s].forward ? 0 : 1] = may_stray && e.is_within;
    is_any = is_any || e.is_within;
  }
  return is_any;
}

std::vector<Support> supports_of(const Model& model, const std::vector<int>& faces_of, const std::vector<int>& spokes) {
  std::vector<Support> supports;
  std::vector<int> covered;
  for (int s : spokes) {
    const HalfEdge& h = model.halves[s];
    const ModelEdge& e = model.edges[h.edge];
    if (!is_on_curve(model, s)) continue;
    supports.push_back({model.faces[h.face].offset.surface, h.pcurve, h.origin, h.forward ? e.first : e.last});
    covered.push_back(h.face);
    if (h.twin >= 0) covered.push_back(model.halves[h.twin].face);
  }
  for (int s : faces_of) {
    const HalfEdge& h = model.halves[s];
    if (std::find(covered.begin(), covered.end(), h.face) != covered.end()) continue;
    supports.push_back({model.faces[h.face].offset.surface, {}, h.origin, 0});
    covered.push_back(h.face);
  }
  return supports;
}

void spread_vertex(Model& model, int vertex) {
  const ModelVertex& v = model.vertices[vertex];
  const auto set = [&](int half, bool is_start) {
    HalfEdge& h = model.halves[half];
    ModelEdge& e = model.edges[h.edge];
    if (e.kind == EdgeKind::Chord) return;
    gp_Pnt2d& uv = is_start ? h.start : h.end;
    const Handle(Geom_Surface)& s = model.faces[h.face].offset.surface;
    const int end = h.forward == is_start ? 0 : 1;
    const bool strays = e.strays[end];
    if (e.kind == EdgeKind::Smooth && !h.pcurve.IsNull() && !strays) {
      gp_Vec2d tangent;
      evaluate(*h.pcurve, e.range[end], uv, tangent);
      return;
    }
    uv = project(*s, v.point, uv);
    if (!e.curve.IsNull() && (e.kind == EdgeKind::Sharp || strays))
      e.range[end] = across(*e.curve, v.point, end == 0 ? e.first : e.last);
  };
  for (int h : v.ring) {
    set(h, true);
    if (model.halves[h].twin >= 0) set(model.halves[h].twin, false);
    const int p = previous_drawn(model, h);
    if (model.halves[p].twin < 0) set(p, false);
  }
}

namespace {

// Moves a vertex at the apex of a cone to that of its offset. False if it is none.
bool place_apex(Model& model, ModelVertex& v) {
  const ModelFace* cone = nullptr;
  for (int h : v.ring) {
    const ModelFace& f = model.faces[model.halves[h].face];
    if (model.edges[model.halves[model.halves[h].previous].edge].kind == EdgeKind::Pole && f.offset.has_apex) cone = &f;
  }
  if (!cone) return false;
  for (int h : v.ring) {
    const HalfEdge& half = model.halves[h];
    ModelEdge& e = model.edges[half.edge];
    const double end = half.forward ? e.first : e.last;
    gp_Pnt2d uv;
    gp_Vec2d along;
    evaluate(*half.pcurve, end, uv, along);
    if (std::abs(along.Y()) < 1e-12) return false;
    e.range[half.forward ? 0 : 1] = end + (model.faces[half.face].offset.apex_v - uv.Y()) / along.Y();
  }
  v.point = cone->offset.surface->Value(0, cone->offset.apex_v);
  v.residual = 0;
  return true;
}

// Finds where all that the vertex lies on meets, and the ends of smooth edges there.
void meet_at(Model& model, ModelVertex& v, const std::vector<int>& spokes) {
  std::vector<Support> supports = supports_of(model, v.ring, spokes);
  v.point = miter_point_of(model, v.source, v.ring);
  // Another try starts from the source, not from where the last one ended.
  for (int h : v.ring) model.halves[h].start = model.halves[h].origin;
  if (v.has_near) {
    v.point = v.near;
    for (Support& s : supports)
      if (s.curve.IsNull()) s.uv = project(*s.surface, v.point, s.uv);
  }
  // Curves begin where the miter's foot is, not at the source's vertex: fillets are about as small as the distance.
  v.residual = meet(supports, v.point);
  std::size_t at = 0;
  for (int s : spokes)
    if (is_on_curve(model, s)) {
      const HalfEdge& h = model.halves[s];
      model.edges[h.edge].range[h.forward ? 0 : 1] = supports[at++].t;
    }
}

}  // namespace

bool place_astray(Model& model, int vertex, const Tolerances& tolerances) {
  ModelVertex& v = model.vertices[vertex];
  if (!let_stray(model, v.ring, true)) return false;
  meet_at(model, v, v.ring);
  spread_vertex(model, vertex);
  return v.residual <= tolerances.gap;
}

void place_vertex(Model& model, int vertex, const Tolerances& tolerances) {
  ModelVertex& v = model.vertices[vertex];
  std::vector<int> spokes = v.ring;
  let_stray(model, spokes, false);
  if (v.is_open) spokes.push_back(previous_drawn(model, v.ring.back()));  // It ends here: see below.
  bool is_smooth = true;
  for (int h : v.ring) is_smooth = is_smooth && model.edges[model.halves[h].edge].kind == EdgeKind::Smooth;
  if (is_smooth && place_apex(model, v)) {
    spread_vertex(model, vertex);
    return;
  }
  if (is_smooth) {
    // All faces touch here: the vertex is the offset of the source's, and no curve changes its range.
    const auto at = [&](int half) {
      const HalfEdge& h = model.halves[half];
      return model.faces[h.face].offset.surface->Value(h.origin.X(), h.origin.Y());
    };
    gp_XYZ sum(0, 0, 0);
    for (int h : v.ring) sum += at(h).XYZ();
    v.point = gp_Pnt(sum / static_cast<double>(v.ring.size()));
    v.residual = 0;
    for (int h : v.ring) v.residual = std::max(v.residual, v.point.Distance(at(h)));
    // But at the tip of a cone, where curves meet beyond their ends.
    if (v.residual <= tolerances.gap || v.ring.size() < 2) {
      spread_vertex(model, vertex);
      return;
    }
  }
  if (v.is_open) spokes.pop_back();
  meet_at(model, v, spokes);
  spread_vertex(model, vertex);
}

}  // namespace vdb_offset::cad
