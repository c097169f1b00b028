// SPDX-License-Identifier: Apache-2.0
#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "tessellate/body_mesh.h"

#include "ground/numbers/disjoint_sets.h"

namespace vdb_offset::cad {
namespace {

struct EdgeNodes {
  std::vector<std::uint32_t> vertices;
  std::vector<double> parameters;
};

/// Gives numbers to vertices, of which some turn out to be one.
class Joiner {
 public:
  explicit Joiner(BodyMesh& mesh) : mesh_(mesh) {}

  std::uint32_t add(const gp_Pnt& at, bool is_on_edge) {
    mesh_.positions.push_back(at);
    mesh_.is_on_edge.push_back(is_on_edge);
    return same_.add();
  }

  std::uint32_t find(std::uint32_t vertex) { return same_.first(vertex); }
  void join(std::uint32_t a, std::uint32_t b) { same_.join(a, b); }

  std::uint32_t of_vertex(const TopoDS_Vertex& vertex) {
    const int index = vertices_.Add(vertex);
    if (static_cast<std::size_t>(index) > ids_.size()) ids_.push_back(add(BRep_Tool::Pnt(vertex), true));
    return ids_[static_cast<std::size_t>(index) - 1];
  }

  /// The vertices along an edge, in the order of a face's nodes.
  std::vector<std::uint32_t> along(const TopoDS_Edge& edge, const Poly_PolygonOnTriangulation& polygon,
                                   const std::vector<gp_Pnt>& nodes) {
    const int index = edges_.Add(edge);
    if (static_cast<std::size_t>(index) > along_.size()) along_.push_back(first_along(edge, polygon, nodes));
    const EdgeNodes& known = along_[static_cast<std::size_t>(index) - 1];
    if (static_cast<int>(known.vertices.size()) == polygon.NbNodes()) return known.vertices;
    ++mesh_.unmatched;
    return matched(known, polygon, nodes);
  }

  TopoDS_Edge edge_of(std::size_t index) const { return TopoDS::Edge(edges_(static_cast<int>(index) + 1)); }

  /// Curves and their parts, when all faces are known.
  void make_segments() {
    for (std::size_t e = 0; e < along_.size(); ++e) {
      const EdgeNodes& nodes = along_[e];
      if (nodes.parameters.size() < 2 || BRep_Tool::Degenerated(edge_of(e))) continue;
      const auto curve = static_cast<std::uint32_t>(mesh_.curves.size());
      mesh_.curves.emplace_back(edge_of(e));
      for (std::size_t k = 0; k + 1 < nodes.vertices.size(); ++k) {
        const std::uint32_t a = find(nodes.vertices[k]), b = find(nodes.vertices[k + 1]);
        const double s = nodes.parameters[k], t = nodes.parameters[k + 1];
        if (a != b) mesh_.segments.try_emplace(BodyMesh::key(a, b), Segment{curve, a < b ? s : t, a < b ? t : s});
      }
    }
  }

 private:
  EdgeNodes first_along(const TopoDS_Edge& edge, const Poly_PolygonOnTriangulation& polygon,
                        const std::vector<gp_Pnt>& nodes) {
    const int count = polygon.NbNodes();
    EdgeNodes found;
    found.vertices.resize(static_cast<std::size_t>(count));
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    const TopoDS_Vertex first = TopExp::FirstVertex(forward), last = TopExp::LastVertex(forward);
    const bool is_degenerated = BRep_Tool::Degenerated(edge);
    const bool has_curve = !is_degenerated && polygon.HasParameters() && BRep_Tool::IsGeometric(edge);
    std::optional<BRepAdaptor_Curve> curve;
    if (has_curve) curve.emplace(edge);
    for (int k = 0; k < count; ++k) {
      const gp_Pnt& node = nodes[static_cast<std::size_t>(polygon.Node(k + 1)) - 1];
      std::uint32_t& vertex = found.vertices[static_cast<std::size_t>(k)];
      if (!first.IsNull() && (k == 0 || is_degenerated)) vertex = of_vertex(first);
      else if (!last.IsNull() && k + 1 == count) vertex = of_vertex(last);
      else vertex = add(curve ? curve->Value(polygon.Parameter(k + 1)) : node, true);
      if (has_curve) found.parameters.push_back(polygon.Parameter(k + 1));
    }
    return found;
  }

  /// Of an edge that is divided in another way: its ends, and where the parameters are the same.
  std::vector<std::uint32_t> matched(const EdgeNodes& known, const Poly_PolygonOnTriangulation& polygon,
                                     const std::vector<gp_Pnt>& nodes) {
    std::vector<std::uint32_t> vertices;
    const auto count = static_cast<std::size_t>(polygon.NbNodes());
    for (std::size_t k = 0; k < count; ++k) {
      std::optional<std::uint32_t> same;
      if (k == 0) same = known.vertices.front();
      else if (k + 1 == count) same = known.vertices.back();
      for (std::size_t j = 0; !same && polygon.HasParameters() && j < known.parameters.size(); ++j)
        if (std::abs(known.parameters[j] - polygon.Parameter(static_cast<int>(k) + 1)) < 1e-9) same = known.vertices[j];
      vertices.push_back(same ? *same
                              : add(nodes[static_cast<std::size_t>(polygon.Node(static_cast<int>(k) + 1)) - 1], true));
    }
    return vertices;
  }

  BodyMesh& mesh_;
  DisjointSets same_;
  std::vector<std::uint32_t> ids_;
  TopTools_IndexedMapOfShape vertices_, edges_;
  std::vector<EdgeNodes> along_;
};

std::vector<gp_Pnt> nodes_of(const Poly_Triangulation& mesh, const TopLoc_Location& place) {
  std::vector<gp_Pnt> nodes;
  nodes.reserve(static_cast<std::size_t>(mesh.NbNodes()));
  for (int k = 1; k <= mesh.NbNodes(); ++k) nodes.push_back(mesh.Node(k).Transformed(place.Transformation()));
  return nodes;
}

void join_edges(const TopoDS_Face& face, const opencascade::handle<Poly_Triangulation>& mesh,
                const TopLoc_Location& place, const std::vector<gp_Pnt>& nodes, Joiner& joiner,
                std::vector<std::uint32_t>& vertices, std::vector<std::uint8_t>& is_pole) {
  for (TopExp_Explorer found(face, TopAbs_EDGE); found.More(); found.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(found.Current());
    const auto polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, place);
    if (polygon.IsNull()) continue;
    const std::vector<std::uint32_t> along = joiner.along(edge, *polygon, nodes);
    for (int k = 1; k <= polygon->NbNodes(); ++k) {
      const auto node = static_cast<std::size_t>(polygon->Node(k)) - 1;
      if (BRep_Tool::Degenerated(edge)) is_pole[node] = 1;
      std::uint32_t& vertex = vertices[node];
      const std::uint32_t own = along[static_cast<std::size_t>(k) - 1];
      if (vertex == kNone) vertex = own;
      else joiner.join(vertex, own);
    }
  }
}

/// Gives each triangle at a pole a corner of its own there, with the parameter in the middle of the other two's: the
/// one that it shared with others may be of any place along the pole.
void part_poles(FaceMesh& face, const std::vector<std::uint8_t>& is_pole) {
  for (Triangle& t : face.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t own = t[k], next = t[(k + 1) % 3], last = t[(k + 2) % 3];
      if (own >= is_pole.size() || !is_pole[own]) continue;
      if (face.nodes[next].vertex == face.nodes[own].vertex || face.nodes[last].vertex == face.nodes[own].vertex)
        continue;
      Node node = face.nodes[own];
      if (face.surface.is_pole_of_u(node.u, node.v)) node.u = (face.nodes[next].u + face.nodes[last].u) / 2;
      else node.v = (face.nodes[next].v + face.nodes[last].v) / 2;
      t[k] = static_cast<std::uint32_t>(face.nodes.size());
      face.nodes.push_back(node);
    }
}

FaceMesh take_face(const BodyFace& of_model, Joiner& joiner, std::vector<std::uint8_t>& is_pole) {
  const TopoDS_Face& face = of_model.face;
  FaceMesh result{FaceSurface(face), 1, of_model.is_left_out, {}, {}};
  if (of_model.is_left_out) return result;
  TopLoc_Location place;
  const auto mesh = BRep_Tool::Triangulation(face, place);
  result.is_missing = mesh.IsNull() || mesh->NbTriangles() == 0;
  if (result.is_missing) return result;
  const bool is_turned = (face.Orientation() == TopAbs_REVERSED) != face.Location().Transformation().IsNegative();
  result.side = is_turned ? -1 : 1;
  const std::vector<gp_Pnt> nodes = nodes_of(*mesh, place);
  std::vector<std::uint32_t> vertices(nodes.size(), kNone);
  is_pole.assign(nodes.size(), 0);
  join_edges(face, mesh, place, nodes, joiner, vertices, is_pole);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Node node{vertices[k], 0, 0};
    if (mesh->HasUVNodes()) {
      const gp_Pnt2d uv = mesh->UVNode(static_cast<int>(k) + 1);
      node.u = uv.X(), node.v = uv.Y();
    }
    if (node.vertex == kNone) node.vertex = joiner.add(result.surface.point(node.u, node.v), false);
    result.nodes.push_back(node);
  }
  for (int k = 1; k <= mesh->NbTriangles(); ++k) {
    int a = 0, b = 0, c = 0;
    mesh->Triangle(k).Get(a, b, c);
    if (is_turned) std::swap(b, c);
    result.triangles.push_back(
        {static_cast<std::uint32_t>(a - 1), static_cast<std::uint32_t>(b - 1), static_cast<std::uint32_t>(c - 1)});
  }
  return result;
}

/// Without triangles that have come to nothing as their vertices are one: at poles, and where edges are too short. All
/// that they had in common with others is one as well.
void drop_collapsed(FaceMesh& face) {
  std::erase_if(face.triangles, [&](const Triangle& t) {
    const std::uint32_t a = face.nodes[t[0]].vertex, b = face.nodes[t[1]].vertex, c = face.nodes[t[2]].vertex;
    return a == b || b == c || c == a;
  });
}

/// Three vertices in increasing order, and whether a triangle goes round them in that sense.
struct Corners {
  Triangle sorted;
  bool is_even;
};

Corners corners_of(const FaceMesh& face, const Triangle& t) {
  Triangle v{face.nodes[t[0]].vertex, face.nodes[t[1]].vertex, face.nodes[t[2]].vertex};
  bool is_even = true;
  const auto order = [&](std::size_t a, std::size_t b) {
    if (v[a] > v[b]) std::swap(v[a], v[b]), is_even = !is_even;
  };
  order(0, 1), order(1, 2), order(0, 1);
  return {v, is_even};
}

/// Without pairs of triangles of the same vertices and opposite sense, to which faces fold together beside their poles:
/// all their sides have other triangles.
void drop_flaps(BodyMesh& mesh) {
  struct Place {
    Corners corners;
    std::uint32_t face, triangle;
  };
  std::vector<Place> places;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    for (std::uint32_t t = 0; t < mesh.faces[f].triangles.size(); ++t)
      places.push_back({corners_of(mesh.faces[f], mesh.faces[f].triangles[t]), f, t});
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.corners.sorted, a.face, a.triangle) < std::tie(b.corners.sorted, b.face, b.triangle);
  });
  constexpr std::uint32_t kFlap = kNone;  // for a first corner
  for (std::size_t k = 0; k + 1 < places.size(); ++k) {
    const Place &a = places[k], &b = places[k + 1];
    if (a.corners.sorted != b.corners.sorted || a.corners.is_even == b.corners.is_even) continue;
    for (const Place* place : {&a, &b}) mesh.faces[place->face].triangles[place->triangle][0] = kFlap;
    ++k;
  }
  for (FaceMesh& face : mesh.faces) std::erase_if(face.triangles, [](const Triangle& t) { return t[0] == kFlap; });
}

}  // namespace

BodyMesh take_mesh(const Body& body) {
  BodyMesh mesh;
  Joiner joiner(mesh);
  mesh.faces.reserve(body.faces.size());
  std::vector<std::vector<std::uint8_t>> is_pole(body.faces.size());
  for (std::size_t f = 0; f < body.faces.size(); ++f)
    mesh.faces.push_back(take_face(body.faces[f], joiner, is_pole[f]));
  for (FaceMesh& face : mesh.faces) {
    for (Node& node : face.nodes) node.vertex = joiner.find(node.vertex);
    drop_collapsed(face);
  }
  drop_flaps(mesh);
  flip_slivers(mesh);  // while triangles at poles still have corners in common
  for (std::size_t f = 0; f < body.faces.size(); ++f) part_poles(mesh.faces[f], is_pole[f]);
  joiner.make_segments();
  return mesh;
}

}  // namespace vdb_offset::cad
