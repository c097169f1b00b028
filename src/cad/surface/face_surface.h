// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <BRepAdaptor_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Ax3.hxx>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>
#include <optional>
#include <string>

namespace vdb_offset::cad {

/// A point's place on a surface.
struct Foot {
  double u = 0, v = 0;
  double distance = 0;  ///< Of the point, positive on the side that the normal, du x dv, points to.
};

/// The surface of a face, with the face's placement and without its bounds: points, unit normals and closest points.
/// For planes, cylinders, cones, spheres and tori in closed form.
class FaceSurface {
 public:
  explicit FaceSurface(const TopoDS_Face& face);

  bool is_analytic() const { return is_analytic_; }
  bool is_plane() const { return type_ == GeomAbs_Plane; }
  std::string kind() const;
  double first_u() const { return u_[0]; }
  double last_u() const { return u_[1]; }
  double first_v() const { return v_[0]; }
  double last_v() const { return v_[1]; }

  gp_Pnt point(double u, double v) const;
  /// du x dv as a unit vector, at the apex of a cone what it tends to along u; nothing where there is none, as at other
  /// poles that are not of a formula.
  std::optional<gp_Vec> normal(double u, double v) const;
  /// Whether at a pole each u is the same point; else each v is.
  bool is_pole_of_u(double u, double v) const;
  /// The closest point near (u, v), which is kept as far as the place leaves it open, as u at a pole.
  Foot foot(const gp_Pnt& point, double u, double v) const;
  /// How far a point is from the surface near (u, v), for points close to it: to first order for surfaces that are not
  /// analytic.
  double height(const gp_Pnt& point, double u, double v) const;

 private:
  struct Local {
    double x, y, z;
  };
  Local local(const gp_Pnt& point) const;
  gp_Vec global(double x, double y, double z) const;
  bool is_beyond_apex(double v) const;
  double ring(double v) const;
  Foot analytic_foot(const gp_Pnt& point, double u, double v) const;
  Foot searched_foot(const gp_Pnt& point, double u, double v) const;

  BRepAdaptor_Surface surface_;
  GeomAbs_SurfaceType type_;
  bool is_analytic_;
  gp_Ax3 frame_;
  double side_ = 1;  ///< Of the frame: -1 if left-handed.
  double radius_ = 0, tube_ = 0, sine_ = 0, cosine_ = 1;
  double size_ = 1;  ///< A length that the face's own is compared with.
  double u_[2], v_[2];
};

}  // namespace vdb_offset::cad
