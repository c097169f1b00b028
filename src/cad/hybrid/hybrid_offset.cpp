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
#include <functional>
#include <iterator>
#include <map>
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
constexpr std::size_t kMostPlaces = 200;
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
        built_ = build_shell(hybrid_.model, tolerances_, known_);
        for (const int edge : built_.bad_edges) append(hybrid_.triangles_of_edge[edge], bad);
      }
      if (bad.empty()) add_bad_faces(bad);
      if (!take_off(bad)) return built_.shell;
    }
    return {};
  }

  /// Makes triangles of what is exact near places; false if nothing is.
  bool take_off_near(const std::vector<gp_Pnt>& places) {
    std::vector<int> bad;
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t)
      if (is_near(t, places)) bad.push_back(t);
    return take_off(bad);
  }

  const HybridModel& hybrid() const { return hybrid_; }
  const std::vector<TopoDS_Face>& faces() const { return built_.faces; }
  const Model& source() const { return source_; }

 private:
  /// Makes triangles of what is exact of bad ones, and of what is exact beside those that are plane already: only that
  /// can have moved their vertices. False if nothing is.
  bool take_off(const std::vector<int>& bad) {
    std::vector<char> is_moved(mesh_.points.size(), 0), is_bad(mesh_.triangles.size(), 0);
    for (const int t : bad) {
      is_bad[t] = 1;
      if (on_.is_on(t)) continue;
      for (const std::uint32_t v : mesh_.triangles[t].vertices) is_moved[v] = 1;
    }
    bool is_any = false;
    for (int t = 0; t < static_cast<int>(is_bad.size()); ++t) {
      const auto& corners = mesh_.triangles[t].vertices;
      const bool is_beside = std::any_of(corners.begin(), corners.end(), [&](auto v) { return is_moved[v] != 0; });
      if (!on_.is_on(t) || (is_bad[t] == 0 && !is_beside)) continue;
      on_.take_off(t);
      is_any = true;
    }
    return is_any;
  }

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
    std::set<int> crossing;
    for (const auto& pair : soup.crossing_faces()) crossing.insert(pair.begin(), pair.end());
    append(triangles_near(crossing, [&] { return soup.crossings(kMostPlaces); }), bad);
    if (!bad.empty() || !built_.shell.Closed()) return;
    const std::vector<int> open = soup.open_faces();
    append(triangles_near({open.begin(), open.end()}, [&] { return soup.open_places(); }), bad);
    if (!bad.empty()) return;
    std::set<int> turned;
    std::vector<gp_Pnt> middles;
    for (const int t : turned_triangles(soup, tolerances_.distance, kTurnsSamples, true)) {
      turned.insert(soup.triangles()[t].face);
      middles.push_back(middle_of(soup.triangles()[t]));
    }
    append(triangles_near(turned, [&] { return middles; }), bad);
  }

  /// Those of some faces; of large ones, those near places.
  std::vector<int> triangles_near(const std::set<int>& faces,
                                  const std::function<std::vector<gp_Pnt>()>& find_places) const {
    constexpr std::size_t kLarge = 200;
    std::vector<int> found, of_large;
    for (const int f : faces)
      append(hybrid_.triangles_of_face[f], hybrid_.triangles_of_face[f].size() > kLarge ? of_large : found);
    if (of_large.empty()) return found;
    const std::vector<gp_Pnt> places = find_places();
    for (const int t : of_large)
      if (is_near(t, places)) found.push_back(t);
    return found.empty() ? of_large : found;
  }

  bool is_near(int triangle, const std::vector<gp_Pnt>& places) const {
    return std::any_of(places.begin(), places.end(), [&](const gp_Pnt& place) {
      return distance_from(place, mesh_, triangle) <= kReach * tolerances_.distance;
    });
  }

  /// Of a face that is not valid, the triangles beside edges that may be at fault, and those beside these; else all.
  std::vector<int> triangles_at_fault(int f) const {
    std::set<int> edges = edges_that_cross(f);
    edges.merge(edges_at_pinches(f));
    if (edges.empty()) edges = edges_of_holes(f);
    std::vector<char> is_beside(mesh_.points.size(), 0);
    for (const int e : edges)
      for (const int t : hybrid_.triangles_of_edge[e])
        for (const std::uint32_t v : mesh_.triangles[t].vertices) is_beside[v] = 1;
    const std::vector<int>& all = hybrid_.triangles_of_face[f];
    std::vector<int> found;
    std::copy_if(all.begin(), all.end(), std::back_inserter(found), [&](int t) {
      const auto& corners = mesh_.triangles[t].vertices;
      return std::any_of(corners.begin(), corners.end(), [&](auto v) { return is_beside[v] != 0; });
    });
    return found.empty() ? all : found;
  }

  /// Those of a border of a face that cross each other.
  std::set<int> edges_that_cross(int f) const {
    std::set<int> found;
    for (TopExp_Explorer w(built_.faces[f], TopAbs_WIRE); w.More(); w.Next()) {
      TopoDS_Edge one, other;
      const Handle(BRepCheck_Wire) wire = new BRepCheck_Wire(TopoDS::Wire(w.Current()));
      if (wire->SelfIntersect(built_.faces[f], one, other) == BRepCheck_NoError) continue;
      for (std::size_t e = 0; e < built_.edges.size(); ++e) {
        const TopoDS_Edge& edge = built_.edges[e];
        if (!edge.IsNull() && ((!one.IsNull() && edge.IsSame(one)) || (!other.IsNull() && edge.IsSame(other))))
          found.insert(static_cast<int>(e));
      }
    }
    return found;
  }

  /// Those that start where another of the same face does, which leaves open how its borders go on.
  std::set<int> edges_at_pinches(int f) const {
    std::set<int> found;
    std::map<int, int> first_at;  // vertices
    for (const int loop : hybrid_.model.faces[f].loops)
      for (const int h : halves_of(loop)) {
        const HalfEdge& half = hybrid_.model.halves[h];
        const auto [at, is_new] = first_at.try_emplace(half.vertex, half.edge);
        if (!is_new && hybrid_.model.edges[half.edge].kind != EdgeKind::Pole) found.insert({at->second, half.edge});
      }
    return found;
  }

  /// Those of all borders but the longest.
  std::set<int> edges_of_holes(int f) const {
    std::set<int> found;
    std::vector<int> outer;
    for (const int loop : hybrid_.model.faces[f].loops) {
      std::vector<int> inner = halves_of(loop);
      if (inner.size() > outer.size()) std::swap(inner, outer);
      for (const int h : inner) found.insert(hybrid_.model.halves[h].edge);
    }
    return found;
  }

  std::vector<int> halves_of(int loop) const {
    std::vector<int> halves = {loop};
    for (int h = hybrid_.model.halves[loop].next; h != loop; h = hybrid_.model.halves[h].next) halves.push_back(h);
    return halves;
  }

  const Model source_;
  const ShellMesh& mesh_;
  const Tolerances& tolerances_;
  OnSurfaces on_;
  KnownCurves known_;
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
    if (meshes_[s].triangles.empty()) {  // of a face no wider than a line
      std::fill(result.faces.begin() + static_cast<std::ptrdiff_t>(first), result.faces.end(), CadFace::Swallowed);
      continue;
    }
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
