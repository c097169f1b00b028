// SPDX-License-Identifier: Apache-2.0
#include "judge/soup.h"

#include <BRepBuilderAPI_Copy.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "judge/triangle_boxes.h"
#include "offset/contact.h"
#include "offset/offset_surface.h"
#include "surface/make_triangles.h"

namespace vdb_offset::cad {
namespace {

constexpr int kLeaf = 4;

// How far a foot on the surface may be from that on the tessellation, as a share of its distance: normals of the two
// differ by no more than the tessellation's angle.
constexpr double kLongestCorrection = 0.3;

// The closest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5), as shares of its corners.
std::array<double, 3> closest_shares(const std::array<gp_Pnt, 3>& t, const gp_Pnt& p) {
  const gp_Vec ab(t[0], t[1]), ac(t[0], t[2]), ap(t[0], p);
  const double d1 = ab.Dot(ap), d2 = ac.Dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const gp_Vec bp(t[1], p);
  const double d3 = ab.Dot(bp), d4 = ac.Dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const gp_Vec cp(t[2], p);
  const double d5 = ab.Dot(cp), d6 = ac.Dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

// Whether a foot on the surface lies beyond the border that the closest point of the tessellation is on.
bool leaves(const Soup::Triangle& t, const std::array<double, 3>& shares, const gp_Pnt2d& uv) {
  bool is_on_border = false;
  for (int k = 0; k < 3; k++)
    is_on_border = is_on_border || (t.is_border[k] && shares[k] < 1e-9) || (t.is_on_border[k] && shares[k] > 1 - 1e-9);
  if (!is_on_border) return false;
  const gp_Vec2d a(t.uv[0], t.uv[1]), b(t.uv[0], t.uv[2]), p(t.uv[0], uv);
  const double area = a.Crossed(b);
  if (std::abs(area) < 1e-300) return true;
  const double s1 = p.Crossed(b) / area, s2 = a.Crossed(p) / area;
  return s1 < -1e-9 || s2 < -1e-9 || 1 - s1 - s2 < -1e-9;
}

// Whether (u, v) lies beyond all of a face, as on the other half of a cone, where a way down from above the apex ends.
bool is_beyond(const Soup::Face& face, const gp_Pnt2d& uv) {
  constexpr double kRoundingOfParameters = 1e-9;  // of the range
  const auto is_outside = [](double x, double from, double to) {
    const double rounding = kRoundingOfParameters * (to - from);
    return x < from - rounding || x > to + rounding;
  };
  return (!face.surface->IsUPeriodic() && is_outside(uv.X(), face.box.u0, face.box.u1)) ||
         (!face.surface->IsVPeriodic() && is_outside(uv.Y(), face.box.v0, face.box.v1));
}

}  // namespace

Soup::Soup(const TopoDS_Shape& shape, double border_deflection, double deflection, double angle)
    : deflection_(deflection) {
  const TopoDS_Shape copy = BRepBuilderAPI_Copy(shape).Shape();
  IMeshTools_Parameters parameters;
  constexpr double kLeast = 2e-7;  // OpenCASCADE refuses what is below its own tolerance
  parameters.Deflection = std::max(kLeast, border_deflection);
  parameters.DeflectionInterior = std::max(kLeast, deflection);
  parameters.Angle = angle;
  parameters.AngleInterior = angle;
  make_triangles(copy, parameters);
  std::map<std::array<double, 3>, int> numbers;
  for (TopExp_Explorer e(copy, TopAbs_FACE); e.More(); e.Next()) {
    const TopoDS_Face& f = TopoDS::Face(e.Current());
    TopLoc_Location place;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(f, place);
    const double sign = f.Orientation() == TopAbs_REVERSED ? -1 : 1;
    Box2 box{};
    BRepTools::UVBounds(f, box.u0, box.u1, box.v0, box.v1);
    faces_.push_back({surface_of(f), sign, box});
    if (mesh.IsNull() || mesh->NbTriangles() == 0) {
      is_complete_ = false;
      continue;
    }
    std::map<std::array<int, 2>, int> uses;
    std::vector<char> on_border(mesh->NbNodes() + 1, 0);
    const auto side = [](int a, int b) { return std::array<int, 2>{std::min(a, b), std::max(a, b)}; };
    for (int i = 1; i <= mesh->NbTriangles(); i++) {
      std::array<int, 3> n;
      mesh->Triangle(i).Get(n[0], n[1], n[2]);
      for (int k = 0; k < 3; k++) uses[side(n[k], n[(k + 1) % 3])]++;
    }
    for (const auto& [ends, count] : uses)
      if (count == 1) on_border[ends[0]] = on_border[ends[1]] = 1;
    for (int i = 1; i <= mesh->NbTriangles(); i++) {
      std::array<int, 3> n;
      mesh->Triangle(i).Get(n[0], n[1], n[2]);
      if (sign < 0) std::swap(n[1], n[2]);
      Triangle t;
      t.face = static_cast<int>(faces_.size()) - 1;
      for (int k = 0; k < 3; k++) {
        t.points[k] = mesh->Node(n[k]).Transformed(place.Transformation());
        t.is_border[k] = uses[side(n[(k + 1) % 3], n[(k + 2) % 3])] == 1;
        t.is_on_border[k] = on_border[n[k]];
        t.uv[k] = mesh->HasUVNodes() ? mesh->UVNode(n[k]) : gp_Pnt2d();
        const double grid = 1e-4 * border_deflection;
        const std::array<double, 3> key = {std::round(t.points[k].X() / grid), std::round(t.points[k].Y() / grid),
                                           std::round(t.points[k].Z() / grid)};
        t.nodes[k] = numbers.emplace(key, static_cast<int>(numbers.size())).first->second;
      }
      triangles_.push_back(t);
    }
  }
  build_tree();
}

Soup::Soup(const std::vector<gp_Pnt>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles,
           const std::vector<int>& faces)
    : deflection_(0) {
  for (const auto& corners : triangles) {
    Triangle t{};
    t.face = faces.empty() ? 0 : faces[triangles_.size()];
    faces_.resize(std::max(faces_.size(), static_cast<std::size_t>(t.face) + 1), {{}, 1, {}});
    for (int k = 0; k < 3; k++) {
      t.points[k] = points[corners[k]];
      t.nodes[k] = static_cast<int>(corners[k]);
    }
    triangles_.push_back(t);
  }
  build_tree();
}

void Soup::build_tree() {
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.push_back({});
  if (!triangles_.empty()) build(0, 0, static_cast<int>(order_.size()));
  is_closed_ = open_sides() == 0;
}

void Soup::build(int node, int first, int count) {
  constexpr double kFar = std::numeric_limits<double>::max();
  std::array<double, 6> box = {kFar, kFar, kFar, -kFar, -kFar, -kFar};
  for (int i = first; i < first + count; i++) {
    const std::array<double, 6> b = box_of(triangles_[order_[i]]);
    for (int k = 0; k < 3; k++) {
      box[k] = std::min(box[k], b[k]);
      box[k + 3] = std::max(box[k + 3], b[k + 3]);
    }
  }
  if (count <= kLeaf) {
    nodes_[node] = {box, first, count};
    bound_normals(nodes_[node]);
    return;
  }
  int axis = 0;
  for (int k = 1; k < 3; k++)
    if (box[k + 3] - box[k] > box[axis + 3] - box[axis]) axis = k;
  const auto middle = [&](int t) {
    const auto& p = triangles_[t].points;
    return p[0].Coord(axis + 1) + p[1].Coord(axis + 1) + p[2].Coord(axis + 1);
  };
  std::nth_element(order_.begin() + first, order_.begin() + first + count / 2, order_.begin() + first + count,
                   [&](int a, int b) { return middle(a) < middle(b); });
  const int children = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node] = {box, children, 0};
  build(children, first, count / 2);
  build(children + 1, first + count / 2, count - count / 2);
  bound_normals(nodes_[node]);
}

void Soup::bound_normals(Node& node) const {
  std::vector<std::pair<gp_Vec, double>> parts;  // of triangles, or of children
  for (int i = node.first; i < node.first + node.count; i++) {
    const Triangle& t = triangles_[order_[i]];
    const gp_Vec normal = normal_of(t);
    if (normal.Magnitude() > 0) parts.emplace_back(normal.Normalized(), 0);
  }
  if (node.count == 0)
    for (const int child : {node.first, node.first + 1}) parts.emplace_back(nodes_[child].axis, nodes_[child].spread);
  gp_Vec sum(0, 0, 0);
  for (const auto& [axis, spread] : parts) sum += axis;
  if (sum.Magnitude() < 0.1) return;
  double widest = 0;
  for (const auto& [axis, spread] : parts)
    widest = std::max(widest, spread + (axis.Magnitude() > 0 ? sum.Angle(axis) : M_PI));
  node.axis = sum.Normalized();
  if (widest >= M_PI) return;
  node.spread = widest;
  node.cosine = std::cos(widest);
  node.sine = std::sin(widest);
}

SoupPoint Soup::closest(const gp_Pnt& point) const {
  double best = std::numeric_limits<double>::max();
  SoupPoint result;
  std::array<double, 3> shares = {1, 0, 0};
  std::vector<int> stack = {0};
  while (!stack.empty()) {
    const Node& n = nodes_[stack.back()];
    stack.pop_back();
    if (box_distance(n.box, point) >= best) continue;
    for (int i = n.first; i < n.first + n.count; i++) {
      const Triangle& t = triangles_[order_[i]];
      const std::array<double, 3> s = closest_shares(t.points, point);
      const double d = mixed(t.points, s).SquareDistance(point);
      if (d >= best) continue;
      best = d;
      shares = s;
      result.triangle = order_[i];
    }
    if (n.count > 0) continue;
    const bool near_first = box_distance(nodes_[n.first].box, point) < box_distance(nodes_[n.first + 1].box, point);
    stack.push_back(near_first ? n.first + 1 : n.first);
    stack.push_back(near_first ? n.first : n.first + 1);
  }
  const Triangle& t = triangles_[result.triangle];
  result.point = mixed(t.points, shares);
  result.uv = mixed(t.uv, shares);
  result.distance = std::sqrt(best);
  // The foot on the surface, if it is close to that on the tessellation.
  const Handle(Geom_Surface)& s = faces_[t.face].surface;
  double exact = 0;
  const gp_Pnt2d uv = project(*s, point, result.uv, &exact);
  const gp_Pnt foot = s->Value(uv.X(), uv.Y());
  if (leaves(t, shares, uv) || is_beyond(faces_[t.face], uv)) return result;
  if (foot.Distance(result.point) < kLongestCorrection * result.distance + 3 * deflection_) {
    result.point = foot;
    result.uv = uv;
    result.distance = exact;
    result.is_inside = true;
  }
  return result;
}

Soup::Nearest Soup::nearest(const gp_Pnt& point, double reach, const Facing& among) const {
  return search(point, reach, among, false);
}

bool Soup::has_near(const gp_Pnt& point, double reach, const Facing& among) const {
  return search(point, reach, among, true).triangle >= 0;
}

/// What is not turned from a direction far enough.
class Soup::FacingTest {
 public:
  explicit FacingTest(const Facing& among)
      : among_(among),
        length_(among.direction.Magnitude()),
        takes_all_(among.most_cosine >= 1 || length_ == 0),
        least_angle_(takes_all_ ? 0 : std::acos(among.most_cosine) - 1e-9),
        cosine_(std::cos(least_angle_)),
        sine_(std::sin(least_angle_)) {}

  /// All triangles below.
  bool excludes(const Node& node) const {
    return !takes_all_ && node.spread < least_angle_ &&
           node.axis.Dot(among_.direction) > length_ * (cosine_ * node.cosine + sine_ * node.sine);
  }
  bool excludes(const gp_Vec& normal) const {
    return !takes_all_ && normal.Dot(among_.direction) > among_.most_cosine * normal.Magnitude() * length_;
  }

 private:
  const Facing& among_;
  const double length_;
  const bool takes_all_;
  const double least_angle_, cosine_, sine_;
};

Soup::Nearest Soup::search(const gp_Pnt& point, double reach, const Facing& among, bool is_any_enough) const {
  Nearest result{-1, reach};
  double best = reach * reach;
  const FacingTest facing(among);
  std::vector<int> stack;
  if (!triangles_.empty()) stack.push_back(0);
  while (!stack.empty()) {
    const Node& n = nodes_[stack.back()];
    stack.pop_back();
    if (box_distance(n.box, point) >= best) continue;
    if (facing.excludes(n)) continue;
    for (int i = n.first; i < n.first + n.count; i++) {
      const Triangle& t = triangles_[order_[i]];
      if (among.faces && !(*among.faces)[t.face]) continue;
      const double d = mixed(t.points, closest_shares(t.points, point)).SquareDistance(point);
      // Not of a triangle without area, whose shares are no numbers.
      if (!(d < best) || facing.excludes(normal_of(t))) continue;
      best = d;
      result = {order_[i], std::sqrt(d)};
      if (is_any_enough) return result;
    }
    if (n.count > 0) continue;
    const bool near_first = box_distance(nodes_[n.first].box, point) < box_distance(nodes_[n.first + 1].box, point);
    stack.push_back(near_first ? n.first + 1 : n.first);
    stack.push_back(near_first ? n.first : n.first + 1);
  }
  return result;
}

SoupPoint Soup::on_triangle(int triangle, double a, double b) const {
  const Triangle& t = triangles_[triangle];
  if (a + b > 1) {
    a = 1 - a;
    b = 1 - b;
  }
  SoupPoint r;
  r.triangle = triangle;
  r.uv = mixed(t.uv, {1 - a - b, a, b});
  r.point = faces_[t.face].surface->Value(r.uv.X(), r.uv.Y());
  return r;
}

gp_Vec Soup::outside(const SoupPoint& at) const {
  const Triangle& t = triangles_[at.triangle];
  const Box2 box{std::min({t.uv[0].X(), t.uv[1].X(), t.uv[2].X()}), std::max({t.uv[0].X(), t.uv[1].X(), t.uv[2].X()}),
                 std::min({t.uv[0].Y(), t.uv[1].Y(), t.uv[2].Y()}), std::max({t.uv[0].Y(), t.uv[1].Y(), t.uv[2].Y()})};
  return unit_normal(*faces_[t.face].surface, at.uv.X(), at.uv.Y(), box) * faces_[t.face].sign;
}

double Soup::volume() const {
  double sum = 0;
  for (const Triangle& t : triangles_) sum += t.points[0].XYZ().Dot(t.points[1].XYZ().Crossed(t.points[2].XYZ()));
  return sum / 6;
}

std::map<std::array<int, 2>, int> Soup::balance_of_sides() const {
  std::map<std::array<int, 2>, int> balance;
  for (const Triangle& t : triangles_)
    for (int k = 0; k < 3; k++) {
      const int a = t.nodes[k], b = t.nodes[(k + 1) % 3];
      if (a != b) balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return balance;
}

std::size_t Soup::open_sides() const {
  std::size_t open = 0;
  for (const auto& [ends, balance] : balance_of_sides()) open += balance != 0;
  return open;
}

template <class Found>
void Soup::each_open_side(Found&& found) const {
  const auto balance = balance_of_sides();
  for (const Triangle& t : triangles_)
    for (int k = 0; k < 3; k++) {
      const int a = t.nodes[k], b = t.nodes[(k + 1) % 3];
      if (a != b && balance.at({std::min(a, b), std::max(a, b)}) != 0) found(t, k);
    }
}

std::vector<gp_Pnt> Soup::open_places() const {
  std::vector<gp_Pnt> places;
  each_open_side([&](const Triangle& t, int k) { places.push_back(t.points[k]); });
  return places;
}

std::vector<int> Soup::open_faces() const {
  std::vector<char> has_triangles(faces_.size(), 0), is_open(faces_.size(), 0);
  for (const Triangle& t : triangles_) has_triangles[t.face] = 1;
  each_open_side([&](const Triangle& t, int) { is_open[t.face] = 1; });
  std::vector<int> open;
  for (std::size_t f = 0; f < faces_.size(); ++f)
    if (!has_triangles[f] || is_open[f]) open.push_back(static_cast<int>(f));
  return open;
}

}  // namespace vdb_offset::cad
