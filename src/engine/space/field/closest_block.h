// SPDX-License-Identifier: Apache-2.0
#pragma once

// What sweep_closest() holds of one leaf node: closest points, as they are kept between visits, and unpacked with a
// halo while the leaf node is worked on.

#include <algorithm>
#include <cstdint>
#include <iterator>

#include "ground/numbers/float_lanes.h"
#include "space/field/leaf_graph.h"

namespace vdb_offset {

// Coordinate of a closest point that is not known: its squared distance is beyond any reach, and fits into a float.
inline constexpr float kFarPoint = 1e15f;

/// Closest points of a leaf node's voxels, in voxels from its voxel (0, 0, 0).
struct ClosestPoints {
  float p[3][kLeafVoxels];
};

/// What the voxels of a leaf node hand on: closest points and, in the leaf node's own buffer, the triangles that these
/// are on. The pointer to that buffer is kept here: otherwise, reading a neighbour would have to wait for its leaf
/// node to be loaded first.
struct LeafPoints {
  ClosestPoints* points = nullptr;
  std::int32_t* id = nullptr;
};

/// A triangle's index with the side of it: the index itself for phi >= 0, its complement for phi < 0.
inline std::int32_t with_side(std::uint32_t triangle, bool inside) {
  const auto index = static_cast<std::int32_t>(triangle);
  return inside ? ~index : index;
}
inline std::uint32_t triangle_of(std::int32_t id) { return static_cast<std::uint32_t>(id < 0 ? ~id : id); }

// How far four successive voxels of a row are from the first of them.
inline constexpr Lanes kCount = {0, 1, 2, 3};

/// One leaf node and its halo, unpacked: a voxel's position is its indices.
struct ClosestBlock {
  float limit[kPaddedVoxels];  // squared distance below which another point is nearer
  float p[3][kPaddedVoxels];   // closest point
  std::int32_t id[kPaddedVoxels];

  /// Makes all closest points unknown, for a new leaf node. The halo is loaded afterwards.
  void forget() {
    for (auto& axis : p) std::fill(std::begin(axis), std::end(axis), kFarPoint);
    std::fill(std::begin(id), std::end(id), -1);
  }

  /// Squared distance from voxel (i, j, k) to the closest point of voxel n.
  float squared(int i, int j, int k, int n) const {
    const float x = static_cast<float>(i) - p[0][n], y = static_cast<float>(j) - p[1][n],
                z = static_cast<float>(k) - p[2][n];
    return x * x + y * y + z * z;
  }
  /// Squared distances from the voxels (i, j, k), (i, j, k + 1), .. to the closest points of voxels n, n + 1, ..
  Lanes squared_lanes(int i, int j, int k, int n) const {
    const Lanes x = static_cast<float>(i) - load_lanes(p[0] + n), y = static_cast<float>(j) - load_lanes(p[1] + n),
                z = (static_cast<float>(k) + kCount) - load_lanes(p[2] + n);
    return x * x + y * y + z * z;
  }

  /// True if row n, or the halo at one of its ends, has a closest point.
  bool any_known(int n) const {
    const IntLanes known = (load_lanes(p[0] + n - 1) < kFarPoint) | (load_lanes(p[0] + n + 3) < kFarPoint) |
                           (load_lanes(p[0] + n + 5) < kFarPoint);
    return any(known);
  }

  /// Offers the closest points of row m to the eight voxels of row n, which lies at (i, j). Returns whether any was
  /// taken.
  bool offer_row(int i, int j, int n, int m) {
    bool taken = false;
    for (int k = 0; k < kLeafWidth; k += kLanes, n += kLanes, m += kLanes) {
      const Lanes offered = squared_lanes(i, j, k, m), known = load_lanes(limit + n);
      const IntLanes nearer = offered < known;
      if (!any(nearer)) continue;
      taken = true;
      store_lanes(limit + n, nearer ? offered : known);
      for (auto& axis : p) store_lanes(axis + n, nearer ? load_lanes(axis + m) : load_lanes(axis + n));
      store_lanes(id + n, nearer ? load_lanes(id + m) : load_lanes(id + n));
    }
    return taken;
  }
  void offer_along_row(int i, int j, int n) {
    for (int k = 0; k < kLeafWidth; ++k) offer(i, j, k, n + k, n + k - 1);
    for (int k = kLeafWidth - 1; k >= 0; --k) offer(i, j, k, n + k, n + k + 1);
  }

 private:
  void offer(int i, int j, int k, int n, int m) {
    const float offered = squared(i, j, k, m);
    if (!(offered < limit[n])) return;
    limit[n] = offered;
    for (auto& axis : p) axis[n] = axis[m];
    id[n] = id[m];
  }
};

template <class Value>
void copy_row(const Value* from, Value* to) {
  for (int k = 0; k < kLeafWidth; k += kLanes) store_lanes(to + k, load_lanes(from + k));
}

/// Calls work(i, j, padded index, voxel number) for the first voxel of each of a leaf node's rows along k.
template <class Work>
void for_each_row(Work&& work) {
  for (int i = 0; i < kLeafWidth; ++i)
    for (int j = 0; j < kLeafWidth; ++j) work(i, j, padded_index(i, j, 0), i << 6 | j << 3);
}

}  // namespace vdb_offset
