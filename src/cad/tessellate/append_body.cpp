// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {
namespace {

// Faces whose normals differ by less meet smoothly. Files keep directions and trimming curves to some 1e-3 of a radian,
// and approximated fillets are off by tenths of a degree; and a miter of a degree is only 4e-5 longer than the
// distance.
constexpr double kSharpAngle = std::numbers::pi / 180;
// How far from a pole, as a share of the way to the triangle's middle, its normal there is taken.
constexpr double kBesidePole = 1e-5;

/// What an edge of triangles has on its sides, along an edge of the model.
struct Sides {
  int count = 0;
  gp_Vec normals[2];
};

gp_Vec normal_beside(const FaceMesh& face, const Triangle& t, double u, double v) {
  double to_u = 0, to_v = 0;
  for (const std::uint32_t node : t) to_u += face.nodes[node].u / 3, to_v += face.nodes[node].v / 3;
  for (double share = kBesidePole; share <= 1; share *= 10)
    if (const auto normal = face.surface.normal(u + share * (to_u - u), v + share * (to_v - v)))
      return *normal * face.side;
  return {0, 0, 0};
}

gp_Vec flat_normal(const BodyMesh& mesh, const FaceMesh& face, const Triangle& t) {
  const gp_Pnt &a = mesh.positions[face.nodes[t[0]].vertex], &b = mesh.positions[face.nodes[t[1]].vertex],
               &c = mesh.positions[face.nodes[t[2]].vertex];
  const gp_Vec across = gp_Vec(a, b).Crossed(gp_Vec(a, c));
  const double length = across.Magnitude();
  return length > 0 ? across / length : gp_Vec(0, 0, 1);
}

/// The normal of a face beside an edge of a triangle, in the middle of the edge's part of the model.
gp_Vec normal_at_edge(const BodyMesh& mesh, const FaceMesh& face, const Triangle& t, std::size_t k,
                      const gp_Pnt& middle) {
  const Node &a = face.nodes[t[k]], &b = face.nodes[t[(k + 1) % 3]];
  const Foot foot = face.surface.foot(middle, (a.u + b.u) / 2, (a.v + b.v) / 2);
  if (const auto normal = face.surface.normal(foot.u, foot.v)) return *normal * face.side;
  const gp_Vec beside = normal_beside(face, t, foot.u, foot.v);
  return beside.SquareMagnitude() > 0 ? beside : flat_normal(mesh, face, t);
}

using SidesOfEdges = std::unordered_map<std::uint64_t, Sides>;

void note_sides(const BodyMesh& mesh, const FaceMesh& face, SidesOfEdges& sides) {
  for (const Triangle& t : face.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t key = BodyMesh::key(face.nodes[t[k]].vertex, face.nodes[t[(k + 1) % 3]].vertex);
      const auto segment = mesh.segments.find(key);
      if (segment == mesh.segments.end()) continue;
      Sides& at = sides[key];
      if (++at.count > 2) continue;
      const Segment& part = segment->second;
      const gp_Pnt middle = mesh.curves[part.edge].Value((part.lower + part.upper) / 2);
      at.normals[at.count - 1] = normal_at_edge(mesh, face, t, k, middle);
    }
}

void append_edges(const BodyMesh& mesh, const std::vector<std::uint32_t>& number, io::CadMesh& result) {
  SidesOfEdges sides;
  for (const FaceMesh& face : mesh.faces) note_sides(mesh, face, sides);
  std::vector<std::pair<std::array<std::uint32_t, 2>, io::CadEdge>> edges;
  for (const auto& [key, at] : sides) {
    if (at.count < 2) continue;
    const std::uint32_t a = number[key >> 32], b = number[key & 0xffffffff];
    const double angle = std::atan2(at.normals[0].Crossed(at.normals[1]).Magnitude(), at.normals[0].Dot(at.normals[1]));
    edges.push_back({{std::min(a, b), std::max(a, b)},
                     at.count > 2 || angle > kSharpAngle ? io::CadEdge::Sharp : io::CadEdge::Tangent});
  }
  std::sort(edges.begin(), edges.end());
  for (const auto& [edge, kind] : edges) result.edges.push_back(edge), result.edge_kinds.push_back(kind);
}

/// Numbers the vertices that triangles have, in their order.
std::vector<std::uint32_t> append_vertices(const BodyMesh& mesh, io::CadMesh& result) {
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  for (const FaceMesh& face : mesh.faces)
    for (const Triangle& t : face.triangles)
      for (const std::uint32_t node : t) number[face.nodes[node].vertex] = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    number[v] = static_cast<std::uint32_t>(result.positions.size());
    const gp_Pnt& at = mesh.positions[v];
    result.positions.emplace_back(at.X(), at.Y(), at.Z());
  }
  return number;
}

}  // namespace

gp_Vec corner_normal(const BodyMesh& mesh, const FaceMesh& face, const Triangle& triangle, std::size_t corner) {
  const Node& node = face.nodes[triangle[corner]];
  if (const auto normal = face.surface.normal(node.u, node.v)) return *normal * face.side;
  const gp_Vec beside = normal_beside(face, triangle, node.u, node.v);
  return beside.SquareMagnitude() > 0 ? beside : flat_normal(mesh, face, triangle);
}

void append_body(BodyMesh& mesh, const Body& body, io::CadMesh& result) {
  mesh.numbers = append_vertices(mesh, result);
  const std::vector<std::uint32_t>& number = mesh.numbers;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const FaceMesh& face = mesh.faces[f];
    io::CadFaceFacts facts = body.faces[f].facts;
    facts.kind = face.surface.kind();
    facts.u = {face.surface.first_u(), face.surface.last_u()};
    facts.v = {face.surface.first_v(), face.surface.last_v()};
    for (const Triangle& t : face.triangles) {
      result.triangles.push_back(
          {number[face.nodes[t[0]].vertex], number[face.nodes[t[1]].vertex], number[face.nodes[t[2]].vertex]});
      result.face_of.push_back(static_cast<std::uint32_t>(result.faces.size()));
      for (std::size_t k = 0; k < 3; ++k) {
        const gp_Vec normal = corner_normal(mesh, face, t, k);
        result.corner_normals.emplace_back(normal.X(), normal.Y(), normal.Z());
        result.corner_parameters.push_back({face.nodes[t[k]].u, face.nodes[t[k]].v});
      }
    }
    result.faces.push_back(std::move(facts));
  }
  append_edges(mesh, number, result);
}

}  // namespace vdb_offset::cad
