// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>

#include "judge/soup.h"

namespace vdb_offset::cad {

/// Least x, y, z, then most.
using Box3 = std::array<double, 6>;

/// The square of the distance of a point from a box.
inline double box_distance(const Box3& b, const gp_Pnt& p) {
  double s = 0;
  for (int i = 0; i < 3; i++) {
    const double x = p.Coord(i + 1), out = std::max({b[i] - x, x - b[i + 3], 0.0});
    s += out * out;
  }
  return s;
}

inline bool overlap(const Box3& a, const Box3& b) {
  for (int i = 0; i < 3; i++)
    if (a[i] > b[i + 3] || b[i] > a[i + 3]) return false;
  return true;
}

inline Box3 box_of(const Soup::Triangle& t) {
  Box3 b;
  for (int i = 0; i < 3; i++) {
    b[i] = std::min({t.points[0].Coord(i + 1), t.points[1].Coord(i + 1), t.points[2].Coord(i + 1)});
    b[i + 3] = std::max({t.points[0].Coord(i + 1), t.points[1].Coord(i + 1), t.points[2].Coord(i + 1)});
  }
  return b;
}

/// Towards the outside, of twice the area.
inline gp_Vec normal_of(const Soup::Triangle& t) {
  return gp_Vec(t.points[0], t.points[1]).Crossed(gp_Vec(t.points[0], t.points[2]));
}

/// A point by its shares of three corners.
inline gp_Pnt mixed(const std::array<gp_Pnt, 3>& p, const std::array<double, 3>& s) {
  return gp_Pnt(p[0].XYZ() * s[0] + p[1].XYZ() * s[1] + p[2].XYZ() * s[2]);
}

inline gp_Pnt2d mixed(const std::array<gp_Pnt2d, 3>& p, const std::array<double, 3>& s) {
  return gp_Pnt2d(p[0].XY() * s[0] + p[1].XY() * s[1] + p[2].XY() * s[2]);
}

}  // namespace vdb_offset::cad
