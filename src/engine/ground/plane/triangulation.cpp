// SPDX-License-Identifier: Apache-2.0
// Points are put in one by one, in a big triangle around all of them: the triangles whose circles hold a point make
// room for those between the point and the cavity's sides (Bowyer, Computing Dirichlet tessellations, 1981; Watson,
// 1981). A segment that is missing is put in by dropping all triangles that it crosses, and triangulating what lies on
// each side of it (Anglada, An improved incremental algorithm for constructing restricted Delaunay triangulations,
// 1997). All decisions are exact.
#include "ground/plane/triangulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "ground/mesh/exact_predicates.h"
#include "ground/numbers/morton.h"
#include "ground/system/assert.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using Index = Triangulation::Index;

// How far the corners of the big triangle are away, in sizes of what is in it.
constexpr double kFar = 64;

/// Triangulates what lies to the left of a segment, up to a chain of points from its end to its start: Delaunay.
void fill_pocket(const std::vector<Vec2d>& points, Index from, Index to, std::span<const Index> chain,
                 std::vector<std::array<Index, 3>>& made) {
  if (chain.empty()) return;
  std::size_t best = 0;
  for (std::size_t i = 1; i < chain.size(); ++i)
    if (side_of_circle(points[from], points[to], points[chain[best]], points[chain[i]]) > 0) best = i;
  made.push_back({from, to, chain[best]});
  fill_pocket(points, chain[best], to, chain.first(best), made);
  fill_pocket(points, from, chain[best], chain.subspan(best + 1), made);
}

[[noreturn]] void fail_at(const Vec2d& x, const char* what) {
  throw InvalidInput(fmt::format("plane: expected {} at ({:.6g}, {:.6g})", what, x[0], x[1]));
}

[[noreturn]] void fail_through(const Vec2d& x) {
  fail_at(x, "segments that go through no other point, got one that does");
}

}  // namespace

Triangulation::Triangulation(std::span<const Vec2d> points) : points_(points.begin(), points.end()) {
  Vec2d lowest(0.0), highest(0.0);
  if (!points.empty()) lowest = highest = points[0];
  for (const Vec2d& x : points)
    for (int k = 0; k < 2; ++k) lowest[k] = std::min(lowest[k], x[k]), highest[k] = std::max(highest[k], x[k]);
  const Vec2d middle = (lowest + highest) / 2;
  const double far = kFar * std::max({highest[0] - lowest[0], highest[1] - lowest[1], 1e-300});
  const auto first = static_cast<Index>(points_.size());
  points_.insert(points_.end(),
                 {middle + Vec2d(-2 * far, -far), middle + Vec2d(2 * far, -far), middle + Vec2d(0, 2 * far)});
  triangles_ = {{{first, first + 1, first + 2}, {kNone, kNone, kNone}}};
  at_.assign(points_.size(), 0);
  starting_.assign(points_.size(), kNone);
  stamp_ = {0};
  std::vector<Index> order(first);
  std::iota(order.begin(), order.end(), 0);
  const MortonCurve curve({lowest[0], lowest[1], 0}, {highest[0], highest[1], 0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return curve({points_[a][0], points_[a][1], 0}) < curve({points_[b][0], points_[b][1], 0});
  });
  for (const Index p : order) {
    const auto cavity = cavity_of(points_[p], locate(points_[p]));
    if (!cavity) fail_at(points_[p], "one point, got two");
    put(p, *cavity);
  }
}

Index Triangulation::locate(const Vec2d& x) const {
  Index t = last_ < triangles_.size() ? last_ : 0;
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (std::size_t k = 0; k < 3 && !goes_on; ++k)
      if (side_of(corner(t, k + 1), corner(t, k + 2), x) < 0) t = triangles_[t].beside[k], goes_on = true;
  }
  return t;
}

std::optional<Triangulation::Cavity> Triangulation::cavity_of(const Vec2d& x, Index triangle) {
  ++cavities_;
  Cavity cavity;
  cavity.triangles = {triangle};
  stamp_[triangle] = cavities_;
  for (std::size_t i = 0; i < cavity.triangles.size(); ++i) {
    const Triangle here = triangles_[cavity.triangles[i]];
    for (Index k = 0; k < 3; ++k) {
      const Index next = here.beside[k];
      if (next != kNone && stamp_[next] == cavities_) continue;
      if (next != kNone && side_of_circle(corner(next, 0), corner(next, 1), corner(next, 2), x) > 0) {
        stamp_[next] = cavities_;
        cavity.triangles.push_back(next);
      } else {
        cavity.sides.push_back({cavity.triangles[i], k});
      }
    }
  }
  // A side may have been met before the triangle behind it was.
  std::erase_if(cavity.sides, [&](const Side& side) {
    const Index next = triangles_[side.triangle].beside[side.corner];
    return next != kNone && stamp_[next] == cavities_;
  });
  for (const auto& [t, k] : cavity.sides)
    if (side_of(corner(t, k + 1), corner(t, k + 2), x) <= 0) return std::nullopt;
  return cavity;
}

std::vector<Index> Triangulation::insert(const Vec2d& x, const Cavity& cavity) {
  points_.push_back(x);
  at_.push_back(kNone);
  starting_.push_back(kNone);
  return put(static_cast<Index>(points_.size() - 1), cavity);
}

/// Puts a point of the triangulation's into its cavity.
std::vector<Index> Triangulation::put(Index p, const Cavity& cavity) {
  std::vector<Index> around = cavity.triangles;
  while (around.size() < cavity.sides.size()) {
    around.push_back(static_cast<Index>(triangles_.size()));
    triangles_.emplace_back();
    stamp_.push_back(0);
  }
  VDB_OFFSET_ASSERT(around.size() == cavity.sides.size());
  struct Outline {
    Index from, to, behind;
  };
  std::vector<Outline> outline;
  for (const auto& [t, k] : cavity.sides)
    outline.push_back(
        {triangles_[t].corners[(k + 1) % 3], triangles_[t].corners[(k + 2) % 3], triangles_[t].beside[k]});
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const auto& [from, to, behind] = outline[i];
    triangles_[around[i]] = {{from, to, p}, {kNone, kNone, behind}};
    starting_[from] = around[i];
    at_[from] = around[i];
    put_beside(behind, to, from, around[i]);
  }
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Index next = starting_[outline[i].to];
    triangles_[around[i]].beside[0] = next;
    triangles_[next].beside[1] = around[i];
  }
  at_[p] = last_ = around[0];
  return around;
}

std::optional<std::size_t> Triangulation::corner_of(Index triangle, Index point) const {
  for (std::size_t k = 0; k < 3; ++k)
    if (triangles_[triangle].corners[k] == point) return k;
  return std::nullopt;
}

std::size_t Triangulation::corner_towards(Index triangle, Index other) const {
  const auto& beside = triangles_[triangle].beside;
  return static_cast<std::size_t>(std::find(beside.begin(), beside.end(), other) - beside.begin());
}

/// Calls visit(triangle, corner of the point) for each triangle at a point, until it returns true. \pre none of them is
/// at the boundary
template <class Visit>
void Triangulation::turn_around(Index point, Visit&& visit) const {
  Index t = at_[point];
  do {
    const std::size_t k = *corner_of(t, point);
    if (visit(t, k)) return;
    t = triangles_[t].beside[(k + 1) % 3];
  } while (t != at_[point]);
}

/// The side through which a segment leaves the triangle at its start; nothing if it is an edge already.
std::optional<Triangulation::Side> Triangulation::way_out(Index from, Index to) const {
  std::optional<Side> found;
  turn_around(from, [&](Index t, std::size_t k) {
    const Index a = triangles_[t].corners[(k + 1) % 3], b = triangles_[t].corners[(k + 2) % 3];
    if (a == to || b == to) return true;
    const int of_a = side_of(points_[from], points_[to], points_[a]),
              of_b = side_of(points_[from], points_[to], points_[b]);
    if (of_a == 0 && (points_[a] - points_[from]).dot(points_[to] - points_[from]) > 0) fail_through(points_[a]);
    if (of_a < 0 && of_b > 0) found = {t, static_cast<Index>(k)};
    return found.has_value();
  });
  return found;
}

/// The triangles that a segment crosses, and the points to its left and to its right, in its direction.
Triangulation::Crossed Triangulation::crossed_by(Index from, Index to, const Side& entry) const {
  Crossed crossed;
  crossed.triangles = {entry.triangle};
  crossed.right = {triangles_[entry.triangle].corners[(entry.corner + 1) % 3]};
  crossed.left = {triangles_[entry.triangle].corners[(entry.corner + 2) % 3]};
  for (Side at = entry;;) {
    const Index next = triangles_[at.triangle].beside[at.corner];
    const std::size_t k = corner_towards(next, at.triangle);
    const Index apex = triangles_[next].corners[k];
    crossed.triangles.push_back(next);
    if (apex == to) return crossed;
    const int side = side_of(points_[from], points_[to], points_[apex]);
    if (side == 0) fail_through(points_[apex]);
    (side > 0 ? crossed.left : crossed.right).push_back(apex);
    at = {next, static_cast<Index>((k + (side > 0 ? 1 : 2)) % 3)};
  }
}

/// Makes a triangle have another one behind the side between two points, if it is one.
void Triangulation::put_beside(Index triangle, Index from, Index to, Index other) {
  if (triangle == kNone) return;
  Triangle& its = triangles_[triangle];
  for (std::size_t k = 0; k < 3; ++k)
    if (its.corners[(k + 1) % 3] == from && its.corners[(k + 2) % 3] == to) its.beside[k] = other;
}

void Triangulation::enforce(Index from, Index to) {
  const auto entry = way_out(from, to);
  if (!entry) return;
  Crossed crossed = crossed_by(from, to, *entry);
  // What lies behind the outer sides of all these, by the side's ends.
  std::map<std::pair<Index, Index>, Index> behind;
  std::vector<std::uint8_t> is_crossed(triangles_.size(), 0);
  for (const Index t : crossed.triangles) is_crossed[t] = 1;
  for (const Index t : crossed.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (const Index next = triangles_[t].beside[k]; next == kNone || is_crossed[next] == 0)
        behind[{triangles_[t].corners[(k + 1) % 3], triangles_[t].corners[(k + 2) % 3]}] = next;
  std::vector<std::array<Index, 3>> made;
  std::reverse(crossed.left.begin(), crossed.left.end());
  fill_pocket(points_, from, to, crossed.left, made);
  fill_pocket(points_, to, from, crossed.right, made);
  VDB_OFFSET_ASSERT(made.size() == crossed.triangles.size());
  std::map<std::pair<Index, Index>, Side> sides;
  for (std::size_t i = 0; i < made.size(); ++i) {
    const Index t = crossed.triangles[i];
    triangles_[t] = {made[i], {kNone, kNone, kNone}};
    for (Index k = 0; k < 3; ++k) {
      at_[made[i][k]] = t;
      sides[{made[i][(k + 1) % 3], made[i][(k + 2) % 3]}] = {t, k};
    }
  }
  for (const auto& [ends, side] : sides) {
    const auto twin = sides.find({ends.second, ends.first});
    const Index other = twin == sides.end() ? behind.at(ends) : twin->second.triangle;
    triangles_[side.triangle].beside[side.corner] = other;
    put_beside(other, ends.second, ends.first, side.triangle);
  }
}

void Triangulation::cut_to(std::span<const std::array<Index, 2>> segments) {
  for (const auto& [from, to] : segments) enforce(from, to);
  drop_outside(segments);
}

void Triangulation::drop_outside(std::span<const std::array<Index, 2>> segments) {
  std::vector<std::array<Index, 2>> sorted(segments.begin(), segments.end());
  std::sort(sorted.begin(), sorted.end());
  const auto is_segment = [&](Index from, Index to) {
    return std::binary_search(sorted.begin(), sorted.end(), std::array{from, to});
  };
  std::vector<std::uint8_t> is_inside(triangles_.size(), 0);
  std::vector<Index> left;
  const auto reach = [&](Index t) {
    if (is_inside[t] == 0) is_inside[t] = 1, left.push_back(t);
  };
  std::size_t found = 0;
  for (Index t = 0; t < triangles_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (is_segment(triangles_[t].corners[(k + 1) % 3], triangles_[t].corners[(k + 2) % 3])) ++found, reach(t);
  // Of two that cross, the later one has taken the earlier one away.
  if (found != sorted.size()) throw InvalidInput("plane: expected segments that do not cross, got some that do");
  while (!left.empty()) {
    const Index t = left.back();
    left.pop_back();
    for (std::size_t k = 0; k < 3; ++k) {
      Index& next = triangles_[t].beside[k];
      if (is_segment(triangles_[t].corners[(k + 1) % 3], triangles_[t].corners[(k + 2) % 3])) next = kNone;
      else if (next == kNone) throw InvalidInput("plane: expected segments that close, got some that do not");
      else reach(next);
    }
  }
  std::vector<Index> number(triangles_.size(), kNone);
  std::vector<Triangle> kept;
  for (Index t = 0; t < triangles_.size(); ++t)
    if (is_inside[t] != 0) number[t] = static_cast<Index>(kept.size()), kept.push_back(triangles_[t]);
  for (Triangle& triangle : kept)
    for (Index& next : triangle.beside)
      if (next != kNone) next = number[next];
  triangles_ = std::move(kept);
  stamp_.assign(triangles_.size(), 0);
  last_ = 0;
}

void Triangulation::flip(const Side& side) {
  const Index t = side.triangle, u = triangles_[t].beside[side.corner];
  const std::size_t k = side.corner, m = corner_towards(u, t);
  const Index a = triangles_[t].corners[k], b = triangles_[t].corners[(k + 1) % 3],
              c = triangles_[t].corners[(k + 2) % 3], d = triangles_[u].corners[m];
  const Index at_ab = triangles_[t].beside[(k + 2) % 3], at_ca = triangles_[t].beside[(k + 1) % 3],
              at_bd = triangles_[u].beside[(m + 1) % 3], at_dc = triangles_[u].beside[(m + 2) % 3];
  const auto relink = [&](Index of, Index from, Index to) {
    if (of != kNone) triangles_[of].beside[corner_towards(of, from)] = to;
  };
  triangles_[t] = {{a, b, d}, {at_bd, u, at_ab}};
  triangles_[u] = {{a, d, c}, {at_dc, at_ca, t}};
  relink(at_bd, u, t);
  relink(at_ca, t, u);
}

}  // namespace vdb_offset
