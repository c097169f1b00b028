// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <gp_Pnt.hxx>
#include <unordered_map>

namespace vdb_offset::cad {

/// What share of its distance each point of a surface may go: 1 but near the given points, and never more
/// than those were told with. It has two derivatives: a uniform cubic B-spline in space, each coefficient of which is
/// the least share given where it counts, so that no sum of them is more.
class HeldField {
 public:
  explicit HeldField(double spacing) : spacing_(spacing) {}

  /// Sides of triangles whose middles are to be given. Middles are then no farther apart than their sides.
  static constexpr double kSampling = 0.5;  // of the spacing
  /// A point counts no farther than this: coefficients within its reach, each as far as it counts itself.
  static constexpr double kFarthest = 8;  // spacings: the diagonal of 4.6

  void lower(const gp_Pnt& point, double share);
  double operator()(const gp_Pnt& point) const;
  /// Whether it is this share at every point that is nearer to this one than to others that were given.
  bool is_even_around(const gp_Pnt& point, double share) const;
  bool is_empty() const { return coefficients_.empty(); }

 private:
  static constexpr double kReach = 2.6;  // of a coefficient, and to the next given point
  using Node = std::array<std::int64_t, 3>;
  /// The nodes that a point counts for.
  struct Reach {
    Node first, last;
  };
  Reach reach_of(const gp_Pnt& point) const;
  struct Hash {
    std::size_t operator()(const Node& node) const;
  };

  double spacing_;
  std::unordered_map<Node, double, Hash> coefficients_;  // those that are not 1
};

}  // namespace vdb_offset::cad
