#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/crossings.h"

namespace vdb_offset {

/// Where a surface crosses itself, and what is near: as the surface moves, its crossings slide, but not far.
class NearCrossings {
 public:
  /// The pairs of a surface's triangles that meet, sorted. Keeps a reference to the surface.
  NearCrossings(const Surface& surface, std::vector<TrianglePair> pairs);

  const std::vector<TrianglePair>& pairs() const { return pairs_; }

  /// Within two rings of a face that crosses another.
  bool is_near(std::uint32_t triangle) const;
  bool is_vertex_near(std::uint32_t vertex) const { return near_[vertex]; }

  /// Whether the sheets that two triangles are part of go through each other beside both: two faces cross of which one
  /// is within two rings of the first, and the other within two rings of the second. What moves off one sheet then has
  /// to go through the other.
  bool sheets_cross(std::uint32_t s, std::uint32_t t) const;

 private:
  std::vector<std::uint32_t> vertices_beside(std::uint32_t triangle) const;

  const Surface& surface_;
  std::vector<TrianglePair> pairs_, reversed_;  // reversed_: the larger index first
  std::vector<std::uint8_t> near_;              // of each vertex
};

}  // namespace vdb_offset
