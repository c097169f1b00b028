// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <functional>
#include <string>

namespace vdb_offset::cad {

/// A range of (u, v).
struct Box2 {
  double u0, u1, v0, v1;
};

/// The unit normal Su x Sv of a surface; where it has none (a pole) the limit from the middle of the box.
gp_Vec unit_normal(const Geom_Surface& surface, double u, double v, const Box2& box);

/// How far a face is offset along Su x Sv: one distance, or one that depends on (u, v).
struct FaceDistance {
  double constant = 0;
  std::function<double(double, double)> at;  ///< Empty: constant.
  double detail = 0;  ///< Over what length it may change much, in the shape's unit; 0: not known.

  double operator()(double u, double v) const { return at ? at(u, v) : constant; }
};

/// Sides of a box.
struct Sides {
  bool u0 = true, u1 = true, v0 = true, v1 = true;
};

enum class FaceMade { Kept, Fitted, Swallowed };

struct OffsetSurface {
  Handle(Geom_Surface) surface;  ///< Null if the distance swallows it.
  FaceMade made = FaceMade::Kept;
  double error = 0;  ///< Of a fit, at the same (u, v).
  bool has_apex = false;
  double apex_v = 0;  ///< Where a cone's offset has its apex.
};

/// The surface under a face, without trims of its own.
Handle(Geom_Surface) surface_of(const TopoDS_Face& face);

/// The offset of a face's surface over the same (u, v): planes, cylinders, cones, spheres and tori in closed form,
/// surfaces of revolution and extrusion by the offset of their generators, others fitted. Reaches up to `margin` beyond
/// the box on the sides that are asked for and do not close: less where the surface cannot be followed so far.
OffsetSurface offset_surface(const Handle(Geom_Surface) & surface, const Box2& box, const FaceDistance& distance,
                             const Sides& drawn_sides, double margin, double tolerance);

}  // namespace vdb_offset::cad
