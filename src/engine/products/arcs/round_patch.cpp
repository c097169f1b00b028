// SPDX-License-Identifier: Apache-2.0
#include "products/arcs/round_patch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "products/arcs/slerp.h"

namespace vdb_offset {
namespace {

/// Points of a ring, and where each lies along it, from 0 to below 1.
struct Ring {
  std::vector<std::uint32_t> point;
  std::vector<double> at;

  double next(std::size_t i) const { return i + 1 < at.size() ? at[i + 1] : 1; }
};

class PatchMaker {
 public:
  PatchMaker(std::span<const Vec3d> loop, const Vec3d& middle, double step)
      : loop_(loop), middle_(middle), step_(step), next_(static_cast<std::uint32_t>(loop.size())) {}

  RoundPatch make() {
    double farthest = 0;
    for (const Vec3d& direction : loop_) farthest = std::max(farthest, angle_between(direction, middle_));
    Ring outer = ring_of(loop_);
    for (std::uint32_t i = 0; i < loop_.size(); ++i) outer.point.push_back(i);
    if (loop_.size() == 3 && farthest <= step_ / std::sqrt(3.0)) {
      patch_.triangles.push_back({0, 1, 2});
      return std::move(patch_);
    }
    const auto rings = static_cast<std::size_t>(std::ceil(farthest / (kRingShare * step_)));
    for (std::size_t r = 1; r < rings; ++r) {
      Ring inner = add_ring(static_cast<double>(r) / static_cast<double>(rings));
      join(outer, inner);
      outer = std::move(inner);
    }
    const std::uint32_t tip = add(middle_);
    for (std::size_t i = 0; i < outer.point.size(); ++i)
      patch_.triangles.push_back({outer.point[i], outer.point[(i + 1) % outer.point.size()], tip});
    flip();
    return std::move(patch_);
  }

 private:
  // How far apart rings are, and points on them at most, in steps. Measured: see docs/dev/tuning.md.
  static constexpr double kRingShare = 0.6, kRingStep = 0.85;
  // Rounds of flips; reasoned: each flip brings the patch nearer to the sphere, and few are needed. For rounding.
  static constexpr int kMostFlips = 100;

  const Vec3d& at(std::uint32_t i) const { return i < loop_.size() ? loop_[i] : patch_.inner[i - loop_.size()]; }

  /// Flips edges inside of the patch for as long as that brings it nearer to the sphere: until it is part of the hull
  /// of its points, which is their Delaunay triangulation on the sphere.
  void flip() {
    for (int round = 0; round < kMostFlips; ++round)
      if (!flip_once()) return;
  }
  using Side = std::pair<std::uint32_t, std::uint32_t>;
  bool flip_once() {
    std::map<Side, std::uint32_t> left_of;
    for (std::uint32_t t = 0; t < patch_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) left_of[{patch_.triangles[t][k], patch_.triangles[t][(k + 1) % 3]}] = t;
    std::vector<std::uint8_t> is_done(patch_.triangles.size(), 0);
    bool has_flipped = false;
    for (std::uint32_t t = 0; t < patch_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3 && !is_done[t]; ++k) {
        const std::uint32_t a = patch_.triangles[t][k], b = patch_.triangles[t][(k + 1) % 3];
        const auto other = left_of.find({b, a});
        if (other == left_of.end() || is_done[other->second]) continue;
        if (!flip_side(t, other->second, k, left_of)) continue;
        is_done[t] = is_done[other->second] = 1;
        has_flipped = true;
      }
    return has_flipped;
  }
  /// Flips side k of a triangle, beyond which another one lies, if that is nearer to the sphere.
  bool flip_side(std::uint32_t triangle, std::uint32_t other, std::size_t k,
                 const std::map<Side, std::uint32_t>& left_of) {
    auto &t = patch_.triangles[triangle], &u = patch_.triangles[other];
    const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
    const std::uint32_t d = u[0] != a && u[0] != b ? u[0] : u[1] != a && u[1] != b ? u[1] : u[2];
    if (left_of.contains({c, d}) || left_of.contains({d, c}) || !is_above(a, b, c, d)) return false;
    t = {a, d, c};
    u = {d, b, c};
    return true;
  }
  /// Whether a point lies beyond the plane of three others, as seen from the centre.
  bool is_above(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    constexpr double kFlat = 1e-12;  // of a volume; reasoned: rounding
    const Vec3d normal = (at(b) - at(a)).cross(at(c) - at(a));
    const double towards = normal.dot(at(a));
    return (towards > 0 ? 1 : -1) * normal.dot(at(d) - at(a)) > kFlat;
  }

  std::uint32_t add(const Vec3d& direction) {
    patch_.inner.push_back(direction);
    return next_++;
  }

  /// A ring's places by length, from its first point.
  static Ring ring_of(std::span<const Vec3d> directions) {
    Ring ring;
    double length = 0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      ring.at.push_back(length);
      length += angle_between(directions[i], directions[(i + 1) % directions.size()]);
    }
    for (double& at : ring.at) at /= length;
    return ring;
  }

  /// The loop, drawn in towards the middle by a share, with as many points as its length asks for.
  Ring add_ring(double share) {
    std::vector<Vec3d> drawn_in;
    double length = 0;
    for (const Vec3d& direction : loop_) drawn_in.push_back(slerp(direction, middle_, share));
    for (std::size_t i = 0; i < drawn_in.size(); ++i)
      length += angle_between(drawn_in[i], drawn_in[(i + 1) % drawn_in.size()]);
    const auto count = static_cast<std::size_t>(std::max(3.0, std::ceil(length / (kRingStep * step_))));
    const Ring along = ring_of(drawn_in);
    Ring ring;
    std::size_t side = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double at = static_cast<double>(i) / static_cast<double>(count);
      while (along.next(side) <= at && side + 1 < drawn_in.size()) ++side;
      const double rest = (at - along.at[side]) / (along.next(side) - along.at[side]);
      ring.at.push_back(at);
      ring.point.push_back(add(slerp(drawn_in[side], drawn_in[(side + 1) % drawn_in.size()], rest)));
    }
    return ring;
  }

  /// Triangles between two rings.
  void join(const Ring& outer, const Ring& inner) {
    const std::size_t n = outer.point.size(), m = inner.point.size();
    const auto at = [](const Ring& ring, std::size_t i) { return ring.point[i < ring.point.size() ? i : 0]; };
    for (std::size_t i = 0, k = 0; i < n || k < m;) {
      const std::uint32_t a = at(outer, i), b = at(inner, k);
      if (k == m || (i < n && outer.next(i) <= inner.next(k))) patch_.triangles.push_back({a, at(outer, ++i), b});
      else patch_.triangles.push_back({a, at(inner, ++k), b});
    }
  }

  std::span<const Vec3d> loop_;
  Vec3d middle_;
  double step_;
  std::uint32_t next_;
  RoundPatch patch_;
};

}  // namespace

std::optional<RoundPatch> round_patch(std::span<const Vec3d> loop, double step, int side) {
  // Reasoned: rounding; a loop that is seen at so small an angle covers nothing.
  constexpr double kSeen = 1e-9;
  Vec3d middle(0.0);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3d& next = loop[(i + 1) % loop.size()];
    middle += (loop[i] + next) * angle_between(loop[i], next);
  }
  if (!(middle.normalize())) return std::nullopt;
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (!(side * middle.dot(loop[i].cross(loop[(i + 1) % loop.size()])) > kSeen) || middle.dot(loop[i]) <= 0)
      return std::nullopt;
  return PatchMaker(loop, middle, step).make();
}

}  // namespace vdb_offset
