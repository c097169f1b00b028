// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Surface.hxx>
#include <functional>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>
#include <vector>

namespace vdb_offset::cad {

/// (u, v) of the point of a surface that is closest to `point`, from a start close by; with its distance.
gp_Pnt2d project(const Geom_Surface& surface, const gp_Pnt& point, gp_Pnt2d start, double* distance = nullptr);

/// A point where two surfaces meet (or, where they do not, halfway between those that are closest).
struct Contact {
  gp_Pnt point;
  gp_Pnt2d a, b;
  double residual = 0;  ///< Half the distance between the surfaces there, or the way from the plane if more.
};

/// Where two surfaces meet in a plane, from a start close by. Steps are the shortest ones, so that it also ends well
/// where the surfaces touch.
Contact meet(const Geom_Surface& a, const Geom_Surface& b, const gp_Pnt& plane_point, const gp_Vec& plane_normal,
             gp_Pnt2d start_a, gp_Pnt2d start_b);

/// What a vertex lies on: a surface, or a curve on one.
struct Support {
  Handle(Geom_Surface) surface;
  Handle(Geom2d_Curve) curve;  ///< Null: anywhere on the surface.
  gp_Pnt2d uv;                 ///< Start and result.
  double t = 0;                ///< Start and result on the curve.
};

/// The point that all supports share, from a start close by; the largest distance of a support from it as a result.
double meet(std::vector<Support>& supports, gp_Pnt& point);

/// A curve's value in (u, v), drawn out straight beyond its range unless it is a line or a conic.
void evaluate(const Geom2d_Curve& curve, double t, gp_Pnt2d& p, gp_Vec2d& tangent);

}  // namespace vdb_offset::cad
