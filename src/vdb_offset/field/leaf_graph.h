// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/math/Coord.h>
#include <openvdb/util/NodeMasks.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace vdb_offset {

/// Leaf nodes are cubes of 8^3 voxels; voxel (i, j, k) of one stands at i << 6 | j << 3 | k in its buffers.
inline constexpr int kLeafWidth = 8;
inline constexpr int kLeafVoxels = 512;
using VoxelMask = openvdb::util::NodeMask<3>;

/// Face f of a leaf node looks along axis f / 2, downwards for even f and upwards for odd f.
inline constexpr int kFaces = 6;
inline constexpr int opposite(int face) { return face ^ 1; }

/// A leaf node of a field: its voxels, as OpenVDB has them, and its neighbours. Not OpenVDB's own class, which cannot
/// be used without the code that reads it from files.
struct FieldLeaf {
  openvdb::Coord origin;
  std::array<std::int32_t, kFaces> neighbour = {-1, -1, -1, -1, -1, -1};  ///< Index in the graph, or -1.
  VoxelMask active;
  std::unique_ptr<float[]> phi;             ///< Of all voxels; none yet in a leaf node that was just made.
  std::unique_ptr<std::int32_t[]> closest;  ///< As phi.

  /// 0 or 1; leaf nodes that share a face differ.
  int colour() const { return (origin[0] + origin[1] + origin[2]) / kLeafWidth & 1; }
  bool is_on(int n) const { return active.isOn(static_cast<openvdb::Index>(n)); }
  void set_on(int n, float value, std::int32_t triangle) {
    phi[static_cast<std::size_t>(n)] = value;
    closest[static_cast<std::size_t>(n)] = triangle;
    active.setOn(static_cast<openvdb::Index>(n));
  }
  /// Makes both buffers, of voxels that are at the background and closest to none.
  void fill(float background);
};

/// Finds leaf nodes by their origin. Open addressing: a sweep asks six times for each leaf node that it makes.
class LeafIndex {
 public:
  void reserve(std::size_t count);
  /// The leaf node that has this origin already, or else `leaf`, which is inserted.
  std::int32_t find_or_insert(const openvdb::Coord& origin, std::int32_t leaf);
  /// The leaf node with this origin, or -1.
  std::int32_t find(const openvdb::Coord& origin) const;

 private:
  struct Slot {
    openvdb::Coord origin;
    std::int32_t leaf = -1;
  };
  std::size_t slot_of(const openvdb::Coord& origin) const;

  std::vector<Slot> slots_ = std::vector<Slot>(16);  // a power of two, at most half of them taken
  std::size_t taken_ = 0;
};

/// The leaf nodes of a field as an array, each knowing those across its faces.
class LeafGraph {
 public:
  /// \param leaves each of another origin, in any order
  /// \param slab one leaf node thick in z: the field does not spread along it
  LeafGraph(std::vector<FieldLeaf> leaves, bool slab);

  std::size_t size() const { return leaves_.size(); }
  /// Faces that a field spreads across: those of a slab look along x and y, the first four.
  int open_faces() const { return slab_ ? 4 : kFaces; }
  const FieldLeaf& operator[](std::size_t i) const { return leaves_[i]; }
  FieldLeaf& operator[](std::size_t i) { return leaves_[i]; }
  /// The leaf node with this origin, or -1.
  std::int32_t find(const openvdb::Coord& origin) const { return index_.find(origin); }
  std::size_t active_voxels() const;

  /// The neighbour across a face; if there is none, it is noted down, for make_new_leaves() to make. Not thread-safe.
  std::int32_t touch_neighbour(std::int32_t leaf, int face);

  /// Links the leaf nodes that have been noted down to their neighbours, in parallel. They have no active voxels, and
  /// no buffers.
  void make_new_leaves();

  /// Takes leaf nodes without active voxels out. The others keep their order, and get new numbers.
  void drop_empty_leaves();

 private:
  void index_leaves();
  void link(std::size_t leaf, std::size_t first_new);

  std::vector<FieldLeaf> leaves_;
  bool slab_;
  std::size_t linked_ = 0;  // the first so many have been linked
  LeafIndex index_;
};

/// A leaf node's voxels with one more on every side, filled from the leaf nodes across its faces. Voxels beyond an
/// edge or a corner of the leaf node are not filled: stencils here look along the axes only.
inline constexpr int kPaddedWidth = kLeafWidth + 2;
inline constexpr int kPaddedVoxels = kPaddedWidth * kPaddedWidth * kPaddedWidth;
inline constexpr std::array<int, 3> kPaddedStride = {kPaddedWidth * kPaddedWidth, kPaddedWidth, 1};
inline constexpr std::array<int, 3> kLeafStride = {64, 8, 1};
inline constexpr int padded_index(int i, int j, int k) {
  return (i + 1) * kPaddedStride[0] + (j + 1) * kPaddedStride[1] + (k + 1);
}
inline constexpr int padded_index(int n) { return padded_index(n >> 6, n >> 3 & 7, n & 7); }

namespace detail {
template <int kFace, class Visit>
void for_each_halo_voxel(Visit&& visit) {
  constexpr int kAxis = kFace / 2, kU = kAxis == 0 ? 1 : 0, kV = kAxis == 2 ? 1 : 2;
  constexpr int kPadded = kFace % 2 ? kLeafWidth + 1 : 0, kThere = kFace % 2 ? 0 : kLeafWidth - 1;
  for (int a = 0; a < kLeafWidth; ++a)
    for (int b = 0; b < kLeafWidth; ++b)
      visit(kPadded * kPaddedStride[kAxis] + (a + 1) * kPaddedStride[kU] + (b + 1) * kPaddedStride[kV],
            kThere * kLeafStride[kAxis] + a * kLeafStride[kU] + b * kLeafStride[kV]);
}
}  // namespace detail

/// Calls visit(padded index, voxel number) for the 64 voxels of the neighbour across `face`: its voxels that touch
/// the leaf node, and where they stand in the padded block. Strides are constants, for the compiler's sake.
template <class Visit>
void for_each_halo_voxel(int face, Visit&& visit) {
  switch (face) {
    case 0:
      return detail::for_each_halo_voxel<0>(visit);
    case 1:
      return detail::for_each_halo_voxel<1>(visit);
    case 2:
      return detail::for_each_halo_voxel<2>(visit);
    case 3:
      return detail::for_each_halo_voxel<3>(visit);
    case 4:
      return detail::for_each_halo_voxel<4>(visit);
    default:
      return detail::for_each_halo_voxel<5>(visit);
  }
}

/// Padded index of the voxel of the leaf node that touches halo voxel `padded` across `face`.
inline constexpr int across(int face, int padded) {
  return padded + (face % 2 ? -1 : 1) * kPaddedStride[static_cast<std::size_t>(face / 2)];
}

}  // namespace vdb_offset
