// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Face.hxx>
#include <gp_Pnt.hxx>
#include <optional>
#include <vector>

namespace vdb_offset::cad {

/// A face of the source of an uneven offset.
struct MovedFace {
  TopoDS_Face source;
  std::vector<TopoDS_Face> made;  ///< What it became.
  double distance = 0;            ///< How far it goes, without sign; 0: it stays, or goes not everywhere as far.
};

struct TooNear {
  gp_Pnt point;
  double distance = 0, asked = 0;
};

/// The first sampled point of what has moved that is nearer, by more than 1 %, to a face that moved than that or its
/// own face goes, whichever goes less. (At a sharp edge, what goes farther ends where the other one does.) Where faces
/// end at one that stays, they go on in its surface, and may be nearer to the edge between. \pre all faces go to one
/// side. \param largest the largest distance
std::optional<TooNear> nearer_than_asked(const std::vector<MovedFace>& faces, double largest);

}  // namespace vdb_offset::cad
