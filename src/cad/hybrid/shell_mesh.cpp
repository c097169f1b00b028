// SPDX-License-Identifier: Apache-2.0
#include "hybrid/shell_mesh.h"

#include <BRep_Tool.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <gp.hxx>
#include <gp_Trsf.hxx>

namespace vdb_offset::cad {
namespace {

class ShellMeshMaker {
 public:
  ShellMeshMaker(const Body& body, const BodyMesh& mesh, std::span<const Vec3d> positions, double millimetres)
      : body_(body), mesh_(mesh), positions_(positions), millimetres_(millimetres) {
    scale_.SetScale(gp::Origin(), millimetres);
  }

  ShellMesh of(const TopoDS_Shape& shell, std::span<const std::size_t> faces) {
    ShellMesh made;
    number_.assign(mesh_.positions.size(), kNone);
    for (std::size_t f = 0; f < faces.size(); ++f) add_face(faces[f], static_cast<int>(f), made);
    TopTools_IndexedMapOfShape edges;
    TopExp::MapShapes(shell, TopAbs_EDGE, edges);
    for (const auto& [key, segment] : mesh_.segments) {
      const std::uint32_t a = number_[key >> 32], b = number_[key & 0xffffffff];
      const int edge = edges.FindIndex(mesh_.curves[segment.edge].Edge()) - 1;
      if (a == kNone || b == kNone || edge < 0) continue;
      const double lower = on_scaled(edges(edge + 1), segment.lower), upper = on_scaled(edges(edge + 1), segment.upper);
      made.edges[BodyMesh::key(a, b)] = {edge, a < b ? lower : upper, a < b ? upper : lower};
    }
    return made;
  }

 private:
  void add_face(std::size_t face, int number, ShellMesh& made) {
    const FaceMesh& of_body = mesh_.faces[face];
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(body_.faces[face].face);
    for (const Triangle& corners : of_body.triangles) {
      ShellTriangle& t = made.triangles.emplace_back();
      t.face = number;
      t.nodes = corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const Node& node = of_body.nodes[corners[k]];
        t.vertices[k] = vertex(node.vertex, made);
        double u = node.u, v = node.v;
        if (millimetres_ != 1) surface->TransformParameters(u, v, scale_);
        t.origin[k] = gp_Pnt2d(u, v);
      }
    }
  }

  std::uint32_t vertex(std::uint32_t of_body, ShellMesh& made) {
    std::uint32_t& number = number_[of_body];
    if (number != kNone) return number;
    number = static_cast<std::uint32_t>(made.points.size());
    const Vec3d at = millimetres_ * positions_[mesh_.numbers[of_body]];
    made.points.emplace_back(at.x(), at.y(), at.z());
    return number;
  }

  double on_scaled(const TopoDS_Shape& edge, double t) const {
    if (millimetres_ == 1) return t;
    double first = 0, last = 0;
    return BRep_Tool::Curve(TopoDS::Edge(edge), first, last)->TransformedParameter(t, scale_);
  }

  const Body& body_;
  const BodyMesh& mesh_;
  const std::span<const Vec3d> positions_;
  const double millimetres_;
  gp_Trsf scale_;
  std::vector<std::uint32_t> number_;  // of each vertex of the body in the shell
};

}  // namespace

std::vector<ShellMesh> shell_meshes(const Body& body, const BodyShape& shape, const BodyMesh& mesh,
                                    std::span<const Vec3d> positions, double millimetres) {
  ShellMeshMaker maker(body, mesh, positions, millimetres);
  std::vector<ShellMesh> made;
  std::span<const std::size_t> faces = shape.face_numbers;
  for (TopExp_Explorer shell(shape.shape, TopAbs_SHELL); shell.More(); shell.Next()) {
    std::size_t count = 0;
    for (TopExp_Explorer face(shell.Current(), TopAbs_FACE); face.More(); face.Next()) ++count;
    made.push_back(maker.of(shell.Current(), faces.first(count)));
    faces = faces.subspan(count);
  }
  return made;
}

}  // namespace vdb_offset::cad
