// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "judge/soup.h"

namespace vdb_offset::cad {
namespace {

/// Whether a ray from a point meets a box (Kay and Kajiya, 1986).
bool meets(const std::array<double, 6>& box, const gp_XYZ& from, const gp_XYZ& along) {
  double first = 0, last = INFINITY;
  for (int k = 0; k < 3; ++k) {
    double enters = (box[k] - from.Coord(k + 1)) / along.Coord(k + 1),
           leaves = (box[k + 3] - from.Coord(k + 1)) / along.Coord(k + 1);
    if (enters > leaves) std::swap(enters, leaves);
    first = std::max(first, enters);
    last = std::min(last, leaves);
  }
  return first <= last;
}

enum class Crossing { None, Out, In, Doubtful };

/// How a ray crosses a triangle (Möller and Trumbore, 1997): it leaves the material where the triangle looks along it.
/// Near to a side, rounding decides which of two triangles it is that is crossed.
Crossing crossing(const Soup::Triangle& triangle, const gp_XYZ& from, const gp_XYZ& along) {
  constexpr double kNear = 1e-9;  // of a triangle's height
  const gp_XYZ a = triangle.points[0].XYZ(), ab = triangle.points[1].XYZ() - a, ac = triangle.points[2].XYZ() - a;
  const gp_XYZ across = ab.Crossed(ac);
  const double slope = across.Dot(along);
  if (across.SquareModulus() == 0) return Crossing::None;
  const gp_XYZ way = from - a, turned = way.Crossed(along);
  const double u = -ac.Dot(turned), v = ab.Dot(turned), w = slope - u - v;  // times the slope
  const double size = std::abs(slope), sign = slope < 0 ? -1 : 1;
  const double slack = kNear * across.Modulus();
  if (sign * u < -slack || sign * v < -slack || sign * w < -slack) return Crossing::None;
  const double height = -way.Dot(across) * sign;  // times the area and the slope's size: where along the ray
  if (height < 0) return Crossing::None;
  if (size < slack || sign * u < slack || sign * v < slack || sign * w < slack) return Crossing::Doubtful;
  return slope > 0 ? Crossing::Out : Crossing::In;
}

}  // namespace

double Soup::turns(const gp_Pnt& point) const {
  if (!is_closed_) return solid_angle(point);
  // Along no axis, and no two of them in a plane with one: sides that lie along axes are seldom met. Two have to agree.
  const gp_Vec directions[] = {{0.583, 0.227, 0.780}, {-0.331, 0.838, 0.434}, {0.177, -0.514, -0.839}};
  std::optional<int> one;
  for (const gp_Vec& direction : directions) {
    const std::optional<int> other = crossings_of_ray(point, direction);
    if (one && other && *one == *other) return *one;
    if (other) one = other;
  }
  return solid_angle(point);
}

/// How often a ray leaves the material, less how often it enters; nothing if rounding decides.
std::optional<int> Soup::crossings_of_ray(const gp_Pnt& point, const gp_Vec& direction) const {
  const gp_XYZ &from = point.XYZ(), &along = direction.XYZ();
  int sum = 0;
  std::vector<int> open = {0};
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (!meets(node.box, from, along)) continue;
    if (node.count == 0) {
      open.push_back(node.first);
      open.push_back(node.first + 1);
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const Crossing here = crossing(triangles_[order_[i]], from, along);
      if (here == Crossing::Doubtful) return std::nullopt;
      sum += here == Crossing::Out ? 1 : here == Crossing::In ? -1 : 0;
    }
  }
  return sum;
}

double Soup::solid_angle(const gp_Pnt& point) const {
  double sum = 0;  // Van Oosterom and Strackee, 1983.
  for (const Triangle& t : triangles_) {
    const gp_XYZ a = t.points[0].XYZ() - point.XYZ(), b = t.points[1].XYZ() - point.XYZ(),
                 c = t.points[2].XYZ() - point.XYZ();
    const double la = a.Modulus(), lb = b.Modulus(), lc = c.Modulus();
    sum += std::atan2(a.Dot(b.Crossed(c)), la * lb * lc + a.Dot(b) * lc + b.Dot(c) * la + c.Dot(a) * lb);
  }
  return sum / (2 * M_PI);
}

}  // namespace vdb_offset::cad
