// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Shape.hxx>
#include <functional>
#include <gp_Pnt.hxx>
#include <string>
#include <utility>
#include <vector>

namespace cad_proof {

/// Ten parts as they are drawn, and what makes them.
const std::vector<std::pair<std::string, std::function<TopoDS_Shape()>>>& parts();

/// A face with this closed outline.
TopoDS_Shape face_of(const TopoDS_Edge& closed);
TopoDS_Shape polygon(const std::vector<gp_Pnt>& corners);
/// The smooth closed curve through points.
TopoDS_Edge closed_spline(const std::vector<gp_Pnt>& points);
/// Solid between closed outlines, one above the other.
TopoDS_Shape loft(const std::vector<TopoDS_Edge>& outlines, bool is_ruled);
TopoDS_Shape loft(const std::vector<std::vector<gp_Pnt>>& outlines, bool is_ruled);

}  // namespace cad_proof
