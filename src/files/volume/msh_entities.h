// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/cells.h"

namespace vdb_offset::io {

/// The entities of a mesh, as Gmsh wants them: the volume, its patches, the curves on which patches meet, and the
/// corners at which curves end or meet. Each point belongs to the entity of the lowest dimension that it lies on. A
/// closed curve has a corner, too, its point of the lowest number; so has a point at which patches touch that share no
/// edge there.
struct MshEntities {
  /// A curve from corner to corner. All of its edges are between the same patches.
  struct Curve {
    std::vector<std::uint32_t> points;
    std::uint32_t group;  ///< Index of these patches in `groups`.
    std::size_t edge_count() const { return points.size() - 1; }
  };
  /// A curve on a patch's edge, and whether the patch's faces there run as it does.
  struct Side {
    std::uint32_t curve;
    bool forwards;
  };

  std::vector<std::uint32_t> corners;
  std::vector<Curve> curves;
  std::vector<std::vector<std::uint32_t>> groups;    ///< Patches that meet on curves, in rising order.
  std::vector<std::vector<Side>> around;             ///< The curves around each patch.
  std::vector<std::vector<std::uint32_t>> on_patch;  ///< Points of each patch that lie on no curve and at no corner.
  std::vector<std::uint32_t> inside;                 ///< Points of no patch.
};

/// Finds the entities of a mesh's points.
MshEntities find_entities(const VolumeMesh& mesh);

}  // namespace vdb_offset::io
