// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Curves whose sharp corners are opened into fans: in place of each such corner there are copies of it, between which
/// segments have next to no length.
struct FannedCurves {
  /// All points stand a tiny share of the way off the source (see stand_off.h), so that copies can be told apart. The
  /// source's points come first, of a corner as one of its copies.
  Curves curves;
  std::vector<std::uint32_t> origin;  ///< Of each point: the source's point that it is a copy of.
  std::vector<std::uint32_t> foot;    ///< Of each point: the first at its place in the source.
};

/// \param outer where points go: their distances in the outermost layer
/// \param angle corners that turn by more than this are opened, and neighbours in a fan are no farther apart; radians
/// \return no curves where no corner is opened. \throw InvalidInput as chains_in_plane()
FannedCurves open_corners(CurvesView curves, const Distances& outer, double angle);

}  // namespace vdb_offset
