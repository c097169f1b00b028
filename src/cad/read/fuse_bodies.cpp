// SPDX-License-Identifier: Apache-2.0
#include "read/fuse_bodies.h"

#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <utility>
#include <vector>

#include "read/body_shape.h"

namespace vdb_offset::cad {
namespace {

/// Of each face of the union, the number of the one that it is left of.
TopTools_DataMapOfShapeInteger origins_of(const std::vector<BodyFace>& faces, BRepAlgoAPI_Fuse& fuse) {
  TopTools_DataMapOfShapeInteger origins;
  for (std::size_t number = 0; number < faces.size(); ++number) {
    const TopoDS_Face& face = faces[number].face;
    TopTools_ListOfShape made = fuse.Modified(face);
    if (made.IsEmpty() && !fuse.IsDeleted(face)) made.Append(face);
    // Where faces of two bodies coincide, what is left of both is told of the first.
    for (const TopoDS_Shape& each : made)
      if (!origins.IsBound(each)) origins.Bind(each, static_cast<int>(number));
  }
  return origins;
}

/// A solid with its faces in the order of the file; and which of its faces is the first of them.
std::pair<int, Body> body_of(const TopoDS_Shape& solid, const std::vector<BodyFace>& faces,
                             const TopTools_DataMapOfShapeInteger& origins) {
  std::vector<std::pair<int, TopoDS_Face>> own;
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    if (!origins.IsBound(face.Current())) throw InvalidCad("expected a union of the faces, got one with others");
    own.emplace_back(origins(face.Current()), TopoDS::Face(face.Current()));
  }
  std::stable_sort(own.begin(), own.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  Body body{true, {}};
  for (const auto& [number, face] : own) {
    body.faces.push_back(faces[static_cast<std::size_t>(number)]);
    body.faces.back().face = face;
  }
  return {own.front().first, std::move(body)};
}

/// The union's solids, in the order of the file.
std::vector<Body> united(const std::vector<Body>& solids) {
  TopTools_ListOfShape first, others;
  for (const Body& body : solids) (first.IsEmpty() ? first : others).Append(shape_of(body).shape);
  BRepAlgoAPI_Fuse fuse;
  fuse.SetArguments(first);
  fuse.SetTools(others);
  fuse.SetRunParallel(false);
  fuse.SetNonDestructive(true);
  fuse.Build();
  if (fuse.HasErrors() || !BRepCheck_Analyzer(fuse.Shape()).IsValid()) return {};
  std::vector<BodyFace> faces;
  for (const Body& body : solids) faces.insert(faces.end(), body.faces.begin(), body.faces.end());
  const TopTools_DataMapOfShapeInteger origins = origins_of(faces, fuse);
  std::vector<std::pair<int, Body>> made;
  for (TopExp_Explorer solid(fuse.Shape(), TopAbs_SOLID); solid.More(); solid.Next())
    made.push_back(body_of(solid.Current(), faces, origins));
  std::sort(made.begin(), made.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Body> bodies;
  for (auto& [number, body] : made) bodies.push_back(std::move(body));
  return bodies;
}

}  // namespace

void fuse_bodies(CadModel& model) {
  std::vector<Body> solids, bodies;
  for (const Body& body : model.bodies)
    if (body.is_solid) solids.push_back(body);
  if (solids.size() < 2) return;
  try {
    bodies = united(solids);
  } catch (const Standard_Failure&) {
    bodies.clear();
  }
  if (bodies.empty())
    throw InvalidCad("expected bodies that OpenCASCADE can fuse, got others: leave --bodies fuse out");
  for (const Body& body : model.bodies)
    if (!body.is_solid) bodies.push_back(body);
  model.bodies = std::move(bodies);
}

}  // namespace vdb_offset::cad
