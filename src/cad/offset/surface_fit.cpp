// SPDX-License-Identifier: Apache-2.0
#include "offset/surface_fit.h"

#include <BSplCLib.hxx>
#include <BSplSLib.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <algorithm>

namespace vdb_offset::cad {
namespace {

constexpr std::size_t kMostKnots = 400;
constexpr int kMostRoundsInVain = 5;

TColStd_Array1OfReal sequence_of(const Knots& k) {
  int n = 0;
  for (int m : k.multiplicities) n += m;
  TColStd_Array1OfReal flat(1, n);
  int at = 0;
  for (std::size_t i = 0; i < k.knots.size(); i++)
    for (int m = 0; m < k.multiplicities[i]; m++) flat(++at) = k.knots[i];
  return flat;
}

TColStd_Array1OfReal schoenberg_points(const Knots& k, const TColStd_Array1OfReal& flat) {
  TColStd_Array1OfReal points(1, flat.Length() - k.degree - 1);
  BSplCLib::BuildSchoenbergPoints(k.degree, flat, points);
  for (double& p : points) p = std::clamp(p, k.knots.front(), k.knots.back());
  return points;
}

TColStd_Array1OfReal knots_of(const Knots& k) {
  TColStd_Array1OfReal a(1, static_cast<int>(k.knots.size()));
  for (int i = 1; i <= a.Length(); i++) a(i) = k.knots[i - 1];
  return a;
}

TColStd_Array1OfInteger multiplicities_of(const Knots& k) {
  TColStd_Array1OfInteger a(1, static_cast<int>(k.knots.size()));
  for (int i = 1; i <= a.Length(); i++) a(i) = k.multiplicities[i - 1];
  return a;
}

Handle(Geom_BSplineSurface)
    interpolate_map(const std::function<gp_Pnt(double, double)>& map, const Knots& u, const Knots& v) {
  TColStd_Array1OfReal flat_u = sequence_of(u), flat_v = sequence_of(v);
  TColStd_Array1OfReal at_u = schoenberg_points(u, flat_u), at_v = schoenberg_points(v, flat_v);
  TColgp_Array2OfPnt poles(1, at_u.Length(), 1, at_v.Length());
  for (int i = 1; i <= at_u.Length(); i++)
    for (int j = 1; j <= at_v.Length(); j++) poles(i, j) = map(at_u(i), at_v(j));
  int problem = 0;
  BSplSLib::Interpolate(u.degree, v.degree, flat_u, flat_v, at_u, at_v, poles, problem);
  if (problem != 0) throw Standard_Failure("cad offset: a spline fit has no solution");
  return new Geom_BSplineSurface(poles, knots_of(u), knots_of(v), multiplicities_of(u), multiplicities_of(v), u.degree,
                                 v.degree);
}

// Halves the marked spans.
Knots halved(const Knots& k, const std::vector<char>& marked) {
  Knots more{k.degree, {}, {}};
  for (std::size_t i = 0; i < k.knots.size(); i++) {
    more.knots.push_back(k.knots[i]);
    more.multiplicities.push_back(k.multiplicities[i]);
    if (i < marked.size() && marked[i]) {
      more.knots.push_back((k.knots[i] + k.knots[i + 1]) / 2);
      more.multiplicities.push_back(1);
    }
  }
  return more;
}

// Where in a span the fit is held against the map: nowhere a Schoenberg point of an even division.
constexpr double kBetween[] = {0.13, 0.38, 0.64, 0.89};

// The error along one direction alone: on lines through the Schoenberg points of the other direction, in which the
// fit is exact there. Marks the spans that have too much of it.
template <class Error>
double mark_spans(const Knots& k, const TColStd_Array1OfReal& lines, double tolerance, std::vector<char>& marked,
                  Error&& error) {
  double worst = 0;
  marked.assign(k.knots.size() - 1, 0);
  for (std::size_t i = 0; i + 1 < k.knots.size(); i++)
    for (double part : kBetween)
      for (double line : lines) {
        const double e = error(k.knots[i] + (k.knots[i + 1] - k.knots[i]) * part, line);
        worst = std::max(worst, e);
        if (e > tolerance) marked[i] = 1;
      }
  return worst;
}

Knots averaged_knots(const std::vector<double>& t, int degree) {
  const int n = static_cast<int>(t.size());
  Knots k{degree, {t.front()}, {degree + 1}};
  for (int j = 1; j < n - degree; j++) {
    double sum = 0;
    for (int i = j; i < j + degree; i++) sum += t[i];
    k.knots.push_back(sum / degree);
    k.multiplicities.push_back(1);
  }
  k.knots.push_back(t.back());
  k.multiplicities.push_back(degree + 1);
  return k;
}

template <class Array, class Curve, class Point>
opencascade::handle<Curve> interpolate_points(const std::vector<double>& t, const std::vector<Point>& points) {
  const int n = static_cast<int>(t.size());
  const Knots k = averaged_knots(t, std::min(5, n - 1));
  TColStd_Array1OfReal flat = sequence_of(k), at(1, n);
  TColStd_Array1OfInteger order(1, n);
  order.Init(0);
  Array poles(1, n);
  for (int i = 1; i <= n; i++) {
    at(i) = t[i - 1];
    poles(i) = points[i - 1];
  }
  int problem = 0;
  BSplCLib::Interpolate(k.degree, flat, at, order, poles, problem);
  if (problem != 0) throw Standard_Failure("cad offset: a spline through points has no solution");
  return new Curve(poles, knots_of(k), multiplicities_of(k), k.degree);
}

}  // namespace

Knots offset_knots(int degree, const std::vector<double>& knots, const std::vector<int>& multiplicities, double first,
                   double last) {
  Knots k{std::clamp(degree, 3, 5), {first}, {}};
  k.multiplicities.push_back(k.degree + 1);
  const double apart = 1e-6 * (last - first);
  for (std::size_t i = 0; i < knots.size(); i++) {
    if (knots[i] <= first + apart || knots[i] >= last - apart) continue;
    // The end knots of the spline are inner ones where it is drawn out: as smooth as any point of a span.
    const bool is_end = i == 0 || i + 1 == knots.size();
    const int smooth = is_end ? k.degree - 1 : std::max(degree - multiplicities[i] - 1, 0);
    k.knots.push_back(knots[i]);
    k.multiplicities.push_back(std::clamp(k.degree - smooth, 1, k.degree));
  }
  k.knots.push_back(last);
  k.multiplicities.push_back(k.degree + 1);
  return k;
}

Knots divided(const Knots& knots, double longest) {
  Knots more{knots.degree, {}, {}};
  for (std::size_t i = 0; i < knots.knots.size(); i++) {
    more.knots.push_back(knots.knots[i]);
    more.multiplicities.push_back(knots.multiplicities[i]);
    if (i + 1 == knots.knots.size()) break;
    const double span = knots.knots[i + 1] - knots.knots[i];
    const int parts = static_cast<int>(std::ceil(span / longest));
    for (int part = 1; part < parts; part++) {
      more.knots.push_back(knots.knots[i] + span * part / parts);
      more.multiplicities.push_back(1);
    }
  }
  return more;
}

FittedSurface fit_surface(const std::function<gp_Pnt(double, double)>& map, Knots u, Knots v, double tolerance) {
  double last_error = 0;
  int rounds_in_vain = 0;
  while (true) {
    FittedSurface fit{interpolate_map(map, u, v), 0};
    const TColStd_Array1OfReal at_u = schoenberg_points(u, sequence_of(u)), at_v = schoenberg_points(v, sequence_of(v));
    std::vector<char> marked_u, marked_v;
    const double error_u = mark_spans(u, at_v, tolerance / 2, marked_u,
                                      [&](double a, double b) { return map(a, b).Distance(fit.surface->Value(a, b)); });
    const double error_v = mark_spans(v, at_u, tolerance / 2, marked_v,
                                      [&](double b, double a) { return map(a, b).Distance(fit.surface->Value(a, b)); });
    fit.error = error_u + error_v;
    if (error_u <= tolerance / 2 && error_v <= tolerance / 2) return fit;
    // Halving spans does not help where the map is not smooth.
    rounds_in_vain = last_error > 0 && fit.error > 0.7 * last_error ? rounds_in_vain + 1 : 0;
    last_error = fit.error;
    if (u.knots.size() + v.knots.size() > kMostKnots || rounds_in_vain >= kMostRoundsInVain) return fit;
    u = halved(u, marked_u);
    v = halved(v, marked_v);
  }
}

FittedCurve fit_curve(const std::function<gp_Pnt(double)>& map, Knots knots, double tolerance) {
  while (true) {
    TColStd_Array1OfReal flat = sequence_of(knots), at = schoenberg_points(knots, flat);
    TColgp_Array1OfPnt poles(1, at.Length());
    TColStd_Array1OfInteger order(1, at.Length());
    order.Init(0);
    for (int i = 1; i <= at.Length(); i++) poles(i) = map(at(i));
    int problem = 0;
    BSplCLib::Interpolate(knots.degree, flat, at, order, poles, problem);
    if (problem != 0) throw Standard_Failure("cad offset: a spline fit has no solution");
    FittedCurve fit{new Geom_BSplineCurve(poles, knots_of(knots), multiplicities_of(knots), knots.degree), 0};
    std::vector<char> marked;
    TColStd_Array1OfReal once(1, 1);
    once(1) = 0;
    fit.error = mark_spans(knots, once, tolerance, marked,
                           [&](double a, double) { return map(a).Distance(fit.curve->Value(a)); });
    if (fit.error <= tolerance || knots.knots.size() > kMostKnots) return fit;
    knots = halved(knots, marked);
  }
}

Handle(Geom_BSplineCurve) interpolate(const std::vector<double>& parameters, const std::vector<gp_Pnt>& points) {
  return interpolate_points<TColgp_Array1OfPnt, Geom_BSplineCurve>(parameters, points);
}

Handle(Geom2d_BSplineCurve) interpolate(const std::vector<double>& parameters, const std::vector<gp_Pnt2d>& points) {
  return interpolate_points<TColgp_Array1OfPnt2d, Geom2d_BSplineCurve>(parameters, points);
}

}  // namespace vdb_offset::cad
