// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>

namespace vdb_offset::cad {

/// The shape with shells as solids that are closed by poles. In STEP, a face without a border has a vertex in its place
/// (VERTEX_LOOP: an ellipsoid). OpenCASCADE's reader gives such a face edges along its poles, with curves that are
/// points, and takes it for open; its writer writes faces so.
TopoDS_Shape closed_at_poles(const TopoDS_Shape& shape);

}  // namespace vdb_offset::cad
