// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/tree/ValueAccessor.h>

#include <array>
#include <cstdint>
#include <vector>

#include "space/field/field_grids.h"

namespace vdb_offset {

/// Face f of a leaf node looks along axis f / 2, downwards for even f and upwards for odd f.
inline constexpr int kFaces = 6;
inline constexpr int opposite(int face) { return face ^ 1; }

/// A leaf node of both field grids, its raw buffers (voxel (i, j, k) at i << 6 | j << 3 | k) and its neighbours.
struct GraphLeaf {
  openvdb::Coord origin;
  PhiLeaf* phi = nullptr;
  ClosestLeaf* closest = nullptr;
  std::array<std::int32_t, kFaces> neighbour = {-1, -1, -1, -1, -1, -1};  ///< Index in the graph, or -1.

  /// 0 or 1; leaf nodes that share a face differ.
  int colour() const { return (origin[0] + origin[1] + origin[2]) / kLeafWidth & 1; }
};

/// An index over the leaf nodes of a field's grids, each with those across its faces, so that a stencil never has to
/// walk the tree: filled in parallel, and thrown away after a sweep. OpenVDB's trees hold the leaf nodes, find them
/// (ValueAccessor), and each knows its number in here (LeafNode::transientData()).
class LeafGraph {
 public:
  /// Keeps a reference.
  explicit LeafGraph(FieldGrids& grids);

  std::size_t size() const { return leaves_.size(); }
  /// Faces that a field spreads across: those of a slab look along x and y, the first four.
  int open_faces() const { return grids_.slab ? 4 : kFaces; }
  const GraphLeaf& operator[](std::size_t i) const { return leaves_[i]; }

  /// The neighbour across a face; if there is none, it is added to both grids: without active voxels, with buffers yet
  /// to be allocated (LeafNode::allocate), and yet to be linked. Not thread-safe.
  std::int32_t touch_neighbour(std::int32_t leaf, int face);

  /// Links the leaf nodes that have been added to those across their faces.
  void link_new_leaves();

  /// Takes the leaf nodes without active voxels out of the grids: the graph is of no more use then.
  void prune();

 private:
  // These remember the internal nodes alone: an accessor that remembers a leaf node allocates its buffer.
  template <class Tree>
  using Accessor = openvdb::tree::ValueAccessor2<Tree, false, 1, 2>;

  FieldGrids& grids_;
  std::vector<GraphLeaf> leaves_;
  std::size_t linked_ = 0;  // so many of them know their neighbours
  Accessor<openvdb::FloatTree> phi_;
  Accessor<openvdb::Int32Tree> closest_;
};

/// The origin of the leaf node across a face.
inline openvdb::Coord origin_across(openvdb::Coord origin, int face) {
  origin[face / 2] += face % 2 ? kLeafWidth : -kLeafWidth;
  return origin;
}

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
