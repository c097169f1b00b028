// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

namespace vdb_offset::cad {

/// A face of a source that is left open: no wall is over it.
struct Opening {
  TopoDS_Face source;            ///< As it lies in its shell.
  TopoDS_Shape offset;           ///< The face, or faces, that it became, in its own surface.
  std::vector<TopoDS_Face> rim;  ///< What lies between the two.
};

/// The solids between a solid and its offset: one for each of its shells, with that shell as it is and turned round the
/// other; those of one with openings are joined by rims, in the surfaces of the open faces. Empty unless each shell of
/// the source has one of the offset, in the same order, and rims close them.
/// \param is_outward whether the offset is the larger one
std::vector<TopoDS_Shape> thick_solids(const TopoDS_Shape& source, const TopoDS_Shape& offset, bool is_outward,
                                       std::vector<Opening>& openings);

}  // namespace vdb_offset::cad
