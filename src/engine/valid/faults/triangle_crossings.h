// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "ground/numbers/box_tree.h"
#include "space/surface/surface.h"
#include "valid/faults/clearly_apart.h"
#include "valid/faults/fan_boxes.h"

namespace vdb_offset {

/// Two triangles, the smaller index first.
using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

/// Where a surface crosses itself: all pairs, or, if there are more than kMostListedPairs, which triangles are in one.
struct SelfCrossings {
  std::vector<TrianglePair> pairs;    ///< Sorted; empty if there are more than are listed.
  bool more = false;                  ///< There are more pairs than are listed.
  std::vector<std::uint8_t> crossed;  ///< If there are more: of each triangle, 1 if it meets another.

  /// The number of pairs, but no more than kMostListedPairs.
  std::size_t count() const;
};

/// Most pairs of a surface that crosses itself that are listed. Measured: so many are found in two seconds, and gone
/// through in about as many.
inline constexpr std::size_t kMostListedPairs = 1000000;

inline std::size_t SelfCrossings::count() const { return more ? kMostListedPairs : pairs.size(); }

/// Finds the pairs of a surface's triangles that meet elsewhere than in the corners and edges that they share: decided
/// with exact predicates (CGAL's kernel), without a tolerance. Neighbours across an edge meet if they are folded flat
/// onto each other. Triangles without area meet nothing. Memory: 29 bytes a triangle. Results are the same for any
/// number of threads.
class CrossingFinder {
 public:
  /// Keeps references to both. Of the surface, its triangles and its frame are used alone.
  /// \param positions of the surface's vertices; they may lie anywhere
  CrossingFinder(const Surface& surface, std::span<const Vec3d> positions);

  /// Call for triangles whose corners have moved. \pre sorted, each once
  void update(std::span<const std::uint32_t> triangles);
  /// Whether a triangle was among those of the last update.
  bool is_updated(std::uint32_t triangle) const { return is_updated_[triangle]; }

  /// All pairs, sorted.
  std::vector<TrianglePair> all() const { return all({}); }
  /// All pairs of two triangles that `matters` is true of, sorted.
  std::vector<TrianglePair> all(const std::function<bool(std::uint32_t)>& matters) const;
  /// All pairs, or, if there are too many, which triangles are in one.
  SelfCrossings listed() const;
  /// The pairs that at least one triangle of the last update is part of, of two triangles that `matters` is true of (by
  /// default all); sorted.
  std::vector<TrianglePair> of_updated(const std::function<bool(std::uint32_t)>& matters = {}) const;
  /// For each triangle of the last update that matters, one pair that counts, of two triangles that matter, if there is
  /// any; sorted.
  std::vector<TrianglePair> one_of_each_updated(const std::function<bool(std::uint32_t)>& matters,
                                                const std::function<bool(const TrianglePair&)>& counts) const;

  /// Whether two triangles do not just touch but go through each other: each has corners on both sides of the other.
  bool go_through(const TrianglePair& pair) const;

  /// The surface's triangles, at this finder's positions, that a triangle meets whose corners are at other `positions`:
  /// elsewhere than in corners that both have at the same position. In no particular order.
  std::vector<std::uint32_t> met_by(std::uint32_t triangle, std::span<const Vec3d> positions) const;

  /// Pairs of another triangle, whose corners are given in the surface's own coordinates, and one of the surface's that
  /// it meets elsewhere than in corners and edges at the same positions. Sorted.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> met_by(
      std::span<const std::uint32_t> others,
      const std::function<std::array<Vec3d, 3>(std::uint32_t)>& corners_of) const;

 private:
  void build();
  template <class Takes, class Visit>
  void for_each_pair_of(std::size_t block, Takes&& takes, Visit&& visit) const;
  bool meets_any(std::uint32_t triangle) const;
  class Sieve;
  bool misses(std::uint32_t triangle, const FloatBox& box) const;
  FloatBox box_of_child(std::size_t level, std::size_t child) const;
  std::array<Vec3d, 3> corners(std::size_t triangle, std::span<const Vec3d> positions) const;
  FloatBox box_of(const std::array<Vec3d, 3>& corners) const;
  std::vector<std::uint32_t> updated_runs() const;
  template <class Takes, class IsIt>
  void any_near(std::span<const std::uint32_t> run, Takes&& takes, IsIt&& is_it) const;

  const Surface& surface_;
  std::span<const Vec3d> positions_;
  BoxTree tree_;
  FanBoxes fans_;
  std::vector<TrianglePlane> planes_;  // of each triangle, where there are large fans; else empty
  std::vector<std::uint32_t> updated_;
  std::vector<std::uint8_t> is_updated_;  // of each triangle: 1 if it is in updated_
};

}  // namespace vdb_offset
