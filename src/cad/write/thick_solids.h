// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

namespace vdb_offset::cad {

/// The solids between a solid and its offset: one for each of its shells, with that shell as it is and turned round the
/// other. Empty unless each shell of the source has one of the offset, in the same order.
/// \param is_outward whether the offset is the larger one
std::vector<TopoDS_Shape> thick_solids(const TopoDS_Shape& source, const TopoDS_Shape& offset, bool is_outward);

}  // namespace vdb_offset::cad
