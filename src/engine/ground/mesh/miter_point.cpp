// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/miter_point.h"

#include <openvdb/math/Mat3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace vdb_offset {
namespace {

// Share of squared lengths by which a normal may reach less far than the nearest point of the hull. Reasoned: rounding.
constexpr double kHullRounding = 1e-14;
// Share by which planes that touch one cone may be off it. Reasoned: far above rounding, far below the 1e-9 that is
// promised of faces.
constexpr double kConcurrent = 1e-11;
// Least share of the normals' squares along each axis with which all planes say where they meet: of two planes 4
// degrees apart, and a third one across; below, what they say is mostly how finely a curved flank is divided. Not
// measured.
constexpr double kWellPlaced = 1e-3;
// How many times as far as the smallest x the point may be in which all planes meet. Not measured.
constexpr double kMuchFarther = 4;

/// The point nearest to the origin of a convex hull in space, by Wolfe's method: up to three corners that it lies
/// between, and another one in exchange for as long as one is nearer.
class NearestInHull {
 public:
  explicit NearestInHull(std::span<const Vec3d> corners) : corners_(corners) {
    std::size_t next = nearest_corner();
    // Each turn comes nearer, so that no set of corners comes twice; rounding alone could make one.
    for (std::size_t turn = 0; turn < kMostTurns && add(next); ++turn) {
      if (count_ == kMostCorners) {
        point_ = Vec3d(0.0);  // it lies between four corners
        return;
      }
      next = foremost();
      if (corners_[next].dot(point_) >= point_.lengthSqr() * (1 - kHullRounding) || is_in_set(next)) return;
    }
  }

  const Vec3d& point() const { return point_; }

 private:
  // Not measured: a vertex with as many planes as this takes fewer.
  static constexpr std::size_t kMostTurns = 1000;
  static constexpr std::size_t kMostCorners = 4;

  std::size_t nearest_corner() const {
    const auto nearest = std::min_element(corners_.begin(), corners_.end(),
                                          [](const Vec3d& a, const Vec3d& b) { return a.lengthSqr() < b.lengthSqr(); });
    return static_cast<std::size_t>(nearest - corners_.begin());
  }
  /// The corner that is nearest in the direction of the point.
  std::size_t foremost() const {
    const auto nearest = std::min_element(corners_.begin(), corners_.end(), [&](const Vec3d& a, const Vec3d& b) {
      return a.dot(point_) < b.dot(point_);
    });
    return static_cast<std::size_t>(nearest - corners_.begin());
  }

  bool is_in_set(std::size_t corner) const {
    const auto end = set_.begin() + static_cast<std::ptrdiff_t>(count_);
    return std::find(set_.begin(), end, corner) != end;
  }

  /// Adds a corner, and moves the point to the nearest one between the corners. False if the corner lies on the flat of
  /// the others, but for rounding.
  bool add(std::size_t corner) {
    set_[count_] = corner;
    weight_[count_] = count_ == 0 ? 1 : 0;
    ++count_;
    for (;;) {
      std::array<double, kMostCorners> wanted{};
      if (!nearest_of_flat(wanted)) return false;
      const std::size_t before = count_;
      move_towards(wanted);
      if (count_ == before) return true;
    }
  }

  /// Moves the point towards wanted weights, up to where it would leave the hull: then the corner is left out that it
  /// would leave behind.
  void move_towards(const std::array<double, kMostCorners>& wanted) {
    double step = 1;
    std::size_t leaving = count_;
    for (std::size_t i = 0; i < count_; ++i) {
      if (wanted[i] > 0) continue;
      const double most = weight_[i] > wanted[i] ? weight_[i] / (weight_[i] - wanted[i]) : 0;
      if (leaving == count_ || most < step) step = most, leaving = i;
    }
    for (std::size_t i = 0; i < count_; ++i) weight_[i] += (wanted[i] - weight_[i]) * step;
    if (leaving < count_) leave_out(leaving);
    find_point();
  }

  void leave_out(std::size_t i) {
    for (; i + 1 < count_; ++i) {
      set_[i] = set_[i + 1];
      weight_[i] = weight_[i + 1];
    }
    --count_;
  }

  void find_point() {
    double sum = 0;
    for (std::size_t i = 0; i < count_; ++i) sum += weight_[i];
    point_ = Vec3d(0.0);
    for (std::size_t i = 0; i < count_; ++i) point_ += corners_[set_[i]] * (weight_[i] / sum);
  }

  /// Weights, of sum 1, of the point nearest to the origin of the flat through the corners; false if they do not span
  /// it.
  bool nearest_of_flat(std::array<double, kMostCorners>& weight) const {
    const auto corner = [&](std::size_t i) { return corners_[set_[i]]; };
    if (count_ == 1) {
      weight[0] = 1;
      return true;
    }
    const Vec3d a = corner(0), ab = corner(1) - a, ac = count_ > 2 ? corner(2) - a : Vec3d(0.0);
    if (count_ == 2) {
      if (!(ab.lengthSqr() > 0)) return false;
      weight[1] = -a.dot(ab) / ab.lengthSqr();
      weight[0] = 1 - weight[1];
      return true;
    }
    const Vec3d across = ab.cross(ac);
    if (count_ == 3) {
      const double area = across.lengthSqr();
      if (!(area > kHullRounding * kHullRounding)) return false;
      weight[1] = -across.dot(a.cross(ac)) / area;
      weight[2] = -across.dot(ab.cross(a)) / area;
      weight[0] = 1 - weight[1] - weight[2];
      return true;
    }
    const Vec3d ad = corner(3) - a;
    const double volume = across.dot(ad);
    if (!(std::abs(volume) > kHullRounding)) return false;
    weight[1] = -a.dot(ac.cross(ad)) / volume;
    weight[2] = -a.dot(ad.cross(ab)) / volume;
    weight[3] = -a.dot(across) / volume;
    weight[0] = 1 - weight[1] - weight[2] - weight[3];
    return true;
  }

  std::span<const Vec3d> corners_;
  std::array<std::size_t, kMostCorners> set_{};
  std::array<double, kMostCorners> weight_{};
  std::size_t count_ = 0;
  Vec3d point_{0.0};
};

/// The point with n . x = 1 for all normals, if there is one and only one that they say clearly.
std::optional<Vec3d> common_point(std::span<const Vec3d> normals) {
  openvdb::math::Mat3d squares = openvdb::math::Mat3d::zero(), axes;
  Vec3d sum(0.0), sizes, x(0.0);
  for (const Vec3d& n : normals) {
    sum += n;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) squares(i, j) += n[i] * n[j];
  }
  openvdb::math::diagonalizeSymmetricMatrix(squares, axes, sizes);
  const double least = kWellPlaced * (sizes[0] + sizes[1] + sizes[2]);
  for (int k = 0; k < 3; ++k) {
    if (!(sizes[k] > least)) return std::nullopt;
    const Vec3d axis = axes.col(k);
    x += axis * (axis.dot(sum) / sizes[k]);
  }
  // Once more, as the axes are found to seven digits or so.
  for (int again = 0; again < 2; ++again) {
    Vec3d rest(0.0);
    for (const Vec3d& n : normals) rest += n * (1 - n.dot(x));
    for (int k = 0; k < 3; ++k) {
      const Vec3d axis = axes.col(k);
      x += axis * (axis.dot(rest) / sizes[k]);
    }
  }
  const bool all = std::all_of(normals.begin(), normals.end(),
                               [&](const Vec3d& n) { return std::abs(n.dot(x) - 1) <= kConcurrent * x.length(); });
  if (!all) return std::nullopt;
  return x;
}

}  // namespace

void keep_to_walls(std::span<const Vec3d> walls, std::vector<Vec3d>& normals) {
  const Vec3d first = walls[0];
  std::optional<Vec3d> second;
  if (walls.size() > 1) second = (walls[1] - first * first.dot(walls[1])).unit();
  for (Vec3d& n : normals) {
    n -= first * first.dot(n);
    if (second) n -= *second * second->dot(n);
  }
}

double excess_of(std::span<const Vec3d> normals, const Vec3d& x) {
  double most = 0;
  for (const Vec3d& n : normals) most = std::max(most, n.dot(x) - 1);
  return most;
}

std::optional<MiterPoint> miter_point(std::span<const Vec3d> normals) {
  if (normals.empty()) return std::nullopt;
  const Vec3d p = NearestInHull(normals).point();
  const double squared = p.lengthSqr();
  // A hull that holds the origin: 1e-6 is a miter of a million distances.
  if (!(squared > 1e-12)) return std::nullopt;
  const Vec3d smallest = p / squared;
  const double excess = excess_of(normals, smallest);
  if (excess <= kConcurrent * smallest.length()) return MiterPoint{smallest, 0};
  if (const auto common = common_point(normals); common && common->length() <= kMuchFarther * smallest.length())
    return MiterPoint{*common, 0};
  return MiterPoint{smallest, excess};
}

}  // namespace vdb_offset
