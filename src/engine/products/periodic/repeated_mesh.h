// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/periodic.h"

namespace vdb_offset {

/// A mesh and copies of it on both sides, joined where they meet: what is around its periodic borders.
class RepeatedMesh {
 public:
  /// \param reach how far beyond the borders copies go, world units
  /// \throw InvalidInput for a turn that a whole circle has no whole number of
  RepeatedMesh(PolygonView mesh, const PeriodicPairs& pairs, double reach);

  /// The mesh's vertices and faces come first, in their order.
  PolygonView view() const { return polygons_.view(); }
  /// Of each vertex, the mesh's that it is a copy of.
  std::span<const std::uint32_t> origin() const { return origin_; }
  std::size_t copies() const { return copies_; }

 private:
  Polygons polygons_;
  std::vector<std::uint32_t> origin_;
  std::size_t copies_ = 1;
};

}  // namespace vdb_offset
