// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Face.hxx>
#include <gp_Pnt2d.hxx>
#include <vector>

namespace vdb_offset::cad {

/// (u, v) of points spread over a face within its borders: `wanted` or more if they are found.
std::vector<gp_Pnt2d> points_in_face(const TopoDS_Face& face, std::size_t wanted);

}  // namespace vdb_offset::cad
