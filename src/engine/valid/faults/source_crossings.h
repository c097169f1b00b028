// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "valid/faults/triangle_crossings.h"

namespace vdb_offset {

/// Where a source crosses itself, and which faces are near: as the surface moves, these crossings slide, but not far.
class SourceCrossings {
 public:
  /// Keeps a reference to the surface.
  SourceCrossings(const Surface& surface, SelfCrossings crossings);

  /// Pairs of triangles that meet, sorted; empty if there are more than are listed.
  const std::vector<TrianglePair>& pairs() const { return crossings_.pairs; }
  bool has_more() const { return crossings_.more; }
  /// The number of pairs, but no more than kMostListedPairs.
  std::size_t count() const { return crossings_.count(); }

  /// Whether a triangle is within two rings of a face that crosses another.
  bool is_near(std::uint32_t triangle) const { return !triangle_near_.empty() && triangle_near_[triangle]; }
  /// Whether a vertex is within two rings of a face that crosses another.
  bool is_vertex_near(std::uint32_t vertex) const { return !near(vertex).empty(); }

  /// Whether the sheets that two triangles are part of go through each other beside both: two faces cross of which one
  /// is within two rings of the first triangle, and the other within two rings of the second. A face that moves off one
  /// sheet then has to go through the other. Where there are more pairs than are listed, it is enough that both
  /// triangles are near a face that crosses another.
  bool sheets_cross(std::uint32_t s, std::uint32_t t) const;

 private:
  /// The triangles within two rings of a vertex that cross others, by their indices in crossing_, rising.
  std::span<const std::uint32_t> near(std::uint32_t vertex) const {
    return std::span(near_).subspan(near_begin_[vertex], near_begin_[vertex + 1] - near_begin_[vertex]);
  }
  void pair_up();
  void find_near();
  std::vector<std::uint32_t> vertices_beside(std::uint32_t triangle) const;

  const Surface& surface_;
  SelfCrossings crossings_;
  std::vector<std::uint32_t> crossing_;                 // triangles that cross others, rising
  std::vector<std::uint32_t> crossed_begin_, crossed_;  // of each of them: those that it crosses, by indices there
  std::vector<std::uint32_t> near_begin_, near_;        // of each vertex: those within two rings of it, likewise
  std::vector<std::uint8_t> triangle_near_;             // of each triangle; empty if none is
};

}  // namespace vdb_offset
