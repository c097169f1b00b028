#include "vdb_offset/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vdb_offset {
namespace {

/// Squared distance of two segments (Ericson, Real-Time Collision Detection, 2005, 5.1.9).
double squared_segment_distance(const Vec3d& p1, const Vec3d& q1, const Vec3d& p2, const Vec3d& q2) {
  const Vec3d d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const double a = d1.lengthSqr(), e = d2.lengthSqr(), f = d2.dot(r);
  double s = 0, t = 0;
  if (a > 0 && e > 0) {
    const double c = d1.dot(r), b = d1.dot(d2), denominator = a * e - b * b;
    if (denominator > 0) s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
    t = (b * s + f) / e;
    if (t < 0) s = std::clamp(-c / a, 0.0, 1.0);
    else if (t > 1) s = std::clamp((b - c) / a, 0.0, 1.0);
    t = std::clamp(t, 0.0, 1.0);
  } else if (a > 0) {
    s = std::clamp(-d1.dot(r) / a, 0.0, 1.0);
  } else if (e > 0) {
    t = std::clamp(f / e, 0.0, 1.0);
  }
  return (r + d1 * s - d2 * t).lengthSqr();
}

/// Whether a segment runs through a triangle's inside.
bool pierces(const Vec3d& p, const Vec3d& q, const TriangleCorners& triangle) {
  const Vec3d u = triangle[1] - triangle[0], v = triangle[2] - triangle[0], n = u.cross(v);
  const double at_p = n.dot(p - triangle[0]), at_q = n.dot(q - triangle[0]);
  if (at_p * at_q > 0 || at_p == at_q) return false;
  const Vec3d x = p + (q - p) * (at_p / (at_p - at_q));
  for (std::size_t k = 0; k < 3; ++k)
    if (n.dot((triangle[(k + 1) % 3] - triangle[k]).cross(x - triangle[k])) < 0) return false;
  return true;
}

FloatBox box_around(const TriangleCorners& corners, double margin) {
  FloatBox box;
  for (const Vec3d& p : corners)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = p[static_cast<int>(k)], rounding = std::abs(x) * 0x1p-22;
      box.lower[k] = std::min(box.lower[k], static_cast<float>(x - margin - rounding));
      box.upper[k] = std::max(box.upper[k], static_cast<float>(x + margin + rounding));
    }
  return box;
}

TriangleCorners corners_of(const Surface& surface, std::size_t t) {
  const auto& [a, b, c] = surface.triangles[t];
  return {surface.vertices[a], surface.vertices[b], surface.vertices[c]};
}

}  // namespace

double distance_between(const TriangleCorners& a, const TriangleCorners& b) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    if (pierces(a[i], a[(i + 1) % 3], b) || pierces(b[i], b[(i + 1) % 3], a)) return 0;
    least = std::min({least, closest_on_triangle(a[i], b[0], b[1], b[2]).squared_distance,
                      closest_on_triangle(b[i], a[0], a[1], a[2]).squared_distance});
    for (std::size_t j = 0; j < 3; ++j)
      least = std::min(least, squared_segment_distance(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return std::sqrt(least);
}

ClearanceFinder::ClearanceFinder(const Obstacles& obstacles) : obstacles_(obstacles) {
  const Surface& surface = obstacles.query.surface();
  tree_.build(surface.triangles.size(),
              [&](std::size_t t) { return box_around(corners_of(surface, t), obstacles_.clearance); });
}

bool ClearanceFinder::is_crowded(const TriangleCorners& triangle) const {
  const double least = obstacles_.clearance * (1 - 1e-6);
  if (!(least > 0)) return false;
  bool crowded = false;
  tree_.for_each_overlap(box_around(triangle, 0), [&](std::size_t t) {
    crowded = crowded || distance_between(triangle, corners_of(obstacles_.query.surface(), t)) < least;
  });
  return crowded;
}

}  // namespace vdb_offset
