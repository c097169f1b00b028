// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Geom2d_BSplineCurve.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <functional>
#include <vector>

namespace vdb_offset::cad {

/// Knots of one parameter: each once in `knots`, rising, with how often it counts.
struct Knots {
  int degree = 3;
  std::vector<double> knots;
  std::vector<int> multiplicities;
};

/// Knots over which the offset of a spline with these knots can be followed: normals are smooth once less than points
/// are, so each inner knot counts once more. The ends are `first` and `last`, which may lie outside the spline's own.
Knots offset_knots(int degree, const std::vector<double>& knots, const std::vector<int>& multiplicities, double first,
                   double last);

/// The same with spans divided into equal parts, so that none is longer than `longest`.
Knots divided(const Knots& knots, double longest);

struct FittedSurface {
  Handle(Geom_BSplineSurface) surface;
  double error;  ///< The largest distance found between the map and the surface at the same (u, v).
};

struct FittedCurve {
  Handle(Geom_BSplineCurve) curve;
  double error;
};

/// The spline that has the map's points at the Schoenberg points of the knots, so that (u, v) keep their meaning, with
/// spans halved where it is farther than `tolerance` from the map in between (to 400 knots a direction).
FittedSurface fit_surface(const std::function<gp_Pnt(double, double)>& map, Knots u, Knots v, double tolerance);

/// The same of a curve.
FittedCurve fit_curve(const std::function<gp_Pnt(double)>& map, Knots knots, double tolerance);

/// Splines of degree 5 (less for few points) through points at given rising parameters.
Handle(Geom_BSplineCurve) interpolate(const std::vector<double>& parameters, const std::vector<gp_Pnt>& points);
Handle(Geom2d_BSplineCurve) interpolate(const std::vector<double>& parameters, const std::vector<gp_Pnt2d>& points);

}  // namespace vdb_offset::cad
