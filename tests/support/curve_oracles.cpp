// SPDX-License-Identifier: Apache-2.0
#include "support/curve_oracles.h"
#include "vdb_offset/polygons.h"

#include <gmpxx.h>

#include <algorithm>
#include <limits>

namespace vdb_offset::test {
namespace {

/// The sign of the area that three points span, without rounding.
int turn(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const mpq_class ax(a[0]), ay(a[1]);
  return sgn(
      mpq_class((mpq_class(b[0]) - ax) * (mpq_class(c[1]) - ay) - (mpq_class(b[1]) - ay) * (mpq_class(c[0]) - ax)));
}

struct Edge {
  Vec3d a, b;
  bool misses(const Edge& other) const {
    for (int k = 0; k < 2; ++k)
      if (std::max(a[k], b[k]) < std::min(other.a[k], other.b[k]) ||
          std::max(other.a[k], other.b[k]) < std::min(a[k], b[k]))
        return true;
    return false;
  }
  bool meets(const Edge& other) const {
    if (misses(other)) return false;
    return turn(a, b, other.a) * turn(a, b, other.b) <= 0 && turn(other.a, other.b, a) * turn(other.a, other.b, b) <= 0;
  }
};

}  // namespace

Curves curve_through(const std::vector<Vec3d>& points, bool closed) {
  Curves curves;
  curves.positions = points;
  for (std::uint32_t p = 0; p < points.size(); ++p) curves.corners.push_back(p);
  if (closed) curves.corners.push_back(0);
  curves.close_face();
  return curves;
}

Curves comb(int teeth, double gap, double step) {
  std::vector<Vec3d> points;
  const auto to = [&](const Vec3d& end) {
    const Vec3d from = points.back();
    const int count = std::max(1, static_cast<int>((end - from).length() / step));
    for (int i = 1; i <= count; ++i) points.push_back(from + (end - from) * (static_cast<double>(i) / count));
  };
  points.emplace_back(0, 0, 0);
  for (int t = 0; t < teeth; ++t) {
    to({t + 1 - gap, 0, 0});
    to({t + 1 - gap, 1, 0});
    to({t + 1.0, 1, 0});
    to({t + 1.0, 0, 0});
  }
  to({teeth + 0.5, 0, 0});
  to({teeth + 0.5, 2, 0});
  to({0, 2, 0});
  to({0, 0.1, 0});
  return curve_through(points, true);
}

std::set<std::pair<std::size_t, std::size_t>> meeting(const Curves& curves, const std::vector<Vec3d>& positions) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
  for (std::size_t c = 0; c < curves.face_count(); ++c)
    for (std::size_t i = 1; i < curves.view().face(c).size(); ++i)
      ends.emplace_back(curves.view().face(c)[i - 1], curves.view().face(c)[i]);
  const auto same = [&](std::uint32_t p, std::uint32_t q) { return curves.positions[p] == curves.positions[q]; };
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t s = 0; s < ends.size(); ++s)
    for (std::size_t t = s + 1; t < ends.size(); ++t) {
      const auto [a, b] = ends[s];
      const auto [c, d] = ends[t];
      if (same(a, c) || same(a, d) || same(b, c) || same(b, d)) continue;
      if (Edge{positions[a], positions[b]}.meets({positions[c], positions[d]})) pairs.emplace(s, t);
    }
  return pairs;
}

std::size_t new_crossings(const Curves& curves, const std::vector<Vec3d>& positions) {
  const auto before = meeting(curves, curves.positions), after = meeting(curves, positions);
  return static_cast<std::size_t>(
      std::count_if(after.begin(), after.end(), [&](const auto& pair) { return !before.contains(pair); }));
}

double distance_to(const Curves& curves, const Vec3d& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < curves.face_count(); ++c) {
    const auto curve = curves.view().face(c);
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const Vec3d &a = curves.positions[curve[i > 0 ? i - 1 : 0]], &b = curves.positions[curve[i]];
      const double length2 = (b - a).lengthSqr();
      const double t = length2 > 0 ? std::clamp((x - a).dot(b - a) / length2, 0.0, 1.0) : 0;
      least = std::min(least, (x - a - (b - a) * t).length());
    }
  }
  return least;
}

}  // namespace vdb_offset::test
