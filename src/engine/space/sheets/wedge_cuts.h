// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "space/sheets/sheet_sides.h"

namespace vdb_offset {

/// A connection of two sides over an edge, where one face's side continues as another's, at one end of the edge.
struct WedgeLink {
  std::array<std::uint32_t, 2> corners;  ///< The faces' corners there, each as 2 c + s (see SheetSides::wedge).
  std::uint32_t edge = kNone;            ///< Number of the edge, if it has three faces or more.
  SheetSides::Gap gap;                   ///< The gap along the edge if the link is cut.
};

/// A link that is to be cut, and the sides that belong to both pieces.
struct WedgeCut {
  std::size_t link;
  std::vector<SheetSides::SharedPlane> shared;
};

/// Finds where to cut a wedge that comes by one edge more than once, as at the end of an edge along which two solids
/// touch: space goes all the way around both there, and no corner can be in both of the gaps between them. Each gap
/// gets a piece of its own. The cut is where the sides at the edge end; the sides between these belong to both pieces.
/// No cuts if the wedge comes by no edge twice, or branches.
/// \param links all links of the wedge
std::vector<WedgeCut> find_cuts(PolygonView mesh, std::span<const WedgeLink> links);

}  // namespace vdb_offset
