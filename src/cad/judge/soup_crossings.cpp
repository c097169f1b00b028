// SPDX-License-Identifier: Apache-2.0
// Where triangles of soups cross.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "judge/soup.h"
#include "judge/triangle_boxes.h"
#include "offset/contact.h"

namespace vdb_offset::cad {
namespace {

// Where a side of one triangle passes through the inside of another: (u, v) in each.
struct Piercing {
  gp_Pnt point;
  gp_Pnt2d a, b;
};

std::optional<Piercing> piercing(const Soup::Triangle& a, const Soup::Triangle& b) {
  const gp_Vec e1(b.points[0], b.points[1]), e2(b.points[0], b.points[2]);
  for (int i = 0; i < 3; i++) {
    const gp_Pnt &p = a.points[i], &q = a.points[(i + 1) % 3];
    const gp_Vec d(p, q), h = d.Crossed(e2);
    const double det = e1.Dot(h);
    if (std::abs(det) < 1e-9 * e1.Magnitude() * e2.Magnitude() * d.Magnitude()) continue;
    const gp_Vec s(b.points[0], p);
    const double u = s.Dot(h) / det;
    const gp_Vec k = s.Crossed(e1);
    const double v = d.Dot(k) / det, t = e2.Dot(k) / det;
    constexpr double kInside = 1e-6;
    if (u > kInside && v > kInside && u + v < 1 - kInside && t > kInside && t < 1 - kInside)
      return Piercing{p.Translated(d * t), gp_Pnt2d(a.uv[i].XY() * (1 - t) + a.uv[(i + 1) % 3].XY() * t),
                      mixed(b.uv, {1 - u - v, u, v})};
  }
  return std::nullopt;
}

// Whether two triangles of a face that cross stand for one place of its surface: at a pole, which is a line in (u, v),
// and one corner of triangles that lie over each other. Where a surface does cross itself, it has two places there.
bool is_one_place(const Geom_Surface& surface, const Piercing& at, double apart) {
  constexpr int kSteps = 8;
  const gp_Pnt2d a = project(surface, at.point, at.a), b = project(surface, at.point, at.b);
  const gp_Pnt first = surface.Value(a.X(), a.Y());
  for (int i = 1; i <= kSteps; i++) {
    const gp_Pnt2d way(a.XY() + (b.XY() - a.XY()) * (static_cast<double>(i) / kSteps));
    if (surface.Value(way.X(), way.Y()).Distance(first) > apart) return false;
  }
  return true;
}

}  // namespace

template <class Found>
void Soup::cross(const Soup& other, Found&& found) const {
  const bool is_self = this == &other;
  std::vector<int> stack;
  for (const Triangle& t : triangles_) {
    const std::array<double, 6> box = box_of(t);
    stack.clear();
    if (!other.triangles_.empty()) stack.push_back(0);
    while (!stack.empty()) {
      const Node& n = other.nodes_[stack.back()];
      stack.pop_back();
      if (!overlap(n.box, box)) continue;
      for (int k = n.first; k < n.first + n.count; k++) {
        const Triangle& o = other.triangles_[other.order_[k]];
        const bool shares_corner = is_self && std::any_of(t.nodes.begin(), t.nodes.end(), [&](int v) {
                                     return std::find(o.nodes.begin(), o.nodes.end(), v) != o.nodes.end();
                                   });
        if (shares_corner) continue;
        const std::optional<Piercing> at = piercing(t, o);
        const bool is_same_face = is_self && t.face == o.face;
        if (!at || (is_same_face && is_one_place(*faces_[t.face].surface, *at, 1e-3 * deflection_))) continue;
        if (!found(t, o)) return;
      }
      if (n.count == 0) stack.insert(stack.end(), {n.first, n.first + 1});
    }
  }
}

std::vector<gp_Pnt> Soup::crossings(std::size_t most) const {
  std::vector<gp_Pnt> points;
  if (most == 0) return points;
  cross(*this, [&](const Triangle& t, const Triangle& /*other*/) {
    points.push_back(mixed(t.points, {1.0 / 3, 1.0 / 3, 1.0 / 3}));
    return points.size() < most;
  });
  return points;
}

std::vector<std::array<int, 2>> Soup::crossing_faces() const {
  std::set<std::array<int, 2>> pairs;
  cross(*this, [&](const Triangle& t, const Triangle& o) {
    pairs.insert({std::min(t.face, o.face), std::max(t.face, o.face)});
    return true;
  });
  return {pairs.begin(), pairs.end()};
}

bool Soup::crosses(const Soup& other) const {
  bool is_crossing = false;
  const auto found = [&](const Triangle& /*one*/, const Triangle& /*other*/) {
    is_crossing = true;
    return false;
  };
  cross(other, found);
  if (!is_crossing) other.cross(*this, found);
  return is_crossing;
}

}  // namespace vdb_offset::cad
