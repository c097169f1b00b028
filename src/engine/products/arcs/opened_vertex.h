// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "products/arcs/ridge_fan.h"
#include "space/surface/surface.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// A vertex that is opened: its copies, and the faces between them. Copies are numbered from 0, those of sectors first.
struct OpenedVertex {
  RidgeFan fan;
  /// Where the first copies go, as seen from the vertex, in distances; all others go along their directions.
  std::vector<Vec3d> points;
  std::vector<Vec3d> directions;  ///< Of all copies, of unit length.
  /// Of each edge of the fan that is open: copies from the sector before it to the one behind it. Else empty.
  std::vector<std::vector<std::uint32_t>> arc;
  std::vector<std::array<std::uint32_t, 3>> patch;
};

/// How many steps an arc around an edge of a fan has.
using ArcSteps = std::function<std::size_t(const RidgeFan& fan, std::size_t edge)>;

/// Gives a vertex a copy for each of its sectors: `points`, where the planes of its faces meet. False if some have no
/// such point.
bool find_sectors(const Surface& surface, OpenedVertex& vertex);
/// Adds the copies between sectors, and a patch where three sectors or more meet. False if the vertex cannot be opened,
/// as not all of its faces would face outward. \pre find_sectors()
bool lay_arcs(const Surface& surface, const RidgeFinder& finder, const ArcSteps& steps, double step,
              OpenedVertex& vertex);

}  // namespace vdb_offset
