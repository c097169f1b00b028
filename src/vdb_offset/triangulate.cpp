#include "vdb_offset/triangulate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vdb_offset {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

struct Point2 {
  double x, y;
};

double cross(Point2 a, Point2 b, Point2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// Twice the area vector, relative to the first corner so that far-away polygons lose no digits.
Vec3d area_vector(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon) {
  Vec3d sum(0.0);
  const Vec3d base = positions[polygon[0]];
  for (std::size_t k = 2; k < polygon.size(); ++k)
    sum += (positions[polygon[k - 1]] - base).cross(positions[polygon[k]] - base);
  return sum;
}

bool fan_turns_one_way(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon, const Vec3d& area) {
  const Vec3d base = positions[polygon[0]];
  for (std::size_t k = 2; k < polygon.size(); ++k)
    if ((positions[polygon[k - 1]] - base).cross(positions[polygon[k]] - base).dot(area) < 0) return false;
  return true;
}

/// True if no corner is farther from the plane of the area vector than a thousandth of the polygon's size.
bool is_flat(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon, const Vec3d& area) {
  double lowest = 0, highest = 0;
  for (const auto v : polygon) {
    const double height = (positions[v] - positions[polygon[0]]).dot(area);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  constexpr double kFlat = 1e-3;
  return highest - lowest <= kFlat * area.length() * std::sqrt(area.length());
}

/// The corners seen along the area vector's largest component, counter-clockwise.
std::vector<Point2> project(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon,
                            const Vec3d& area) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(area[k]) > std::abs(area[axis])) axis = k;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (area[axis] < 0) std::swap(u, v);
  std::vector<Point2> flat;
  flat.reserve(polygon.size());
  for (const auto i : polygon) {
    const Vec3d p = positions[i] - positions[polygon[0]];
    flat.push_back({p[u], p[v]});
  }
  return flat;
}

/// A ring of corners that are still there, as a linked list over the corner numbers.
class EarClipper {
 public:
  explicit EarClipper(std::vector<Point2> flat) : flat_(std::move(flat)), next_(flat_.size()), previous_(flat_.size()) {
    for (std::size_t k = 0; k < flat_.size(); ++k) {
      next_[k] = (k + 1) % flat_.size();
      previous_[k] = (k + flat_.size() - 1) % flat_.size();
    }
  }

  template <class Emit>
  void run(Emit&& emit) {
    std::size_t left = flat_.size(), at = 0, refused = 0;
    while (left > 3) {
      // A whole round without an ear means that the polygon crosses itself: any corner will do then.
      if (is_ear(at) || refused >= left) {
        emit(previous_[at], at, next_[at]);
        next_[previous_[at]] = next_[at];
        previous_[next_[at]] = previous_[at];
        --left;
        refused = 0;
      } else {
        ++refused;
      }
      at = next_[at];
    }
    emit(previous_[at], at, next_[at]);
  }

 private:
  bool is_ear(std::size_t k) const {
    const Point2 a = flat_[previous_[k]], b = flat_[k], c = flat_[next_[k]];
    if (cross(a, b, c) <= 0) return false;
    for (std::size_t m = next_[next_[k]]; m != previous_[k]; m = next_[m]) {
      const Point2 p = flat_[m];
      // Corners that stand on a corner of the ear are hole bridges, which visit a position twice.
      if (same(p, a) || same(p, b) || same(p, c)) continue;
      if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0) return false;
    }
    return true;
  }
  static bool same(Point2 p, Point2 q) { return p.x == q.x && p.y == q.y; }

  std::vector<Point2> flat_;
  std::vector<std::size_t> next_, previous_;
};

}  // namespace

void triangulate(std::span<const Vec3d> positions, std::span<const std::uint32_t> polygon,
                 std::vector<Triangle>& triangles) {
  const auto is_fan = [&](const Vec3d& area) {
    return !is_flat(positions, polygon, area) || fan_turns_one_way(positions, polygon, area);
  };
  if (polygon.size() <= 4 || is_fan(area_vector(positions, polygon))) {
    for (std::size_t k = 2; k < polygon.size(); ++k) triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
    return;
  }
  EarClipper(project(positions, polygon, area_vector(positions, polygon)))
      .run([&](std::size_t a, std::size_t b, std::size_t c) {
        triangles.push_back({polygon[a], polygon[b], polygon[c]});
      });
}

}  // namespace vdb_offset
