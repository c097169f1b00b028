// SPDX-License-Identifier: Apache-2.0
#include "offset/edge_curve.h"

#include <ElCLib.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Line.hxx>
#include <GeomAPI.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ElementarySurface.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>
#include <optional>

#include "offset/surface_fit.h"

namespace vdb_offset::cad {
namespace {

constexpr int kFirstSpans = 8;
constexpr std::size_t kMostSpans = 512;

/// How often spans are halved: where faces nearly touch, curves turn within a small part of their length.
constexpr int kMostHalvings = 20;

// Points of an edge in turn, with their parameter on the guide.
struct Trace {
  std::vector<double> s;
  std::vector<Contact> contacts;
  bool folds = false;
};

class Tracer {
 public:
  Tracer(const Model& model, int edge) : model_(model), edge_(model.edges[edge]) {
    for (int i = 0; i < 2; i++)
      if (edge_.half[i] >= 0) {
        const HalfEdge& h = model.halves[edge_.half[i]];
        sides_[i] = &h;
        surfaces_[i] = model.faces[h.face].offset.surface;
      }
    one_ = edge_.half[0] >= 0 ? 0 : 1;
  }

  /// At shares of the way, rising from 0 to 1.
  Trace trace(const std::vector<double>& shares) const {
    Trace t;
    const int spans = static_cast<int>(shares.size()) - 1;
    const bool guided = edge_.kind == EdgeKind::Smooth || !edge_.curve.IsNull();
    const double s0 = guided ? edge_.range[0] : 0, s1 = guided ? edge_.range[1] : 1;
    for (const double share : shares) t.s.push_back(s0 + (s1 - s0) * share);
    for (int i = 0; i <= spans; i++)
      t.contacts.push_back(edge_.keeps_curves()             ? smooth(t.s[i])
                           : edge_.kind == EdgeKind::Smooth ? strayed(t.s[i])
                                                            : sharp(t, i, guided));
    if (!edge_.keeps_curves())
      for (int i = 0; i < spans; i++) {
        gp_Pnt p;
        gp_Vec direction;
        guide(t.s[i], guided, p, direction);
        t.folds = t.folds || gp_Vec(t.contacts[i].point, t.contacts[i + 1].point).Dot(direction) <= 0;
      }
    return t;
  }

  const Handle(Geom_Surface) & surface(int side) const { return surfaces_[side]; }
  const HalfEdge* side(int i) const { return sides_[i]; }
  int one() const { return one_; }

 private:
  gp_Pnt end_point(int end) const {
    const HalfEdge& h = *sides_[one_];
    const int half = edge_.half[one_];
    const int v = (end == 0) == h.forward ? h.vertex : end_vertex(model_, half);
    return model_.vertices[v].point;
  }

  void guide(double s, bool guided, gp_Pnt& p, gp_Vec& direction) const {
    if (guided) {
      evaluate(*edge_.curve, s, p, direction);
      return;
    }
    const gp_Pnt a = end_point(0), b = end_point(1);
    direction = gp_Vec(a, b);
    p = a.Translated(direction * s);
  }

  Contact smooth(double s) const {
    Contact c;
    gp_Vec2d tangent;
    gp_XYZ sum(0, 0, 0);
    int n = 0;
    std::array<gp_Pnt, 2> points;
    for (int i = 0; i < 2; i++) {
      if (!sides_[i]) continue;
      gp_Pnt2d& uv = i == 0 ? c.a : c.b;
      evaluate(*sides_[i]->pcurve, s, uv, tangent);
      points[i] = surfaces_[i]->Value(uv.X(), uv.Y());
      sum += points[i].XYZ();
      n++;
    }
    c.point = gp_Pnt(sum / n);
    if (n == 2) c.residual = points[0].Distance(points[1]) / 2;
    return c;
  }

  // Along the trimming curves, and as far from them as the ends are, by their shares of the way.
  Contact strayed(double s) const {
    const double share = (s - edge_.range[0]) / (edge_.range[1] - edge_.range[0]);
    const auto moved = [&](const HalfEdge& h) {
      gp_Pnt2d uv, first, last;
      gp_Vec2d tangent;
      evaluate(*h.pcurve, s, uv, tangent);
      evaluate(*h.pcurve, edge_.range[0], first, tangent);
      evaluate(*h.pcurve, edge_.range[1], last, tangent);
      return uv.Translated(gp_Vec2d(first, h.forward ? h.start : h.end) * (1 - share) +
                           gp_Vec2d(last, h.forward ? h.end : h.start) * share);
    };
    Contact c;
    c.a = moved(*sides_[0]);
    c.point = surfaces_[0]->Value(c.a.X(), c.a.Y());
    c.b = project(*surfaces_[1], c.point, moved(*sides_[1]), &c.residual);
    return c;
  }

  Contact sharp(const Trace& t, int i, bool guided) const {
    const HalfEdge &a = *sides_[0], &b = *sides_[1];
    const int n = static_cast<int>(t.s.size()) - 1;
    if (i == 0 || i == n) {
      Contact c;
      c.a = (i == 0) == a.forward ? a.start : a.end;
      c.b = (i == 0) == b.forward ? b.start : b.end;
      c.point = end_point(i == 0 ? 0 : 1);
      c.residual = std::max(surfaces_[0]->Value(c.a.X(), c.a.Y()).Distance(c.point),
                            surfaces_[1]->Value(c.b.X(), c.b.Y()).Distance(c.point));
      return c;
    }
    gp_Pnt p;
    gp_Vec direction;
    guide(t.s[i], guided, p, direction);
    const Contact& last = t.contacts[i - 1];
    gp_Pnt2d sa = last.a, sb = last.b;
    if (i > 1) {
      const Contact& before = t.contacts[i - 2];
      const double ratio = (t.s[i] - t.s[i - 1]) / (t.s[i - 1] - t.s[i - 2]);
      sa = sa.Translated(gp_Vec2d(before.a, last.a) * ratio);
      sb = sb.Translated(gp_Vec2d(before.b, last.b) * ratio);
    }
    Contact c = meet(*surfaces_[0], *surfaces_[1], p, direction, sa, sb);
    if (i > 1 && c.residual > 1e-6) {
      const Contact again = meet(*surfaces_[0], *surfaces_[1], p, direction, last.a, last.b);
      if (again.residual < c.residual) c = again;
    }
    return c;
  }

  const Model& model_;
  const ModelEdge& edge_;
  std::array<const HalfEdge*, 2> sides_ = {nullptr, nullptr};
  std::array<Handle(Geom_Surface), 2> surfaces_;
  int one_ = 0;
};

std::optional<gp_Lin> line_through(const std::vector<Contact>& c, double tolerance) {
  const gp_Vec along(c.front().point, c.back().point);
  if (along.Magnitude() < 10 * tolerance) return std::nullopt;
  const gp_Lin line(c.front().point, gp_Dir(along));
  for (const Contact& k : c)
    if (line.Distance(k.point) > tolerance) return std::nullopt;
  return line;
}

std::optional<gp_Circ> circle_through(const std::vector<Contact>& c, double tolerance) {
  const std::size_t n = c.size() - 1;
  const gp_Pnt &a = c[0].point, &b = c[n / 3].point, &e = c[2 * n / 3].point;
  const gp_Vec u(a, b), w(a, e);
  const gp_Vec normal = u.Crossed(w);
  if (normal.Magnitude() < 1e-9 * u.Magnitude() * w.Magnitude()) return std::nullopt;
  const double n2 = normal.SquareMagnitude();
  const gp_Vec to = (w.Crossed(normal) * -u.SquareMagnitude() + u.Crossed(normal) * w.SquareMagnitude()) / (-2 * n2);
  const gp_Pnt center = a.Translated(to);
  const double radius = to.Magnitude();
  const gp_Circ circle(gp_Ax2(center, gp_Dir(normal), gp_Dir(gp_Vec(center, a))), radius);
  for (const Contact& k : c)
    if (circle.Distance(k.point) > tolerance) return std::nullopt;
  return circle;
}

// The parameters of the points on a line or circle, unrolled; false if they do not rise.
bool parameters_on(const std::optional<gp_Lin>& line, const std::optional<gp_Circ>& circle,
                   const std::vector<Contact>& c, std::vector<double>& t) {
  t.clear();
  for (const Contact& k : c) {
    double p = line ? ElCLib::Parameter(*line, k.point) : ElCLib::Parameter(*circle, k.point);
    if (circle) {
      if (t.empty() && p > 2 * M_PI - 1e-6) p -= 2 * M_PI;
      while (!t.empty() && p <= t.back()) p += 2 * M_PI;
    }
    if (!t.empty() && p <= t.back()) return false;
    t.push_back(p);
  }
  return !circle || t.back() - t.front() < 2 * M_PI + 1e-9;
}

// A straight run in (u, v) at unit speed, as lines in (u, v) have.
Handle(Geom2d_Curve) straight(const std::vector<double>& t, const std::vector<gp_Pnt2d>& uv) {
  const gp_Vec2d along(uv.front(), uv.back());
  const double length = t.back() - t.front();
  if (std::abs(along.Magnitude() - length) > 1e-9 * (1 + length)) return {};
  for (std::size_t i = 0; i < t.size(); i++) {
    const double part = (t[i] - t.front()) / length;
    if (uv.front().Translated(along * part).Distance(uv[i]) > 1e-9 * (1 + length)) return {};
  }
  gp_Dir2d direction(along);
  if (std::abs(direction.X()) < 1e-8) direction = gp_Dir2d(0, direction.Y());
  if (std::abs(direction.Y()) < 1e-8) direction = gp_Dir2d(direction.X(), 0);
  return new Geom2d_Line(uv.front().Translated(gp_Vec2d(direction) * -t.front()), direction);
}

// The line or circle of an elementary surface under a line along u or v: exact, so that a reader that projects it on
// the surface does not find it to both sides of a seam.
Handle(Geom_Curve) iso_along(const Handle(Geom_Surface) & surface, const Handle(Geom2d_Curve) & pcurve) {
  const auto line = Handle(Geom2d_Line)::DownCast(pcurve);
  if (line.IsNull() || !surface->IsKind(STANDARD_TYPE(Geom_ElementarySurface)) ||
      surface->IsKind(STANDARD_TYPE(Geom_Plane)))
    return {};
  const gp_Dir2d d = line->Direction();
  const gp_Pnt2d at = line->Location();
  const bool along_u = std::abs(d.Y()) < 1e-12;
  if (!along_u && std::abs(d.X()) >= 1e-12) return {};
  Handle(Geom_Curve) curve = along_u ? surface->VIso(at.Y()) : surface->UIso(at.X());
  while (const auto trimmed = Handle(Geom_TrimmedCurve)::DownCast(curve)) curve = trimmed->BasisCurve();
  curve = Handle(Geom_Curve)::DownCast(curve->Copy());
  // The curve's parameter is u or v: start + t or start - t.
  double shift = along_u ? at.X() : at.Y();
  if ((along_u ? d.X() : d.Y()) < 0) {
    shift = curve->ReversedParameter(shift);
    curve->Reverse();
  }
  if (const auto l = Handle(Geom_Line)::DownCast(curve)) {
    curve->Translate(gp_Vec(l->Lin().Direction()) * shift);
    return curve;
  }
  const auto c = Handle(Geom_Circle)::DownCast(curve);
  if (c.IsNull() || c->Radius() < 1e-7) return {};
  curve->Rotate(c->Circ().Axis(), shift);
  return curve;
}

std::vector<gp_Pnt2d> uv_of(const Trace& t, int side) {
  std::vector<gp_Pnt2d> uv;
  for (const Contact& c : t.contacts) uv.push_back(side == 0 ? c.a : c.b);
  return uv;
}

template <class T>
std::vector<T> every_other(const std::vector<T>& all) {
  std::vector<T> half;
  for (std::size_t i = 0; i < all.size(); i += 2) half.push_back(all[i]);
  return half;
}

bool keeps_pcurve(const ModelEdge& e, const HalfEdge& h) {
  if (!e.keeps_curves() || h.pcurve.IsNull()) return false;
  const double apart = 1e-9 * (e.last - e.first);
  return h.pcurve->IsPeriodic() ||
         (e.range[0] >= h.pcurve->FirstParameter() - apart && e.range[1] <= h.pcurve->LastParameter() + apart);
}

// Builds the curves from every other point of a trace; the points between give the tolerance. `errors` receives that of
// each span.
EdgeCurves curves_from(const Tracer& tracer, const ModelEdge& e, const Trace& trace, double tolerance,
                       std::vector<double>& errors) {
  EdgeCurves r;
  errors.assign(trace.s.size() / 2, 0);
  std::vector<double> t = trace.s;
  const double exact = std::max(1e-8, 0.02 * tolerance);
  std::optional<gp_Lin> line = line_through(trace.contacts, exact);
  std::optional<gp_Circ> circle = line ? std::nullopt : circle_through(trace.contacts, exact);
  if (line || circle) {
    std::vector<double> own;
    bool is_good = parameters_on(line, circle, trace.contacts, own);
    if (is_good && e.keeps_curves()) {
      // Trimming curves keep their parameters, so the curve in space has to have the same up to a shift.
      const double shift = own.front() - t.front();
      for (std::size_t i = 0; i < t.size(); i++)
        is_good = is_good && std::abs(own[i] - shift - t[i]) < 1e-9 * (1 + std::abs(t[i]));
      if (is_good && line) line->SetLocation(line->Location().Translated(gp_Vec(line->Direction()) * shift));
      if (is_good && circle) circle->Rotate(gp_Ax1(circle->Location(), circle->Axis().Direction()), shift);
    } else if (is_good) {
      t = own;
    }
    if (is_good)
      r.curve = line ? Handle(Geom_Curve)(new Geom_Line(*line)) : Handle(Geom_Curve)(new Geom_Circle(*circle));
  }
  if (r.curve.IsNull()) {
    std::vector<gp_Pnt> points;
    for (const Contact& c : trace.contacts) points.push_back(c.point);
    r.curve = interpolate(every_other(t), every_other(points));
  }
  r.first = t.front();
  r.last = t.back();
  for (int i = 0; i < 2; i++) {
    const HalfEdge* h = tracer.side(i);
    if (!h) continue;
    const Handle(Geom2d_Curve) p = keeps_pcurve(e, *h) ? h->pcurve : straight(t, uv_of(trace, i));
    const Handle(Geom_Curve) iso = iso_along(tracer.surface(i), p);
    if (iso.IsNull()) continue;
    r.curve = iso;
    break;
  }
  for (int i = 0; i < 2; i++) {
    const HalfEdge* h = tracer.side(i);
    if (!h) continue;
    if (keeps_pcurve(e, *h)) {
      r.pcurves[i] = h->pcurve;
    } else if (const auto plane = Handle(Geom_Plane)::DownCast(tracer.surface(i))) {
      r.pcurves[i] = GeomAPI::To2d(r.curve, plane->Pln());
    } else {
      const std::vector<gp_Pnt2d> uv = uv_of(trace, i);
      r.pcurves[i] = straight(t, uv);
      if (r.pcurves[i].IsNull()) r.pcurves[i] = interpolate(every_other(t), every_other(uv));
    }
    // Between the points as well: the curve and its trimming curve are splines of different kinds.
    for (std::size_t k = 0; k + 1 < t.size(); k++)
      for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const double at = t[k] + (t[k + 1] - t[k]) * part;
        const gp_Pnt2d uv = r.pcurves[i]->Value(at);
        const double off = tracer.surface(i)->Value(uv.X(), uv.Y()).Distance(r.curve->Value(at));
        errors[k / 2] = std::max(errors[k / 2], off);
      }
  }
  for (std::size_t k = 0; k < t.size(); k++) {
    double& error = errors[std::min(k / 2, errors.size() - 1)];
    error = std::max(error, r.curve->Value(t[k]).Distance(trace.contacts[k].point));
  }
  r.tolerance = *std::max_element(errors.begin(), errors.end());
  return r;
}

// A straight edge between two vertices, with straight trimming curves: its faces are as far from it as they are curved.
EdgeCurves chord(const Model& model, const ModelEdge& e) {
  const int one = e.half[0] >= 0 ? e.half[0] : e.half[1];
  const bool forward = model.halves[one].forward;
  const int from = model.halves[one].vertex, to = end_vertex(model, one);
  const gp_Pnt a = model.vertices[forward ? from : to].point, b = model.vertices[forward ? to : from].point;
  EdgeCurves r;
  const gp_Lin line(a, gp_Dir(gp_Vec(a, b)));
  r.curve = new Geom_Line(line);
  r.last = a.Distance(b);
  for (int i = 0; i < 2; i++) {
    if (e.half[i] < 0) continue;
    const HalfEdge& h = model.halves[e.half[i]];
    const Handle(Geom_Surface)& surface = model.faces[h.face].offset.surface;
    if (const auto plane = Handle(Geom_Plane)::DownCast(surface)) {
      r.pcurves[i] = GeomAPI::To2d(r.curve, plane->Pln());
    } else {
      TColgp_Array1OfPnt2d poles(1, 2);
      poles(1) = h.forward ? h.start : h.end;
      poles(2) = h.forward ? h.end : h.start;
      TColStd_Array1OfReal knots(1, 2);
      knots(1) = 0;
      knots(2) = r.last;
      TColStd_Array1OfInteger multiplicities(1, 2);
      multiplicities.Init(2);
      r.pcurves[i] = new Geom2d_BSplineCurve(poles, knots, multiplicities, 1);
    }
    constexpr int kSteps = 44;  // where OpenCASCADE's check looks, and between
    for (int k = 0; k <= kSteps; k++) {
      const double t = r.last * k / kSteps;
      const gp_Pnt2d uv = r.pcurves[i]->Value(t);
      r.tolerance = std::max(r.tolerance, surface->Value(uv.X(), uv.Y()).Distance(ElCLib::Value(t, line)));
    }
  }
  return r;
}

// Shares of the way with each span in two whose error is larger than asked and than its faces miss each other by. A
// span has one of them in its middle.
std::vector<double> halved(const std::vector<double>& shares, const Trace& trace, const std::vector<double>& errors,
                           double asked) {
  std::vector<double> finer = {shares.front()};
  for (std::size_t span = 0; span < errors.size(); span++) {
    const double first = shares[2 * span], middle = shares[2 * span + 1], last = shares[2 * span + 2];
    double residual = 0;
    for (std::size_t k = 2 * span; k <= 2 * span + 2; k++) residual = std::max(residual, trace.contacts[k].residual);
    if (errors[span] > std::max(asked, 2.2 * residual))
      finer.insert(finer.end(), {(first + middle) / 2, middle, (middle + last) / 2});
    else finer.push_back(middle);
    finer.push_back(last);
  }
  return finer;
}

}  // namespace

EdgeCurves edge_curves(const Model& model, int edge, const Tolerances& tolerances) {
  const ModelEdge& e = model.edges[edge];
  if (e.kind == EdgeKind::Chord) return chord(model, e);
  const Tracer tracer(model, edge);
  std::vector<double> shares;
  for (int i = 0; i <= 2 * kFirstSpans; i++) shares.push_back(static_cast<double>(i) / (2 * kFirstSpans));
  EdgeCurves best;
  for (int round = 0; round < kMostHalvings; round++) {
    const Trace trace = tracer.trace(shares);
    std::vector<double> errors;
    EdgeCurves r = curves_from(tracer, e, trace, tolerances.curve, errors);
    r.folds = trace.folds;
    if (best.curve.IsNull() || r.tolerance < best.tolerance) best = r;
    if (r.folds || errors.size() >= kMostSpans) break;
    const std::size_t count = shares.size();
    shares = halved(shares, trace, errors, tolerances.curve);
    if (shares.size() == count) break;
  }
  return best;
}

}  // namespace vdb_offset::cad
