// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <utility>
#include <vector>

namespace vdb_offset::cad {

/// A face of a source that is left open: no wall is over it.
struct Opening {
  TopoDS_Face source;   ///< As it lies in its shell.
  TopoDS_Shape offset;  ///< The face, or faces, that it became, in its own surface.
};

struct ThickSolids {
  std::vector<TopoDS_Shape> solids;
  /// What faces of source and offset have become where openings cut them, or are: the original first.
  std::vector<std::pair<TopoDS_Shape, TopoDS_Face>> cut;
};

/// The solids between a solid and its offset: one for each of its shells, with that shell as it is and turned round the
/// other; those of one with openings are joined by rims, in the surfaces of the open faces. None unless each shell of
/// the source has one of the offset, in the same order, and rims close them.
/// \param is_outward whether the offset is the larger one
ThickSolids thick_solids(const TopoDS_Shape& source, const TopoDS_Shape& offset, bool is_outward,
                         const std::vector<Opening>& openings);

}  // namespace vdb_offset::cad
