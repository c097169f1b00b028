// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {
namespace {

// Each round halves edges, and quarters distances: eight take one that is 65,000 times too far.
constexpr int kMostDivisions = 8;

using Midpoints = std::unordered_map<std::uint64_t, std::uint32_t>;

gp_Pnt between(const gp_Pnt& a, const gp_Pnt& b) {
  return {(a.X() + b.X()) / 2, (a.Y() + b.Y()) / 2, (a.Z() + b.Z()) / 2};
}

/// How far the middle of a chord is from the curve's own, across the chord.
double height_of_chord(const gp_Pnt& a, const gp_Pnt& b, const gp_Pnt& on_curve) {
  const gp_Vec chord(a, b), off(a, on_curve);
  const double length = chord.Magnitude();
  return length > 0 ? chord.Crossed(off).Magnitude() / length : off.Magnitude();
}

/// Divides what is too far from the model.
class Divider {
 public:
  Divider(BodyMesh& mesh, double deflection) : mesh_(mesh), deflection_(deflection) {
    for (const FaceMesh& face : mesh_.faces) unsure_.emplace_back(face.triangles.size(), 1);
  }

  double divide() {
    double kept = 0;  // the most of what was near enough when it was looked at
    for (int round = 0;; ++round) {
      most_ = 0;
      midpoints_.clear();
      for (std::size_t f = 0; f < mesh_.faces.size(); ++f) mark(f);
      kept = std::max(kept, std::min(most_, deflection_));
      if (midpoints_.empty() || round == kMostDivisions) return std::max(kept, most_);
      for (std::size_t f = 0; f < mesh_.faces.size(); ++f) divide_face(f);
    }
  }

 private:
  gp_Pnt at(const FaceMesh& face, std::uint32_t node) const { return mesh_.positions[face.nodes[node].vertex]; }

  void note(double height) { most_ = std::max(most_, height); }

  /// Asks for a vertex in the middle of an edge.
  void ask(const FaceMesh& face, std::uint32_t a, std::uint32_t b) {
    midpoints_.try_emplace(BodyMesh::key(face.nodes[a].vertex, face.nodes[b].vertex), kNone);
  }

  double height_of_edge(const FaceMesh& face, std::uint32_t a, std::uint32_t b) const {
    const Node &from = face.nodes[a], &to = face.nodes[b];
    const gp_Pnt p = at(face, a), q = at(face, b);
    double height =
        face.surface.is_plane() ? 0 : face.surface.height(between(p, q), (from.u + to.u) / 2, (from.v + to.v) / 2);
    const auto segment = mesh_.segments.find(BodyMesh::key(from.vertex, to.vertex));
    if (segment == mesh_.segments.end()) return height;
    const Segment& part = segment->second;
    return std::max(height, height_of_chord(p, q, mesh_.curves[part.edge].Value((part.lower + part.upper) / 2)));
  }

  double height_of_middle(const FaceMesh& face, const Triangle& t) const {
    gp_XYZ sum(0, 0, 0);
    double u = 0, v = 0;
    for (const std::uint32_t node : t) {
      sum += at(face, node).XYZ() / 3;
      u += face.nodes[node].u / 3, v += face.nodes[node].v / 3;
    }
    return face.surface.height(gp_Pnt(sum), u, v);
  }

  void mark(std::size_t f) {
    const FaceMesh& face = mesh_.faces[f];
    for (std::size_t t = 0; t < face.triangles.size(); ++t) {
      if (!unsure_[f][t]) continue;
      const Triangle& triangle = face.triangles[t];
      bool is_asked = false;
      std::size_t longest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
        const double height = height_of_edge(face, a, b);
        note(height);
        if (height > deflection_) ask(face, a, b), is_asked = true;
        if (length(face, triangle, k) > length(face, triangle, longest)) longest = k;
      }
      if (face.surface.is_plane()) continue;
      const double height = height_of_middle(face, triangle);
      note(height);
      if (height > deflection_ && !is_asked) ask(face, triangle[longest], triangle[(longest + 1) % 3]);
    }
  }

  double length(const FaceMesh& face, const Triangle& t, std::size_t k) const {
    return at(face, t[k]).SquareDistance(at(face, t[(k + 1) % 3]));
  }

  /// The vertex in the middle of an edge of triangles, made when the first face asks.
  std::uint32_t middle(const FaceMesh& face, std::uint32_t a, std::uint32_t b, double u, double v) {
    const std::uint32_t from = face.nodes[a].vertex, to = face.nodes[b].vertex;
    std::uint32_t& vertex = midpoints_.at(BodyMesh::key(from, to));
    if (vertex != kNone) return vertex;
    vertex = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto found = mesh_.segments.find(BodyMesh::key(from, to));
    if (found == mesh_.segments.end()) {
      mesh_.positions.push_back(face.surface.point(u, v));
      mesh_.is_on_edge.push_back(0);
      return vertex;
    }
    const Segment part = found->second;
    const double half = (part.lower + part.upper) / 2;
    mesh_.positions.push_back(mesh_.curves[part.edge].Value(half));
    mesh_.is_on_edge.push_back(1);
    mesh_.segments.erase(found);
    // The new vertex has the highest number.
    mesh_.segments.try_emplace(BodyMesh::key(std::min(from, to), vertex), Segment{part.edge, part.lower, half});
    mesh_.segments.try_emplace(BodyMesh::key(std::max(from, to), vertex), Segment{part.edge, part.upper, half});
    return vertex;
  }

  /// The face's node in the middle of two of its nodes, if that edge is divided.
  std::uint32_t middle_node(FaceMesh& face, Midpoints& own, std::uint32_t a, std::uint32_t b) {
    if (!midpoints_.contains(BodyMesh::key(face.nodes[a].vertex, face.nodes[b].vertex))) return kNone;
    const auto [entry, is_new] = own.try_emplace(BodyMesh::key(a, b), static_cast<std::uint32_t>(face.nodes.size()));
    if (!is_new) return entry->second;
    const double u = (face.nodes[a].u + face.nodes[b].u) / 2, v = (face.nodes[a].v + face.nodes[b].v) / 2;
    const auto before = mesh_.positions.size();
    Node node{middle(face, a, b, u, v), u, v};
    // Made of other parameters: on the edge's curve, or for the other side of an edge that goes to a pole.
    if (mesh_.is_on_edge[node.vertex] || node.vertex < before) {
      const Foot foot = face.surface.foot(mesh_.positions[node.vertex], u, v);
      node.u = foot.u, node.v = foot.v;
    }
    face.nodes.push_back(node);
    return entry->second;
  }

  void divide_face(std::size_t f) {
    FaceMesh& face = mesh_.faces[f];
    Midpoints own;
    std::vector<Triangle> triangles;
    std::vector<std::uint8_t> unsure;
    for (const Triangle& t : face.triangles) {
      const std::uint32_t m[3] = {middle_node(face, own, t[0], t[1]), middle_node(face, own, t[1], t[2]),
                                  middle_node(face, own, t[2], t[0])};
      const std::size_t before = triangles.size();
      put_parts(face, t, m, triangles);
      const bool is_divided = triangles.size() - before > 1;
      unsure.resize(triangles.size(), is_divided);
    }
    face.triangles = std::move(triangles);
    unsure_[f] = std::move(unsure);
  }

  /// The parts of a triangle, of which m are the middles of its edges, in its own order.
  void put_parts(const FaceMesh& face, const Triangle& t, const std::uint32_t* m, std::vector<Triangle>& parts) const {
    const auto count = std::count_if(m, m + 3, [](std::uint32_t middle) { return middle != kNone; });
    if (count == 0) {
      parts.push_back(t);
    } else if (count == 3) {
      for (std::size_t k = 0; k < 3; ++k) parts.push_back({t[k], m[k], m[(k + 2) % 3]});
      parts.push_back({m[0], m[1], m[2]});
    } else {
      // Turned so that the first edge is divided, and of two the third is not.
      std::size_t k = 0;
      while (m[k] == kNone || (count == 2 && m[(k + 1) % 3] == kNone)) ++k;
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], ab = m[k], bc = m[(k + 1) % 3];
      if (count == 1) {
        parts.insert(parts.end(), {{a, ab, c}, {ab, b, c}});
        return;
      }
      parts.push_back({ab, b, bc});
      if (at(face, a).SquareDistance(at(face, bc)) < at(face, ab).SquareDistance(at(face, c)))
        parts.insert(parts.end(), {{a, ab, bc}, {a, bc, c}});
      else parts.insert(parts.end(), {{a, ab, c}, {ab, bc, c}});
    }
  }

  BodyMesh& mesh_;
  double deflection_;
  double most_ = 0;  // of what has been looked at since the last division
  Midpoints midpoints_;
  std::vector<std::vector<std::uint8_t>> unsure_;  // of each face's triangles: not looked at yet
};

}  // namespace

double divide_to_deflection(BodyMesh& mesh, double deflection) { return Divider(mesh, deflection).divide(); }

}  // namespace vdb_offset::cad
