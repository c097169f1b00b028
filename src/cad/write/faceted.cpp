// SPDX-License-Identifier: Apache-2.0
#include "write/faceted.h"

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <map>
#include <vector>

namespace vdb_offset::cad {
namespace {

class FacetedShape {
 public:
  explicit FacetedShape(std::span<const Vec3d> positions) : positions_(positions), vertices_(positions.size()) {
    builder_.MakeShell(shell_);
  }

  void add(const std::array<std::uint32_t, 3>& triangle) {
    TopoDS_Wire wire;
    builder_.MakeWire(wire);
    for (std::size_t k = 0; k < 3; ++k) builder_.Add(wire, edge(triangle[k], triangle[(k + 1) % 3]));
    wire.Closed(true);
    const BRepBuilderAPI_MakeFace face(wire, true);
    if (face.IsDone()) builder_.Add(shell_, face.Face());
  }

  TopoDS_Shape take() {
    shell_.Closed(BRep_Tool::IsClosed(shell_));
    if (!shell_.Closed()) return shell_;
    TopoDS_Solid solid;
    builder_.MakeSolid(solid);
    builder_.Add(solid, shell_);
    return solid;
  }

 private:
  const TopoDS_Vertex& vertex(std::uint32_t v) {
    if (vertices_[v].IsNull())
      vertices_[v] = BRepBuilderAPI_MakeVertex(gp_Pnt(positions_[v].x(), positions_[v].y(), positions_[v].z()));
    return vertices_[v];
  }
  TopoDS_Edge edge(std::uint32_t from, std::uint32_t to) {
    TopoDS_Edge& known = edges_[{std::min(from, to), std::max(from, to)}];
    if (known.IsNull()) known = BRepBuilderAPI_MakeEdge(vertex(std::min(from, to)), vertex(std::max(from, to)));
    return from < to ? known : TopoDS::Edge(known.Reversed());
  }

  std::span<const Vec3d> positions_;
  std::vector<TopoDS_Vertex> vertices_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, TopoDS_Edge> edges_;
  BRep_Builder builder_;
  TopoDS_Shell shell_;
};

}  // namespace

TopoDS_Shape faceted_shape(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles) {
  FacetedShape shape(positions);
  for (const auto& triangle : triangles) shape.add(triangle);
  return shape.take();
}

}  // namespace vdb_offset::cad
