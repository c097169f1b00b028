#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vdb_offset/surface.h"

namespace vdb_offset {

/// The triangles around a vertex as points near it see them, two at once. Slivers are not among them: their areas would
/// lose digits.
///
/// With y the way from the vertex to a point, the squared distance to any place p of a triangle is |y|^2 less a gain of
/// 2 p.y - p.p; the closest place is the one that gains most: y's foot where that is inside, or a place on an edge.
class VertexFan {
 public:
  void begin(const Surface& surface, std::uint32_t vertex) {
    corner_ = surface.vertices[vertex];
    size_ = believed_ = 0;
    for (const auto t : surface.triangles_around(vertex)) add(surface, t, vertex);
    // An odd one is its own neighbour.
    if (size_ % 2 != 0) {
      const std::size_t size = size_;
      add(surface, pairs_[size_ / 2].triangle[0], vertex);
      size_ = size;
    }
  }

  bool has(std::uint32_t triangle) const {
    return std::any_of(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(pair_count()),
                       [&](const Pair& p) { return p.triangle[0] == triangle || p.triangle[1] == triangle; });
  }

  /// The way to x from the closest place of all these triangles, of which the vertex is one even if there is no other.
  Vec3d find_away_from(const Vec3d& x) {
    const Vec3d y = x - corner_;
    Place best;
    for (std::size_t i = 0; i < pair_count(); ++i) {
      const Place found = closest_of(pairs_[i], y);
      if (!(found.gain > best.gain)) continue;
      best = found;
      believed_ = i;
    }
    return size_ == 0 ? y : y - pairs_[believed_].at(best);
  }
  /// The same if the closest one is where it was found last, and never a shorter way.
  Vec3d away_from(const Vec3d& x) const {
    const Vec3d y = x - corner_;
    return size_ == 0 ? y : y - pairs_[believed_].at(closest_of(pairs_[believed_], y));
  }

 private:
  using Two = double __attribute__((vector_size(16)));

  /// A place in one of two triangles, by its shares of the edges at the vertex; and what it gains.
  struct Place {
    double gain = 0, along_b = 0, along_c = 0;
    std::size_t lane = 0;
  };
  /// Two triangles, by their edges b and c from the vertex, the third one e, and products of these.
  struct Pair {
    Two b[3], c[3], bb, cc, ee, bc, over_bb, over_cc, over_ee, over_area;
    std::uint32_t triangle[2];

    Vec3d at(const Place& place) const {
      Vec3d from_vertex;
      for (int k = 0; k < 3; ++k) from_vertex[k] = b[k][place.lane] * place.along_b + c[k][place.lane] * place.along_c;
      return from_vertex;
    }
  };

  std::size_t pair_count() const { return (size_ + 1) / 2; }

  void add(const Surface& surface, std::uint32_t triangle, std::uint32_t vertex) {
    constexpr double kSliver = 1e-6;
    const auto& t = surface.triangles[triangle];
    const std::size_t k = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2, lane = size_ % 2;
    const Vec3d b = surface.vertices[t[(k + 1) % 3]] - corner_, c = surface.vertices[t[(k + 2) % 3]] - corner_;
    const double bb = b.dot(b), cc = c.dot(c), bc = b.dot(c), ee = (c - b).lengthSqr(), area = bb * cc - bc * bc;
    const double longest = std::max({bb, cc, ee});
    if (!(area > kSliver * longest * longest)) return;
    if (size_ / 2 == pairs_.size()) pairs_.emplace_back();
    Pair& pair = pairs_[size_++ / 2];
    for (int axis = 0; axis < 3; ++axis) {
      pair.b[axis][lane] = b[axis];
      pair.c[axis][lane] = c[axis];
    }
    pair.bb[lane] = bb;
    pair.cc[lane] = cc;
    pair.ee[lane] = ee;
    pair.bc[lane] = bc;
    pair.over_bb[lane] = 1 / bb;
    pair.over_cc[lane] = 1 / cc;
    pair.over_ee[lane] = 1 / ee;
    pair.over_area[lane] = 1 / area;
    pair.triangle[lane] = triangle;
  }

  static Place closest_of(const Pair& pair, const Vec3d& y) {
    constexpr Two kZero{}, kOne{1, 1};
    const Two by = pair.b[0] * y[0] + pair.b[1] * y[1] + pair.b[2] * y[2];
    const Two cy = pair.c[0] * y[0] + pair.c[1] * y[1] + pair.c[2] * y[2];
    const Two foot_b = (by * pair.cc - cy * pair.bc) * pair.over_area;
    const Two foot_c = (cy * pair.bb - by * pair.bc) * pair.over_area;
    const auto inside = (foot_b > kZero) & (foot_c > kZero) & (foot_b + foot_c < kOne);
    const Two on_b = clamped(by * pair.over_bb), on_c = clamped(cy * pair.over_cc);
    const Two gain_b = on_b * (by + by - on_b * pair.bb), gain_c = on_c * (cy + cy - on_c * pair.cc);
    const auto from_b = gain_b > gain_c;
    const Two gain_bc = greater(gain_b, gain_c);
    // On e from b's end, which gains 2 b.y - b.b itself.
    const Two ey = cy - by - pair.bc + pair.bb, on_e = clamped(ey * pair.over_ee);
    const Two gain_e = by + by - pair.bb + on_e * (ey + ey - on_e * pair.ee);
    const auto from_e = gain_e > gain_bc;
    const Two gain = inside ? foot_b * by + foot_c * cy : greater(gain_e, gain_bc);
    const Two along_b = inside ? foot_b : (from_e ? kOne - on_e : (from_b ? on_b : kZero));
    const Two along_c = inside ? foot_c : (from_e ? on_e : (from_b ? kZero : on_c));
    const std::size_t lane = gain[1] > gain[0] ? 1 : 0;
    return {gain[lane], along_b[lane], along_c[lane], lane};
  }
  static Two greater(const Two& a, const Two& b) { return a > b ? a : b; }
  static Two clamped(const Two& share) {
    constexpr Two kZero{}, kOne{1, 1};
    const Two least = greater(share, kZero);
    return least < kOne ? least : kOne;
  }

  Vec3d corner_{0.0};
  std::size_t size_ = 0, believed_ = 0;
  std::vector<Pair> pairs_;
};

}  // namespace vdb_offset
