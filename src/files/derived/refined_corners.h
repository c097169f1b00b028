// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "derived/derived_mesh.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset::io {

/// Where the corners of a face are, by their vertices.
class CornerFinder {
 public:
  explicit CornerFinder(PolygonView mesh) : mesh_(mesh) {}
  /// The first corner of a face that has a vertex. \throw InvalidInput if there is none
  std::uint32_t at(std::size_t face, std::uint32_t vertex);

 private:
  PolygonView mesh_;
  std::size_t face_ = kNone;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> corners_;  // of that face: vertex and corner, ascending
};

/// Values at the corners of the faces of a refinement, by their numbers.
struct RefinedCorners {
  /// A value that is interpolated, at a vertex that was added.
  struct Between {
    std::uint32_t vertex;
    std::array<std::uint32_t, 3> of;  ///< Values at the vertices of its origin; kNone where the share is 0.
  };

  std::vector<std::uint32_t> of_corner;  ///< The value of each corner, kNone if it has none. Empty: none has one.
  std::vector<Between> added;            ///< Their numbers follow those of the source's values.
};

/// Extends values of the source's corners to those of its pieces. At an added vertex faces share a value if they have
/// the same ones at the vertices of its origin. `of_corner` has a value below `count`, or kNone, for each corner of the
/// source; no corner has one if it is empty.
/// \throw InvalidInput if a piece has a vertex that its face knows nothing of
RefinedCorners refine_corners(const DerivedMesh& derived, std::span<const std::uint32_t> of_corner, std::size_t count);

}  // namespace vdb_offset::io
