// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ground/numbers/double_lanes.h"
#include "space/surface/surface.h"

namespace vdb_offset {

/// Distances to the triangles around a vertex, for points near it; two triangles at once. Slivers are left out, as
/// their areas would lose digits.
///
/// With y the vector from the vertex to a point, the squared distance to any point p of a triangle, seen from the
/// vertex, is |y|^2 less a gain of 2 p.y - p.p; the closest point is the one with the largest gain: y's foot where that
/// is inside, or a point on an edge.
class VertexFan {
 public:
  void begin(const Surface& surface, std::uint32_t vertex) {
    corner_ = surface.vertices[vertex];
    size_ = believed_ = 0;
    for (const auto t : surface.triangles_around(vertex)) add(surface, t, vertex);
    whole_ = size_ == surface.triangles_around(vertex).size();
    // If the number is odd, the last triangle takes both lanes.
    if (size_ % 2 != 0) {
      const std::size_t size = size_;
      add(surface, pairs_[size_ / 2].triangle[0], vertex);
      size_ = size;
    }
  }

  /// Whether no triangle around the vertex is a sliver.
  bool whole() const { return whole_; }
  bool has(std::uint32_t triangle) const {
    return std::any_of(
        pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(pair_count()),
        [&](const TrianglePairLanes& of) { return of.triangle[0] == triangle || of.triangle[1] == triangle; });
  }

  /// The vector to x from the closest point of all these triangles, or from the vertex if there are none.
  Vec3d find_away_from(const Vec3d& x) {
    const Vec3d y = x - corner_;
    Point best;
    for (std::size_t i = 0; i < pair_count(); ++i) {
      const Point found = closest_of(pairs_[i], y);
      if (!(found.gain > best.gain)) continue;
      best = found;
      believed_ = i;
    }
    return size_ == 0 ? y : y - pairs_[believed_].at(best);
  }
  /// The vector to x from the closest point of the two triangles among which find_away_from() found it last: never
  /// shorter than that of all triangles.
  Vec3d away_from(const Vec3d& x) const {
    const Vec3d y = x - corner_;
    return size_ == 0 ? y : y - pairs_[believed_].at(closest_of(pairs_[believed_], y));
  }

 private:
  /// A point in one of two triangles, by its shares of the edges at the vertex; and its gain.
  struct Point {
    double gain = 0, along_b = 0, along_c = 0;
    std::size_t lane = 0;
  };
  /// Two triangles, by their edges b and c from the vertex, the third one e, and products of these.
  struct TrianglePairLanes {
    Vec3Of<double2> b, c;
    double2 bb, cc, ee, bc, over_bb, over_cc, over_ee, over_area;
    std::uint32_t triangle[2];

    Vec3d at(const Point& point) const {
      const std::size_t i = point.lane;
      return {b.x[i] * point.along_b + c.x[i] * point.along_c, b.y[i] * point.along_b + c.y[i] * point.along_c,
              b.z[i] * point.along_b + c.z[i] * point.along_c};
    }
  };

  std::size_t pair_count() const { return (size_ + 1) / 2; }

  void add(const Surface& surface, std::uint32_t triangle, std::uint32_t vertex) {
    constexpr double kSliver = 1e-6;  // squared sine, as in closest_on_triangle()
    const auto& t = surface.triangles[triangle];
    const std::size_t k = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2, lane = size_ % 2;
    const Vec3d b = surface.vertices[t[(k + 1) % 3]] - corner_, c = surface.vertices[t[(k + 2) % 3]] - corner_;
    const double bb = b.dot(b), cc = c.dot(c), bc = b.dot(c), ee = (c - b).lengthSqr(), area = bb * cc - bc * bc;
    const double longest = std::max({bb, cc, ee});
    if (!(area > kSliver * longest * longest)) return;
    if (size_ / 2 == pairs_.size()) pairs_.emplace_back();
    TrianglePairLanes& pair = pairs_[size_++ / 2];
    pair.triangle[lane] = triangle;
    pair.b.set(lane, b);
    pair.c.set(lane, c);
    pair.bb[lane] = bb;
    pair.cc[lane] = cc;
    pair.ee[lane] = ee;
    pair.bc[lane] = bc;
    pair.over_bb[lane] = 1 / bb;
    pair.over_cc[lane] = 1 / cc;
    pair.over_ee[lane] = 1 / ee;
    pair.over_area[lane] = 1 / area;
  }

  static Point closest_of(const TrianglePairLanes& of, const Vec3d& y) {
    constexpr double2 kZero{}, kOne{1, 1};
    const Vec3Of<double2> both_y = both(y, y);
    const double2 by = of.b.dot(both_y), cy = of.c.dot(both_y);
    // Where y leads away from both edges, no point gains anything.
    if (!(std::max({by[0], by[1], cy[0], cy[1]}) > 0)) return {};
    const double2 foot_b = (by * of.cc - cy * of.bc) * of.over_area, foot_c = (cy * of.bb - by * of.bc) * of.over_area;
    const auto inside = (foot_b > kZero) & (foot_c > kZero) & (foot_b + foot_c < kOne);
    const double2 on_b = clamped(by * of.over_bb), on_c = clamped(cy * of.over_cc);
    const double2 gain_b = on_b * (by + by - on_b * of.bb), gain_c = on_c * (cy + cy - on_c * of.cc);
    const auto from_b = gain_b > gain_c;
    const double2 gain_bc = greater(gain_b, gain_c);
    // On e from b's end, which gains 2 b.y - b.b itself.
    const double2 ey = cy - by - of.bc + of.bb, on_e = clamped(ey * of.over_ee);
    const double2 gain_e = by + by - of.bb + on_e * (ey + ey - on_e * of.ee);
    const auto from_e = gain_e > gain_bc;
    const double2 gain = inside ? foot_b * by + foot_c * cy : greater(gain_e, gain_bc);
    const double2 along_b = inside ? foot_b : (from_e ? kOne - on_e : (from_b ? on_b : kZero));
    const double2 along_c = inside ? foot_c : (from_e ? on_e : (from_b ? kZero : on_c));
    const std::size_t lane = gain[1] > gain[0] ? 1 : 0;
    return {gain[lane], along_b[lane], along_c[lane], lane};
  }
  static double2 clamped(const double2& share) { return lesser(double2{1, 1}, greater(double2{}, share)); }

  Vec3d corner_{0.0};
  std::size_t size_ = 0, believed_ = 0;
  bool whole_ = true;
  std::vector<TrianglePairLanes> pairs_;
};

}  // namespace vdb_offset
