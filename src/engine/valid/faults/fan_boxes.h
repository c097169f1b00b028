// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ground/numbers/box_tree.h"
#include "space/surface/surface.h"

namespace vdb_offset {

/// Directions of triangles that lie around one vertex, or one edge, beside a BoxTree over all triangles.
///
/// The boxes of triangles around a vertex all meet there, so that each would be tested against all others, which takes
/// the square of their number. Two triangles that share the vertex meet elsewhere only where they lie in the same
/// direction from it: boxes around their directions separate most of them, whole blocks at a time. Around an edge, it
/// is the directions at right angles to it that count.
class FanBoxes {
 public:
  /// Directions from what all triangles of a node of the tree have in common; kNone if that is nothing.
  struct Node {
    std::array<std::uint32_t, 2> common{kNone, kNone};  ///< A vertex, or both of an edge in ascending order.
    FloatBox directions;
  };

  /// Keeps references. \param levels of the tree, of whose children above triangles there is a node each
  void build(const Surface& surface, std::span<const Vec3d> positions, std::size_t levels);
  /// Takes the directions of some triangles anew, and what is above them. \pre sorted, each once
  void refit(std::span<const std::uint32_t> changed);

  /// Whether no vertex has many triangles around it: then nothing is kept.
  bool empty() const { return nodes_.empty(); }
  /// The node of a block of triangles; nullptr if these have nothing in common, or there are no large fans.
  const Node* of_block(std::size_t block) const {
    return nodes_.empty() || nodes_[1][block].common[0] == kNone ? nullptr : &nodes_[1][block];
  }
  /// Whether no triangle of a block meets one of a child at a level of the tree elsewhere than in what all of them
  /// share.
  bool are_apart(const Node& block, std::size_t level, std::size_t child) const;

 private:
  Node node_of_triangles(std::size_t block) const;
  Node node_above(std::size_t level, std::size_t child) const;
  FloatBox directions_of(std::uint32_t triangle, const std::array<std::uint32_t, 2>& common) const;

  const Surface* surface_ = nullptr;
  std::span<const Vec3d> positions_;
  std::vector<std::uint8_t> is_hub_;      // of each vertex: 1 if many triangles are around it
  std::vector<std::vector<Node>> nodes_;  // by level, from 1 on; empty without a hub
};

}  // namespace vdb_offset
