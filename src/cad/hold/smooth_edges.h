// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vdb_offset::cad {

/// An edge of two faces whose normals agree along it.
struct SmoothEdge {
  TopoDS_Edge edge;
  std::array<TopoDS_Face, 2> faces;
  std::array<std::size_t, 2> numbers;  ///< Of the faces, as TopExp_Explorer meets them: the first time, if twice.
};

std::vector<SmoothEdge> smooth_edges(const TopoDS_Shape& shape);

/// Of each of so many faces the least number of those that it is joined with across smooth edges.
std::vector<std::uint32_t> smooth_pieces(const std::vector<SmoothEdge>& edges, std::size_t faces);

}  // namespace vdb_offset::cad
