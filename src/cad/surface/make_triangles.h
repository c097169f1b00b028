// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <IMeshTools_Parameters.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>

namespace vdb_offset::cad {

/// Gives the faces of a shape OpenCASCADE's triangles, and those for which it finds none the triangles of a grid over
/// (u, v). Faces without area stay without any.
void make_triangles(const TopoDS_Shape& shape, const IMeshTools_Parameters& parameters);

/// Whether a face has triangles.
bool has_triangles(const TopoDS_Face& face);

/// Whether something of a face is farther from its edges than these are exact: not of one that has come to nothing, or
/// to a line.
bool has_area(const TopoDS_Face& face);

}  // namespace vdb_offset::cad
