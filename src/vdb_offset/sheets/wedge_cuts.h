#pragma once

#include "vdb_offset/sheets/sheet_sides.h"

namespace vdb_offset {

/// Where a side of a face goes on as that of another over an edge, as seen from one of the edge's ends.
struct WedgeLink {
  std::array<std::uint32_t, 2> corners;  ///< The faces' corners there, each as 2 c + s (see SheetSides::wedge).
  std::uint32_t edge = kNone;            ///< One of three faces or more.
  SheetSides::Gap gap;                   ///< What is open along the edge where this is cut.
};

/// A link that is to be cut, and sides that reach to both pieces.
struct WedgeCut {
  std::size_t link;
  std::vector<SheetSides::SharedPlane> shared;
};

/// Where to cut a wedge that comes by one edge more than once, as at the end of an edge along which two solids touch:
/// space goes all the way around both there, and no corner can be in both of the gaps between them. Each gap gets a
/// piece of its own. The cut is where the sides at the edge end, and what lies between those belongs to both pieces.
/// None if the wedge comes by no edge twice, or branches.
/// \param links all those of the wedge
std::vector<WedgeCut> find_cuts(PolygonView mesh, std::span<const WedgeLink> links);

}  // namespace vdb_offset
