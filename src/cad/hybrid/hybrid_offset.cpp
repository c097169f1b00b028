// SPDX-License-Identifier: Apache-2.0
#include "hybrid/hybrid_offset.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepCheck_Wire.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <cmath>
#include <set>

#include "ground/mesh/point_triangle.h"
#include "hybrid/hybrid_model.h"
#include "judge/soup.h"
#include "judge/soup_samples.h"
#include "offset/build.h"

namespace vdb_offset::cad {
namespace {

constexpr int kMostRounds = 40;
constexpr int kTurnsSamples = 300;
constexpr double kReach = 0.25;  // distances: how far from a place of a fault triangles are taken in place of faces

/// How far vertices of the mesh may be from exact faces.
double near_of(ExactParts parts, const Tolerances& tolerances) {
  constexpr double kNear = 0.1;  // distances
  return parts == ExactParts::Near ? kNear * tolerances.distance : parts == ExactParts::There ? tolerances.gap : -1;
}

/// How far a triangle is from a point.
double distance_from(const gp_Pnt& point, const ShellMesh& mesh, int triangle) {
  const auto vector = [](const gp_Pnt& p) { return Vec3d(p.X(), p.Y(), p.Z()); };
  const auto& [a, b, c] = mesh.triangles[triangle].vertices;
  return std::sqrt(
      closest_on_triangle(vector(point), vector(mesh.points[a]), vector(mesh.points[b]), vector(mesh.points[c]))
          .squared_distance);
}

}  // namespace

/// Makes a shell, and triangles of what is exact and not good, until all of it is good.
class HybridOffset::Shell {
 public:
  Shell(Model source, const ShellMesh& mesh, const Tolerances& tolerances, ExactParts parts)
      : source_(std::move(source)),
        mesh_(mesh),
        tolerances_(tolerances),
        on_(source_, mesh, near_of(parts, tolerances)) {}

  TopoDS_Shape make() {
    for (int round = 0; round < kMostRounds; ++round) {
      hybrid_ = hybrid_model(source_, mesh_, on_, tolerances_);
      std::vector<int> bad = hybrid_.off;
      built_ = {};
      if (bad.empty()) {
        built_ = build_shell(hybrid_.model, tolerances_);
        for (const int edge : built_.bad_edges) append(hybrid_.triangles_of_edge[edge], bad);
      }
      if (bad.empty()) add_bad_faces(bad);
      std::erase_if(bad, [&](int t) { return !on_.is_on(t); });
      if (bad.empty()) return built_.shell;
      for (const int t : bad) on_.take_off(t);
    }
    return {};
  }

  /// Makes triangles of what is exact near places; false if nothing is.
  bool take_off_near(const std::vector<gp_Pnt>& places) {
    bool is_any = false;
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) {
      if (!on_.is_on(t) || !is_near(t, places)) continue;
      on_.take_off(t);
      is_any = true;
    }
    return is_any;
  }

  const HybridModel& hybrid() const { return hybrid_; }
  const std::vector<TopoDS_Face>& faces() const { return built_.faces; }
  const Model& source() const { return source_; }

 private:
  static void append(const std::vector<int>& more, std::vector<int>& all) {
    all.insert(all.end(), more.begin(), more.end());
  }

  /// Faces that are not valid, have no triangles, cross others, or lie within others.
  void add_bad_faces(std::vector<int>& bad) const {
    if (built_.shell.IsNull()) return;
    for (std::size_t f = 0; f < built_.faces.size() && hybrid_.source_faces[f] >= 0; ++f)
      if (!BRepCheck_Analyzer(built_.faces[f]).IsValid()) append(triangles_at_fault(static_cast<int>(f)), bad);
    if (!bad.empty()) return;
    const Soup soup = Soup::of_result(built_.shell, tolerances_.distance);
    append(triangles_that_cross(soup), bad);
    if (!bad.empty() || !built_.shell.Closed()) return;
    for (const int f : soup.open_faces()) append(hybrid_.triangles_of_face[f], bad);
    if (!bad.empty()) return;
    if (const auto turned = turned_triangle(soup, tolerances_.distance, kTurnsSamples, true))
      append(hybrid_.triangles_of_face[soup.triangles()[*turned].face], bad);
  }

  /// Those of faces that cross others; of large ones, those near places where they do.
  std::vector<int> triangles_that_cross(const Soup& soup) const {
    constexpr std::size_t kLarge = 200, kMostPlaces = 200;
    std::vector<int> found;
    std::set<int> large;
    for (const auto& pair : soup.crossing_faces())
      for (const int f : pair)
        if (hybrid_.triangles_of_face[f].size() > kLarge) large.insert(f);
        else append(hybrid_.triangles_of_face[f], found);
    if (large.empty()) return found;
    const std::vector<gp_Pnt> places = soup.crossings(kMostPlaces);
    for (const int f : large)
      for (const int t : hybrid_.triangles_of_face[f])
        if (is_near(t, places)) found.push_back(t);
    if (found.empty())
      for (const int f : large) append(hybrid_.triangles_of_face[f], found);
    return found;
  }

  bool is_near(int triangle, const std::vector<gp_Pnt>& places) const {
    return std::any_of(places.begin(), places.end(), [&](const gp_Pnt& place) {
      return distance_from(place, mesh_, triangle) <= kReach * tolerances_.distance;
    });
  }

  /// Of a face whose borders cross themselves, the triangles where they do, and those beside these; else all.
  std::vector<int> triangles_at_fault(int f) const {
    const std::vector<int>& all = hybrid_.triangles_of_face[f];
    std::set<std::uint32_t> vertices;
    for (TopExp_Explorer w(built_.faces[f], TopAbs_WIRE); w.More(); w.Next()) {
      TopoDS_Edge one, other;
      const Handle(BRepCheck_Wire) wire = new BRepCheck_Wire(TopoDS::Wire(w.Current()));
      if (wire->SelfIntersect(built_.faces[f], one, other) == BRepCheck_NoError) continue;
      for (std::size_t e = 0; e < built_.edges.size(); ++e) {
        const TopoDS_Edge& edge = built_.edges[e];
        if (edge.IsNull() || !((!one.IsNull() && edge.IsSame(one)) || (!other.IsNull() && edge.IsSame(other))))
          continue;
        for (const int t : hybrid_.triangles_of_edge[e])
          vertices.insert(mesh_.triangles[t].vertices.begin(), mesh_.triangles[t].vertices.end());
      }
    }
    std::vector<int> found;
    for (const int t : all) {
      const auto& corners = mesh_.triangles[t].vertices;
      if (std::any_of(corners.begin(), corners.end(), [&](auto v) { return vertices.count(v) > 0; }))
        found.push_back(t);
    }
    return found.empty() ? all : found;
  }

  const Model source_;
  const ShellMesh& mesh_;
  const Tolerances& tolerances_;
  OnSurfaces on_;
  HybridModel hybrid_;
  Built built_;
};

namespace {

double area_of(const ShellMesh& mesh, int triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle].vertices;
  const gp_Pnt& p = mesh.points[a];
  return gp_Vec(p, mesh.points[b]).Crossed(gp_Vec(p, mesh.points[c])).Magnitude() / 2;
}

/// Leaves a shell that cannot be taken apart with its faces alone, which become triangles.
void forget_surfaces(const TopoDS_Shape& shell, Model& model) {
  model = {};
  for (TopExp_Explorer face(shell, TopAbs_FACE); face.More(); face.Next()) model.faces.emplace_back();
}

}  // namespace

/// How the faces of a shell were made, and what became of each.
void HybridOffset::report(const Shell& shell, const ShellMesh& mesh, std::size_t first, OffsetCadResult& result) {
  const HybridModel& hybrid = shell.hybrid();
  BRep_Builder builder;
  for (std::size_t f = 0; f < hybrid.model.faces.size(); ++f) {
    const std::vector<int>& triangles = hybrid.triangles_of_face[f];
    const std::size_t source = first + static_cast<std::size_t>(mesh.triangles[triangles.front()].face);
    TopoDS_Shape& made = result.made_of[source];
    if (made.IsNull()) builder.MakeCompound(static_cast<TopoDS_Compound&>(made = TopoDS_Compound()));
    builder.Add(made, shell.faces()[f]);
    const bool is_exact = hybrid.source_faces[f] >= 0;
    for (const int t : triangles) (is_exact ? result.exact_area : result.flat_area) += area_of(mesh, t);
    if (is_exact) continue;
    result.faces[source] = CadFace::Faceted;
    ++result.triangles;
  }
}

HybridOffset::HybridOffset(const OffsetCadRequest& request, std::vector<ShellMesh> meshes, ExactParts parts)
    : request_(request), meshes_(std::move(meshes)), tolerances_(tolerances_of(request)) {
  std::size_t first = 0;
  for (TopExp_Explorer s(request.source, TopAbs_SHELL); s.More(); s.Next()) {
    Model model = offset_faces(s.Current(), request, first);
    if (!model.failure.empty()) forget_surfaces(s.Current(), model);
    first += model.faces.size();
    const ShellMesh& mesh = meshes_[shells_.size()];
    shells_.push_back(std::make_unique<Shell>(std::move(model), mesh, tolerances_, parts));
  }
}

HybridOffset::~HybridOffset() = default;

bool HybridOffset::take_off_near(const std::vector<gp_Pnt>& places) {
  bool is_any = false;
  for (const auto& shell : shells_) is_any = shell->take_off_near(places) || is_any;
  return is_any;
}

OffsetCadResult HybridOffset::make() {
  OffsetCadResult result;
  BRep_Builder builder;
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  TopoDS_Compound all;
  builder.MakeCompound(all);
  const bool is_solid = request_.source.ShapeType() == TopAbs_SOLID;
  for (std::size_t s = 0; s < shells_.size(); ++s) {
    Shell& shell = *shells_[s];
    const std::size_t first = result.faces.size();
    for (const ModelFace& face : shell.source().faces) {
      result.fit_error = std::max(result.fit_error, face.offset.error);
      result.faces.push_back(made_by(face.offset.made));
    }
    result.made_of.resize(result.faces.size());
    const TopoDS_Shape made = shell.make();
    if (made.IsNull()) result.gaps.emplace_back("exact faces and triangles do not join");
    else builder.Add(is_solid ? static_cast<TopoDS_Shape&>(solid) : all, made);
    if (!made.IsNull()) report(shell, meshes_[s], first, result);
  }
  if (!result.gaps.empty()) return result;
  if (is_solid) result.shape = solid;
  else if (shells_.size() == 1) result.shape = TopExp_Explorer(all, TopAbs_SHELL).Current();
  else result.shape = all;
  return result;
}

}  // namespace vdb_offset::cad
