// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Geom_Surface.hxx>
#include <TopoDS_Shape.hxx>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>
#include <gp_Vec.hxx>
#include <map>
#include <optional>
#include <vector>

#include "offset/offset_surface.h"

namespace vdb_offset::cad {

/// A point of a face, found from its tessellation and corrected on its surface.
struct SoupPoint {
  gp_Pnt point;
  int triangle = -1;
  gp_Pnt2d uv;
  double distance = 0;
  bool is_inside = false;  ///< Of a face: not on a border of it, where another one begins.
};

/// The triangles of a shape, with (u, v), in a tree of boxes.
class Soup {
 public:
  struct Triangle {
    std::array<gp_Pnt, 3> points;
    std::array<gp_Pnt2d, 3> uv;
    std::array<int, 3> nodes;          ///< Equal where triangles share a corner.
    std::array<bool, 3> is_border;     ///< The side across from corner i borders the face.
    std::array<bool, 3> is_on_border;  ///< Corner i lies on a border of the face.
    int face;
  };
  struct Face {
    Handle(Geom_Surface) surface;
    double sign;  ///< Of the material's outside along Su x Sv.
    Box2 box;     ///< What of (u, v) the face lies in.
  };

  /// Tessellates a copy of the shape: borders of faces more closely than what lies between them.
  Soup(const TopoDS_Shape& shape, double border_deflection, double deflection, double angle);
  /// The triangles that are judged of a result. \param distance the largest
  static Soup of_result(const TopoDS_Shape& shape, double distance) {
    constexpr double kAngle = 0.3;  // between normals at neighbouring corners, in radians
    return {shape, 0.01 * distance, 0.02 * distance, kAngle};
  }
  /// Triangles without surfaces: no point of them can be corrected. \param faces of each triangle; empty: all are of
  /// one
  Soup(const std::vector<gp_Pnt>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles,
       const std::vector<int>& faces = {});

  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<Face>& faces() const { return faces_; }
  bool is_complete() const { return is_complete_; }  ///< Every face has triangles.

  /// The closest point of the shape: exact within faces, that of the tessellation on their borders.
  SoupPoint closest(const gp_Pnt& point) const;
  /// Which triangles are looked for: those of some faces, whose outsides are turned from a direction far enough.
  struct Facing {
    const std::vector<char>* faces;  ///< 1 for those; null: all.
    gp_Vec direction;
    double most_cosine = 1;
  };
  struct Nearest {
    int triangle = -1;  ///< -1: none is within reach.
    double distance = 0;
  };
  /// The nearest of the triangles, flat as they are, that is within reach.
  Nearest nearest(const gp_Pnt& point, double reach, const Facing& among) const;
  /// Whether there is one.
  bool has_near(const gp_Pnt& point, double reach, const Facing& among) const;
  /// A point of a triangle, on its surface.
  SoupPoint on_triangle(int triangle, double a, double b) const;
  /// The material's outside there.
  gp_Vec outside(const SoupPoint& at) const;
  /// How often the triangles go round a point: 1 in the material of a closed shape, 0 outside. Of closed triangles by
  /// what a ray crosses, of others by their solid angle, which is between whole numbers near gaps.
  double turns(const gp_Pnt& point) const;
  bool is_closed() const { return is_closed_; }  ///< No side of a triangle is open.
  /// Whether the point lies in the closed shape.
  bool contains(const gp_Pnt& point) const { return std::abs(turns(point)) > 0.5; }
  /// The volume of the tessellation.
  double volume() const;
  /// How many sides of triangles have not as many other sides the other way: none of a tessellation that is closed.
  std::size_t open_sides() const;
  /// Corners of triangles at such sides.
  std::vector<gp_Pnt> open_places() const;
  /// The faces that have such sides, or no triangles.
  std::vector<int> open_faces() const;
  /// Corners of triangles that cross others without a common corner, up to `most`.
  std::vector<gp_Pnt> crossings(std::size_t most) const;
  /// The numbers of faces whose triangles cross so, the smaller first; each pair once, in order.
  std::vector<std::array<int, 2>> crossing_faces() const;
  /// Whether a triangle crosses one of another soup.
  bool crosses(const Soup& other) const;

 private:
  struct Node {
    std::array<double, 6> box;  // Least x, y, z, then most.
    int first, count;           // Of order_; count 0: two children at `first` and `first` + 1.
    // Unit normals of its triangles are within an angle, in radians, of an axis.
    gp_Vec axis = gp_Vec(0, 0, 0);
    double spread = M_PI, cosine = -1, sine = 0;  // and of that
  };
  class FacingTest;
  void build_tree();
  double solid_angle(const gp_Pnt& point) const;
  std::optional<int> crossings_of_ray(const gp_Pnt& point, const gp_Vec& direction) const;
  void build(int node, int first, int count);
  void bound_normals(Node& node) const;
  /// Of each side of triangles, by its corners: how many more there are the one way than the other.
  std::map<std::array<int, 2>, int> balance_of_sides() const;
  /// Calls `found` with each triangle that has a side without another, and the number of that.
  template <class Found>
  void each_open_side(Found&& found) const;
  Nearest search(const gp_Pnt& point, double reach, const Facing& among, bool is_any_enough) const;
  /// Calls `found` with every two triangles of this and the other soup that cross, until it returns false.
  template <class Found>
  void cross(const Soup& other, Found&& found) const;

  std::vector<Triangle> triangles_;
  std::vector<Face> faces_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
  double deflection_;
  bool is_complete_ = true, is_closed_ = false;
};

}  // namespace vdb_offset::cad
