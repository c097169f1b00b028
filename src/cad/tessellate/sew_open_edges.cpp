// SPDX-License-Identifier: Apache-2.0
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cstdio>

#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {
namespace {

// What edges may miss each other by, where the file says less, as shares of the diagonal: each is tried as long as the
// body stays open. What OpenCASCADE itself counts as one point comes first.
constexpr double kOwnTolerance = 1e-7;
constexpr double kShares[] = {0, 1e-6, 1e-5, 1e-4};

/// The body with its faces sewn.
Body sewn(const Body& body, double tolerance) {
  BRepBuilderAPI_Sewing sewing(tolerance);
  for (const BodyFace& face : body.faces)
    if (!face.is_left_out) sewing.Add(face.face);
  sewing.Perform();
  Body result = body;
  for (BodyFace& face : result.faces) {
    if (face.is_left_out) continue;
    const TopoDS_Shape& changed = sewing.Modified(face.face);
    // A face that has come to nothing stays as it was.
    if (!changed.IsNull() && changed.ShapeType() == TopAbs_FACE) face.face = TopoDS::Face(changed);
  }
  return result;
}

}  // namespace

std::size_t count_free_edges(const Body& body) {
  TopTools_IndexedMapOfShape edges;
  std::vector<int> uses;
  for (const BodyFace& face : body.faces)
    for (TopExp_Explorer found(face.face, TopAbs_EDGE); found.More() && !face.is_left_out; found.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(found.Current());
      const TopAbs_Orientation way = edge.Orientation();
      if (BRep_Tool::Degenerated(edge) || way == TopAbs_INTERNAL || way == TopAbs_EXTERNAL) continue;
      const auto index = static_cast<std::size_t>(edges.Add(edge));
      if (index > uses.size()) uses.push_back(0);
      ++uses[index - 1];
    }
  return static_cast<std::size_t>(std::count(uses.begin(), uses.end(), 1));
}

bool sew_open_edges(Body& body, double tolerance, double diagonal, std::vector<std::string>& remarks) {
  const std::size_t before = count_free_edges(body);
  if (before == 0) return false;
  std::size_t least = before;
  double used = 0;
  Body best;
  for (const double share : kShares) {
    const double most = std::max({kOwnTolerance, tolerance, share * diagonal});
    if (most <= used) continue;
    Body tried = sewn(body, most);
    const std::size_t free = count_free_edges(tried);
    if (free >= least) continue;
    least = free;
    used = most;
    best = std::move(tried);
    if (least == 0) break;
  }
  if (least == before) return false;
  body = std::move(best);
  char text[160];
  std::snprintf(text, sizeof(text), "%zu of %zu open edges of faces are closed by sewing them at a tolerance of %.2g",
                before - least, before, used);
  remarks.emplace_back(text);
  return true;
}

}  // namespace vdb_offset::cad
