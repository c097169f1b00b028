// SPDX-License-Identifier: Apache-2.0
#include <unordered_map>

#include "hybrid/hybrid_model.h"

namespace vdb_offset::cad {
namespace {

double area(const gp_Pnt2d& a, const gp_Pnt2d& b, const gp_Pnt2d& c) { return gp_Vec2d(a, b).Crossed(gp_Vec2d(a, c)); }

}  // namespace

OnSurfaces::OnSurfaces(const Model& source, const ShellMesh& mesh, double near)
    : uv_(3 * mesh.triangles.size()), is_near_(uv_.size(), 0), is_on_(mesh.triangles.size(), 0) {
  struct Found {
    gp_Pnt2d uv;
    bool is_near;
  };
  std::unordered_map<std::uint64_t, Found> found;  // by face and node
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const ShellTriangle& triangle = mesh.triangles[t];
    const Handle(Geom_Surface)& surface = source.faces[triangle.face].offset.surface;
    if (surface.IsNull()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [known, is_new] =
          found.try_emplace(std::uint64_t(triangle.face) << 32 | triangle.nodes[k], Found{{}, false});
      if (is_new) {
        double distance = 0;
        known->second.uv = project(*surface, mesh.points[triangle.vertices[k]], triangle.origin[k], &distance);
        known->second.is_near = distance <= near;
      }
      uv_[3 * t + k] = known->second.uv;
      is_near_[3 * t + k] = known->second.is_near;
    }
    is_on_[t] = lies_on(source, mesh, static_cast<int>(t));
  }
}

bool OnSurfaces::lies_on(const Model& source, const ShellMesh& mesh, int triangle) const {
  const ShellTriangle& t = mesh.triangles[triangle];
  const std::size_t first = 3 * static_cast<std::size_t>(triangle);
  if (!is_near_[first] || !is_near_[first + 1] || !is_near_[first + 2]) return false;
  const gp_Pnt2d &a = uv_[first], &b = uv_[first + 1], &c = uv_[first + 2];
  if (!(area(t.origin[0], t.origin[1], t.origin[2]) * area(a, b, c) > 0)) return false;
  const ModelFace& face = source.faces[t.face];
  const gp_Pnt2d middle((a.XY() + b.XY() + c.XY()) / 3);
  gp_Pnt at;
  gp_Vec du, dv;
  face.offset.surface->D1(middle.X(), middle.Y(), at, du, dv);
  const gp_Pnt &p = mesh.points[t.vertices[0]], &q = mesh.points[t.vertices[1]], &r = mesh.points[t.vertices[2]];
  return gp_Vec(p, q).Crossed(gp_Vec(p, r)).Dot(du.Crossed(dv)) * face.sign > 0;
}

}  // namespace vdb_offset::cad
