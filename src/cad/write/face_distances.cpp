// SPDX-License-Identifier: Apache-2.0
#include "write/face_distances.h"

#include <BRepTools.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <string>
#include <utility>

#include "vdb_offset/distances.h"
#include "write/blended_faces.h"

namespace vdb_offset::cad {
namespace {

double share_of(double at, double first, double last) { return last > first ? (at - first) / (last - first) : 0; }

/// The distance that an expression gives a face, whose parameters it has scaled to their ranges.
FaceDistance expressed(const DistanceExpression& expression, const TopoDS_Face& face, double diagonal,
                       double millimetres) {
  Box2 range{};
  BRepTools::UVBounds(face, range.u0, range.u1, range.v0, range.v1);
  const double sign = face.Orientation() == TopAbs_REVERSED ? -1 : 1;
  FaceDistance distance;
  distance.at = [surface = surface_of(face), range, sign, millimetres, at_point = expression.at_points(diagonal)](
                    double u, double v) {
    const gp_Pnt p = surface->Value(u, v);
    const gp_Vec n = unit_normal(*surface, u, v, range) * sign;
    return millimetres * at_point({.position = Vec3d(p.X(), p.Y(), p.Z()) / millimetres,
                                   .normal = Vec3d(n.X(), n.Y(), n.Z()),
                                   .texture = Vec2d(share_of(u, range.u0, range.u1), share_of(v, range.v0, range.v1))});
  };
  return distance;
}

}  // namespace

std::vector<FaceDistance> distances_of(const io::WriteCad& write, std::size_t first_face, const BodyShape& shape,
                                       double millimetres) {
  std::vector<PartOfFace> faces;
  std::vector<std::pair<double, std::string>> parts;  // what is the same is one part
  std::size_t alone = write.of_face.size();
  for (TopExp_Explorer face(shape.shape, TopAbs_FACE); face.More(); face.Next()) {
    const io::CadFaceDistance& own = write.of_face[first_face + shape.face_numbers[faces.size()]];
    PartOfFace& each = faces.emplace_back();
    const std::pair key(own.expression.empty() ? own.number : 0, own.expression);
    each.part = static_cast<std::size_t>(std::find(parts.begin(), parts.end(), key) - parts.begin());
    if (each.part == parts.size()) parts.push_back(key);
    each.distance.constant = millimetres * own.number;
    if (own.expression.empty()) continue;
    const DistanceExpression expression(own.expression);
    each.distance = expressed(expression, TopoDS::Face(face.Current()), write.diagonal, millimetres);
    // Each face has a u and a v of its own.
    if (expression.uses_texture()) each.part = alone++;
  }
  if (write.blend > 0) return blended_faces(shape.shape, faces, millimetres * write.blend);
  std::vector<FaceDistance> distances;
  for (PartOfFace& each : faces) distances.push_back(std::move(each.distance));
  return distances;
}

}  // namespace vdb_offset::cad
