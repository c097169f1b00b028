// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ground/numbers/box_tree.h"
#include "space/query/near_triangles.h"
#include "space/surface/surface.h"

namespace vdb_offset {

/// The answer to "how far is x from the surface?", in the surface's local frame.
struct Closest {
  double distance;  ///< Unsigned, world units.
  std::uint32_t triangle;
  Feature feature;
  bool tied;  ///< Another point of the surface is as near, but for rounding; not told by answer_along_paths().
  Vec3d point;
};

/// Longest step from x, as a share of phi(x): the ball of radius phi(x) around x holds no surface, so that a shorter
/// step crosses nothing. Less than 1, to allow for an error of phi. Not measured beside others.
inline constexpr double kFreeShare = 0.9;

/// Exact distance to a surface: phi(x) without a grid's error.
///
/// The surface's triangles, which lie along a space-filling curve, are packed eight at a time into an implicit tree of
/// boxes with eight children each; there are no pointers. A query cannot miss: the hint only
/// bounds the search, so that a good one makes it short. Memory: about 50 bytes a triangle. Safe from any number of
/// threads.
class ClosestQuery {
 public:
  /// Keeps a reference to the surface. \param faces only the triangles of so many first faces are looked at: all others
  /// lie on their edges, but for rounding. \pre the surface is in its local frame, and has a triangle.
  explicit ClosestQuery(const Surface& surface, std::uint32_t faces = kNone);

  /// The closest point of the surface to x. Among equally close triangles the answer depends only on x, the hint
  /// and the surface. `hint` is any triangle, best one that was close to a point nearby.
  Closest operator()(const Vec3d& x, std::uint32_t hint) const;

  /// The closest point that a walk from a first triangle finds, which need not be the closest of all: see
  /// Surface::walk_to_closest.
  TrianglePoint near(const Vec3d& x, std::uint32_t& triangle) const { return surface_.walk_to_closest(x, triangle); }

  /// Finds the closest points of several points that are near each other, as those of neighbouring vertices are, with a
  /// hint each: in a third of the time of single queries, as boxes that are far from all of the points are left out
  /// once for all. The answers depend only on the points together, the hints and the surface. \pre as many hints and
  /// answers as points
  void answer_together(std::span<const Vec3d> points, std::span<const std::uint32_t> hints,
                       std::span<Closest> answers) const;

  /// Finds the closest points of points on several paths up from the surface, as the positions of a vertex at several
  /// distances are: the triangles near a path are looked for once. Path i has points begin[i] .. begin[i + 1] - 1. The
  /// answers depend only on the points together, the hints and the surface. \pre as many hints and answers as points,
  /// and begin ends with that number
  void answer_along_paths(std::span<const Vec3d> points, std::span<const std::size_t> begin,
                          std::span<const std::uint32_t> hints, std::span<Closest> answers) const;

  /// Calls visit(triangle, point) for all points of the surface, one a triangle, that are as near to x as the closest
  /// one, but for what rounding may have made of that: the same ones in each frame that the surface may stand in.
  template <class Visit>
  void visit_as_near(const Vec3d& x, double distance, Visit&& visit) const {
    const double farthest = farthest_tie(distance);
    const Ball ball{x, farthest};
    collect_together({&ball, 1}, [&](std::size_t, const NearTriangles& near) {
      for (std::size_t i = 0; i < near.size(); ++i) {
        const TrianglePoint point = surface_.closest_on(near.triangle(i), x);
        if (point.squared_distance <= farthest * farthest) visit(near.triangle(i), point);
      }
    });
  }

  struct Ball {
    Vec3d centre;
    double radius;  ///< World units.
  };
  /// Calls take(i, near) for each of some balls, which are near each other, in their order: `near` holds all
  /// triangles that meet ball i, and some that are hardly farther, in an order that depends on all balls. `near` may be
  /// changed.
  void collect_together(std::span<const Ball> balls,
                        const std::function<void(std::size_t, NearTriangles& near)>& take) const;

  const Surface& surface() const { return surface_; }

 private:
  static constexpr int kWidth = BoxTree::kWidth;
  static constexpr int kLeafSize = 8;  // triangles in a lowest box: as many as a box has children, two rows of lanes

  /// Rectangles around the triangles of a lowest box, each in the plane of its triangle and along the longest edge.
  /// They bound the distances of the triangles from below.
  struct Rectangles {
    float centre[3][kLeafSize], normal[3][kLeafSize], edge[3][kLeafSize], half_length[kLeafSize], half_width[kLeafSize];
  };
  class Search;
  class Group;
  class Collector;
  class AlongPaths;
  // Most blocks of lowest boxes that are looked through for each ball of a group. A group that needs more is halved,
  // and a single ball descends from the root. Not measured beside other numbers.
  static constexpr std::size_t kMostBlocks = 48;
  using Blocks = std::array<std::uint32_t, kMostBlocks>;

  /// The distance up to which another point ties with the closest one. 1e-9 of the distance and 2.5e-8 of the slack are
  /// far more than what two frames round differently, and far less than what a file's numbers keep apart; not measured.
  double farthest_tie(double distance) const {
    return distance * (1 + 1e-9) + 2.5e-8 * static_cast<double>(slack_) / scale_;
  }
  bool is_looked_at(std::size_t triangle) const { return surface_.face[triangle] < faces_; }
  Rectangles rectangles_of(std::size_t leaf) const;
  std::size_t find_blocks(std::span<const Ball> balls, Blocks& blocks) const;
  static unsigned near_siblings(const BoxTree::Siblings& box, const float* local, float limit, float* squared);
  static unsigned near_rectangles(const Rectangles& some, const float* local, float limit, float* squared);
  struct Planes;
  static unsigned planes_before(const Rectangles& some, const float* local, float limit, Planes& planes);

  const Surface& surface_;
  std::uint32_t faces_;
  std::vector<Rectangles> rectangles_;
  BoxTree tree_;
  double scale_;  // the power of two that scales coordinates to a size near 1
  float slack_;   // scaled; more than the rounding of a box or a query point to float
};

/// The exact query at many points, answered in the order of a space-filling curve, each with the one before as its
/// hint, in parallel. The answers stand in the order of the points and do not depend on the number of threads.
std::vector<Closest> closest_points(const ClosestQuery& query, std::span<const Vec3d> points);

}  // namespace vdb_offset
