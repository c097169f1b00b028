// SPDX-License-Identifier: Apache-2.0
// Points are added where a triangle is too large for its place, one beside an edge whose other side is done: so that
// the new triangle is as round as it can be and of the size that is asked for there (Rebay, Efficient unstructured mesh
// generation by means of Delaunay triangulation and Bowyer-Watson algorithm, 1993). What is left over where fronts met
// is mended by moving points and turning edges.
#include "ground/plane/plane_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

#include "ground/plane/triangulation.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using Index = Triangulation::Index;
using Side = Triangulation::Side;

// A triangle is done if the radius of its circle is at most so many times that of a regular one of the size asked for.
constexpr double kDone = 1.35;
// A point is left out that would come nearer to another, as a share of the size asked for there; or would see a segment
// of the boundary under a larger angle, by its cosine.
constexpr double kNearest = 0.6, kMostAngle = -0.35;
// Rounds of moving points and turning edges.
constexpr int kRounds = 8;

double area_of(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
}

/// 1 for a regular triangle, 0 for a flat one, below 0 if it is turned round.
double roundness(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  const double squares = (a - b).lengthSqr() + (b - c).lengthSqr() + (c - a).lengthSqr();
  return squares > 0 ? 4 * std::numbers::sqrt3 * area_of(a, b, c) / squares : 0;
}

class PlaneMesher {
 public:
  explicit PlaneMesher(const PlaneRegion& region)
      : region_(region), slope_(region.growth - 1), mesh_(region.points), size_(region.points.size(), 0) {
    mesh_.cut_to(region.segments);
    find_sizes();
  }

  PlaneMesh mesh() {
    refine();
    for (int round = 0; round < kRounds; ++round) {
      turn_edges();
      if (!move_points()) break;
    }
    turn_edges();
    PlaneMesh result;
    // Behind the region's own points there are three of a triangle around them.
    const std::size_t given = region_.points.size(), around = 3;
    result.added.assign(mesh_.points().begin() + static_cast<std::ptrdiff_t>(given + around), mesh_.points().end());
    for (const auto& triangle : mesh_.triangles()) {
      auto& corners = result.triangles.emplace_back(triangle.corners);
      for (Index& p : corners)
        if (p >= given) p -= around;
    }
    return result;
  }

 private:
  /// The size at a point of the boundary: that of the shorter of its segments. What is beside it limits it as well.
  void find_sizes() {
    std::vector<double> shortest(region_.points.size(), std::numeric_limits<double>::infinity());
    for (const auto& [a, b] : region_.segments) {
      const double length = (region_.points[a] - region_.points[b]).length();
      for (const Index p : {a, b}) size_[p] += length / 2, shortest[p] = std::min(shortest[p], length);
    }
    for (std::size_t p = 0; p < size_.size(); ++p) size_[p] = std::min(size_[p], 2 * shortest[p]);
    size_.resize(mesh_.points().size(), 0);
  }

  const Vec2d& point(Index p) const { return mesh_.points()[p]; }
  double size_from(Index p, const Vec2d& x) const { return size_[p] + slope_ * (point(p) - x).length(); }
  double size_at(const Vec2d& x, Index triangle) const {
    double size = region_.longest;
    for (const Index p : mesh_.triangles()[triangle].corners) size = std::min(size, size_from(p, x));
    return size;
  }

  struct Circle {
    Vec2d centre;
    double radius;
  };
  Circle circle(Index t) const {
    const Vec2d &a = mesh_.corner(t, 0), b = mesh_.corner(t, 1) - a, c = mesh_.corner(t, 2) - a;
    const double twice = 2 * (b[0] * c[1] - b[1] * c[0]);
    const Vec2d centre =
        Vec2d(c[1] * b.lengthSqr() - b[1] * c.lengthSqr(), b[0] * c.lengthSqr() - c[0] * b.lengthSqr()) / twice;
    return {a + centre, centre.length()};
  }

  /// How many times as large a triangle's circle is as asked for.
  double excess(Index t) const {
    const Vec2d middle = (mesh_.corner(t, 0) + mesh_.corner(t, 1) + mesh_.corner(t, 2)) / 3;
    return circle(t).radius * std::numbers::sqrt3 / size_at(middle, t);
  }

  bool is_done(Index t) const { return excess_[t] <= kDone; }

  /// The shortest side of a triangle whose other side is done, or the boundary; nothing if there is none.
  std::optional<Side> front_side(Index t) const {
    std::optional<Side> found;
    double shortest = std::numeric_limits<double>::infinity();
    for (Index k = 0; k < 3; ++k) {
      const Index next = mesh_.triangles()[t].beside[k];
      if (next != kNone && !is_done(next)) continue;
      const double length = (mesh_.corner(t, k + 1) - mesh_.corner(t, k + 2)).lengthSqr();
      if (length < shortest) shortest = length, found = Side{t, k};
    }
    return found;
  }

  /// Where a point goes that makes a triangle of the size asked for with a side, and lies within the circle of the
  /// triangle behind that side.
  Vec2d place_over(const Side& side) const {
    const Vec2d &a = mesh_.corner(side.triangle, side.corner + 1), &b = mesh_.corner(side.triangle, side.corner + 2);
    const Vec2d middle = (a + b) / 2, along = b - a;
    const double half = along.length() / 2;
    const Vec2d inward = Vec2d(-along[1], along[0]) / (2 * half);
    const double reach = (circle(side.triangle).centre - middle).dot(inward);
    if (!(reach > 0)) return circle(side.triangle).centre;
    const double size = size_at(middle + inward * half, side.triangle);
    const double most = (half * half + reach * reach) / (2 * reach);
    const double radius = std::min(std::max(size / std::numbers::sqrt3, half), std::max(most, half));
    return middle + inward * (radius + std::sqrt(std::max(0.0, radius * radius - half * half)));
  }

  bool has_room(const Vec2d& x, const Triangulation::Cavity& cavity, double& size) const {
    size = region_.longest;
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& [t, k] : cavity.sides) {
      const Vec2d &a = mesh_.corner(t, k + 1), &b = mesh_.corner(t, k + 2);
      size = std::min(size, size_from(mesh_.triangles()[t].corners[(k + 1) % 3], x));
      nearest = std::min(nearest, (a - x).length());
      if (mesh_.triangles()[t].beside[k] != kNone) continue;
      const Vec2d to_a = a - x, to_b = b - x;
      if (to_a.dot(to_b) < kMostAngle * to_a.length() * to_b.length()) return false;
    }
    return nearest >= kNearest * size;
  }

  struct Task {
    double excess;
    Index triangle;
    bool operator<(const Task& other) const {
      return excess != other.excess ? excess < other.excess : triangle > other.triangle;
    }
  };

  void look_at(Index t) {
    excess_.resize(std::max<std::size_t>(excess_.size(), t + 1), 0);
    excess_[t] = excess(t);
  }
  void queue(Index t) {
    if (t != kNone && !is_done(t) && front_side(t)) tasks_.push({excess_[t], t});
  }
  void queue_beside(Index t) {
    for (const Index next : mesh_.triangles()[t].beside) queue(next);
  }

  /// Puts a point beside a triangle's front side, if there is room for one.
  void refine(Index t, const Side& side) {
    const Vec2d x = place_over(side);
    const auto cavity = mesh_.cavity_of(x, t);
    double size = 0;
    if (!cavity || !has_room(x, *cavity, size)) {
      // It is as good as it gets; what is beside it may go on from there.
      excess_[t] = 0;
      return queue_beside(t);
    }
    size_.push_back(size);
    const std::vector<Index> around = mesh_.insert(x, *cavity);
    for (const Index made : around) look_at(made);
    for (const Index made : around) queue(made), queue_beside(made);
  }

  void refine() {
    for (Index t = 0; t < mesh_.triangles().size(); ++t) look_at(t);
    for (Index t = 0; t < mesh_.triangles().size(); ++t) queue(t);
    while (!tasks_.empty()) {
      const Task task = tasks_.top();
      tasks_.pop();
      if (excess_[task.triangle] != task.excess || is_done(task.triangle)) continue;
      if (const auto side = front_side(task.triangle)) refine(task.triangle, *side);
    }
  }

  double roundness_of(Index t) const { return roundness(mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2)); }

  /// Turns edges where the worse of the two triangles beside them gets rounder by it.
  void turn_edges() {
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (Index t = 0; t < mesh_.triangles().size(); ++t)
        for (Index k = 0; k < 3; ++k) {
          const Index u = mesh_.triangles()[t].beside[k];
          if (u == kNone || u < t) continue;
          const std::size_t m = mesh_.corner_towards(u, t);
          const Vec2d &a = mesh_.corner(t, k), &b = mesh_.corner(t, k + 1), &c = mesh_.corner(t, k + 2),
                      &d = mesh_.corner(u, m);
          const double before = std::min(roundness_of(t), roundness_of(u)),
                       after = std::min(roundness(a, b, d), roundness(a, d, c));
          // By more than rounding, or two would be turned for ever.
          if (after <= before + 1e-9) continue;
          mesh_.flip({t, k});
          goes_on = true;
        }
    }
  }

  /// Moves points that were added towards the middle of those around them, where the worst triangle there gets rounder.
  bool move_points() {
    const std::size_t first = region_.points.size() + 3;
    std::vector<std::vector<Index>> around(mesh_.points().size() - first);
    for (Index t = 0; t < mesh_.triangles().size(); ++t)
      for (const Index p : mesh_.triangles()[t].corners)
        if (p >= first) around[p - first].push_back(t);
    bool has_moved = false;
    for (std::size_t i = 0; i < around.size(); ++i) has_moved |= move_point(static_cast<Index>(first + i), around[i]);
    return has_moved;
  }

  bool move_point(Index p, const std::vector<Index>& around) {
    const auto worst = [&] {
      double least = std::numeric_limits<double>::infinity();
      for (const Index t : around) least = std::min(least, roundness_of(t));
      return least;
    };
    // What makes a regular triangle of each side that is across from the point, weighted towards short ones.
    Vec2d sum(0.0);
    double weights = 0;
    for (const Index t : around) {
      const auto& corners = mesh_.triangles()[t].corners;
      const auto k = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), p) - corners.begin());
      const Vec2d &a = mesh_.corner(t, k + 1), &b = mesh_.corner(t, k + 2), along = b - a;
      const Vec2d ideal = (a + b) / 2 + Vec2d(-along[1], along[0]) * (std::numbers::sqrt3 / 2);
      const double weight = 1 / std::max(along.lengthSqr(), 1e-300);
      sum += ideal * weight;
      weights += weight;
    }
    const Vec2d before = point(p), aim = sum / weights;
    const double worst_before = worst();
    for (const double share : {1.0, 0.5, 0.25}) {
      mesh_.move(p, before + (aim - before) * share);
      if (worst() > worst_before + 1e-6) return true;
    }
    mesh_.move(p, before);
    return false;
  }

  const PlaneRegion& region_;
  double slope_;
  Triangulation mesh_;
  std::vector<double> size_;    // of each point
  std::vector<double> excess_;  // of each triangle; 0: it stays as it is
  std::priority_queue<Task> tasks_;
};

}  // namespace

PlaneMesh mesh_plane(const PlaneRegion& region) { return PlaneMesher(region).mesh(); }

}  // namespace vdb_offset
