// SPDX-License-Identifier: Apache-2.0
#include "hybrid/hybrid_model.h"

#include <ElSLib.hxx>
#include <Geom_Plane.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pln.hxx>

#include "ground/numbers/disjoint_sets.h"

namespace vdb_offset::cad {
namespace {

// In distances: vertices of the mesh that are nearer than that to their exact faces stay where they are, others may
// move so far onto these.
constexpr double kExact = 1e-4, kMostMoved = 0.2;

int after(int side) { return side - side % 3 + (side % 3 + 1) % 3; }

/// Sides of triangles are numbered: side k of triangle t, from corner k to the next, is 3 t + k.
class Joiner {
 public:
  Joiner(const Model& source, const ShellMesh& mesh, const OnSurfaces& on, const Tolerances& tolerances)
      : source_(source),
        mesh_(mesh),
        on_(on),
        tolerances_(tolerances),
        sides_(3 * static_cast<int>(mesh.triangles.size())) {}

  HybridModel join() {
    find_twins();
    find_regions();
    find_borders();
    add_faces();
    for (int side = 0; side < sides_; ++side)
      if (is_border_[side] && is_end_[vertex(side)]) add_half(side);
    link_halves();
    add_vertices(made_.model);
    place();
    return std::move(made_);
  }

 private:
  const ShellTriangle& triangle(int side) const { return mesh_.triangles[side / 3]; }
  std::uint32_t vertex(int side) const { return triangle(side).vertices[side % 3]; }
  std::uint32_t node(int side) const { return triangle(side).nodes[side % 3]; }
  const gp_Pnt2d& uv(int side) const { return on_.uv(side / 3, side % 3); }
  const gp_Pnt& point(int side) const { return mesh_.points[vertex(side)]; }
  bool is_on(int side) const { return on_.is_on(side / 3); }

  void find_twins() {
    std::unordered_map<std::uint64_t, int> from;
    const auto key = [](std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32 | b; };
    for (int side = 0; side < sides_; ++side) from[key(vertex(side), vertex(after(side)))] = side;
    twin_.assign(sides_, -1);
    for (int side = 0; side < sides_; ++side)
      if (const auto other = from.find(key(vertex(after(side)), vertex(side))); other != from.end())
        twin_[side] = other->second;
  }

  /// Whether triangles of one face go on across a side; a seam is no such side, and a corner at a pole may differ.
  bool goes_on(int side) const {
    const int other = twin_[side];
    return other >= 0 && is_on(side) && is_on(other) && triangle(side).face == triangle(other).face &&
           (node(side) == node(after(other)) || node(after(side)) == node(other));
  }

  void find_regions() {
    DisjointSets sets(mesh_.triangles.size());
    for (int side = 0; side < sides_; ++side)
      if (goes_on(side)) sets.join(static_cast<std::uint32_t>(side / 3), static_cast<std::uint32_t>(twin_[side] / 3));
    region_ = std::move(sets).firsts();
  }

  /// What of the source's edges a side is, if both faces beside it keep the curve of that; the parameters at its start
  /// and at its end.
  struct OnEdge {
    int edge = -1;
    double start = 0, end = 0;
    std::array<const HalfEdge*, 2> halves = {nullptr, nullptr};  // of the side's face, and of its twin's
    bool is_forward() const { return end > start; }
  };

  OnEdge on_edge(int side) const {
    OnEdge at;
    if (!is_on(side) || (twin_[side] >= 0 && !is_on(twin_[side]))) return at;
    const std::uint32_t a = vertex(side), b = vertex(after(side));
    const SourceEdge known = mesh_.edge(a, b);
    if (known.edge < 0 || known.lower == known.upper) return at;
    const ModelEdge& edge = source_.edges[known.edge];
    if (edge.kind == EdgeKind::Pole || edge.curve.IsNull() || edge.is_step) return at;
    at.start = a < b ? known.lower : known.upper;
    at.end = a < b ? known.upper : known.lower;
    for (int i = 0; i < 2; ++i) {
      const int half = edge.half[at.is_forward() == (i == 0) ? 0 : 1], of = i == 0 ? side : twin_[side];
      const bool is_there = half >= 0 && of >= 0 && source_.halves[half].face == triangle(of).face;
      if (!is_there && (half >= 0 || of >= 0)) return at;
      if (is_there) at.halves[i] = &source_.halves[half];
    }
    if (at.halves[0]) at.edge = known.edge;
    return at;
  }

  void find_borders() {
    is_border_.assign(sides_, 0);
    is_end_.assign(mesh_.points.size(), 0);
    struct Beside {
      int edge = -1;
      double t = 0;
      std::uint32_t least = 0, most = 0;  // of the regions to its sides
      int count = 0;
    };
    std::vector<Beside> beside(mesh_.points.size());
    for (int side = 0; side < sides_; ++side) {
      const int other = twin_[side];
      is_border_[side] = !goes_on(side);
      if (!is_border_[side] || (other >= 0 && other < side)) continue;
      const OnEdge edge = on_edge(side);
      const std::uint32_t one = region_[side / 3], two = other < 0 ? kNone : region_[other / 3];
      for (const bool is_start : {true, false}) {
        const std::uint32_t v = vertex(is_start ? side : after(side));
        const Beside here{edge.edge, is_start ? edge.start : edge.end, std::min(one, two), std::max(one, two), 0};
        Beside& known = beside[v];
        const bool goes_through = edge.edge >= 0 && known.edge == here.edge && known.t == here.t &&
                                  known.least == here.least && known.most == here.most;
        if (known.count++ == 0) known = here, known.count = 1;
        else if (known.count > 2 || !goes_through) is_end_[v] = 1;
        else is_end_[v] = 0;
        if (known.count == 1) is_end_[v] = 1;  // until another goes through
      }
    }
  }

  void add_faces() {
    face_of_.assign(mesh_.triangles.size(), -1);
    for (int t = 0; t < sides_ / 3; ++t) {
      if (!on_.is_on(t)) continue;
      int& face = face_of_[region_[t]];
      if (face < 0) face = add_face(source_.faces[mesh_.triangles[t].face], mesh_.triangles[t].face);
      face_of_[t] = face;
      made_.triangles_of_face[face].push_back(t);
    }
    for (int t = 0; t < sides_ / 3; ++t) {
      if (on_.is_on(t)) continue;
      face_of_[t] = add_face({}, -1);
      made_.triangles_of_face[face_of_[t]].push_back(t);
    }
  }

  int add_face(const ModelFace& like, int source) {
    ModelFace face = like;
    face.loops.clear();
    // An edge has one trimming curve a surface: two faces that meet at a seam need two.
    const auto is_same = [&](int other) { return other == source; };
    if (source >= 0 && std::any_of(made_.source_faces.begin(), made_.source_faces.end(), is_same))
      face.offset.surface = Handle(Geom_Surface)::DownCast(face.offset.surface->Copy());
    made_.model.faces.push_back(face);
    made_.source_faces.push_back(source);
    made_.triangles_of_face.emplace_back();
    return static_cast<int>(made_.model.faces.size()) - 1;
  }

  /// The next side on the border of the same face.
  int next_border(int side) const {
    int next = after(side);
    while (!is_border_[next]) next = after(twin_[next]);
    return next;
  }

  void add_half(int side) {
    std::vector<int> sides = {side};
    while (!is_end_[vertex(after(sides.back()))]) sides.push_back(next_border(sides.back()));
    const OnEdge first = on_edge(side), last = on_edge(sides.back());
    const bool is_known = twin_[side] >= 0 && edge_of_.count(twin_[side]) > 0;
    const bool forward = first.edge >= 0 ? first.is_forward() : !is_known;
    const int number = is_known ? edge_of_[twin_[side]] : add_edge(first, last, forward);
    for (const int each : sides) {
      edge_of_[each] = number;
      made_.triangles_of_edge[number].push_back(each / 3);
    }
    HalfEdge half;
    half.edge = number;
    half.face = face_of_[side / 3];
    half.forward = forward;
    if (first.edge >= 0) half.pcurve = first.halves[0]->pcurve;
    half.origin = triangle(side).origin[side % 3];
    half.start = corner(side, side);
    half.end = corner(after(sides.back()), sides.back());
    made_.model.edges[number].half[forward ? 0 : 1] = static_cast<int>(made_.model.halves.size());
    half_of_[side] = static_cast<int>(made_.model.halves.size());
    last_of_.push_back(sides.back());
    first_of_.push_back(side);
    made_.model.halves.push_back(half);
  }

  int add_edge(const OnEdge& first, const OnEdge& last, bool forward) {
    ModelEdge edge;
    edge.kind = EdgeKind::Chord;
    if (first.edge >= 0) {
      edge = source_.edges[first.edge];
      edge.half = {-1, -1};
      edge.first = forward ? first.start : last.end;
      edge.last = forward ? last.end : first.start;
      edge.range = {edge.first, edge.last};
    }
    made_.model.edges.push_back(edge);
    made_.triangles_of_edge.emplace_back();
    return static_cast<int>(made_.model.edges.size()) - 1;
  }

  /// (u, v) of a corner of a triangle, as an end of a side of it: at a pole, u (or v) is that of the other end.
  gp_Pnt2d corner(int at, int side) const {
    if (!is_on(side)) return {};
    const gp_Pnt2d own = uv(at), other = uv(at == side ? after(side) : side);
    const gp_Pnt2d& origin = triangle(at).origin[at % 3];
    gp_Pnt p;
    gp_Vec du, dv;
    source_.faces[triangle(side).face].surface->D1(origin.X(), origin.Y(), p, du, dv);
    constexpr double kNothing = 1e-7;
    if (du.Magnitude() < kNothing * dv.Magnitude()) return {other.X(), own.Y()};
    if (dv.Magnitude() < kNothing * du.Magnitude()) return {own.X(), other.Y()};
    return own;
  }

  /// Loops, with edges without length at poles.
  void link_halves() {
    Model& model = made_.model;
    const int count = static_cast<int>(first_of_.size());
    std::vector<char> is_linked(count, 0);
    for (int start = 0; start < count; ++start) {
      if (is_linked[start]) continue;
      model.faces[model.halves[start].face].loops.push_back(start);
      for (int half = start; !is_linked[half];) {
        is_linked[half] = 1;
        const int next = half_of_.at(next_border(last_of_[half]));
        const bool is_flat = made_.source_faces[model.halves[half].face] < 0;
        const gp_Pnt2d a = model.halves[half].end, b = model.halves[next].start;
        if (!is_flat && a.Distance(b) > 0 && is_apart(model.faces[model.halves[half].face], a, b))
          link_pole(half, next);
        else link(half, next);
        half = next;
      }
    }
    for (const ModelEdge& edge : model.edges)
      if (edge.half[0] >= 0 && edge.half[1] >= 0) {
        model.halves[edge.half[0]].twin = edge.half[1];
        model.halves[edge.half[1]].twin = edge.half[0];
      }
  }
  static bool is_apart(const ModelFace& face, const gp_Pnt2d& a, const gp_Pnt2d& b) {
    const double u = face.box.u1 - face.box.u0, v = face.box.v1 - face.box.v0;
    return std::abs(a.X() - b.X()) > 1e-6 * u || std::abs(a.Y() - b.Y()) > 1e-6 * v;
  }
  void link(int half, int next) {
    made_.model.halves[half].next = next;
    made_.model.halves[next].previous = half;
  }
  void link_pole(int half, int next) {
    Model& model = made_.model;
    const int pole = static_cast<int>(model.halves.size());
    ModelEdge edge;
    edge.kind = EdgeKind::Pole;
    edge.half = {pole, -1};
    HalfEdge at;
    at.edge = static_cast<int>(model.edges.size());
    at.face = model.halves[half].face;
    at.start = model.halves[half].end;
    at.end = model.halves[next].start;
    model.edges.push_back(edge);
    made_.triangles_of_edge.push_back({last_of_[half] / 3, first_of_[next] / 3});
    model.halves.push_back(at);
    link(half, pole);
    link(pole, next);
  }

  /// Places the vertices, then the ends of edges there.
  void place() {
    Model& model = made_.model;
    for (ModelVertex& at : model.vertices) place_vertex_of(at);
    for (ModelEdge& edge : model.edges) {
      if (edge.kind != EdgeKind::Smooth) continue;
      const int one = edge.half[0] >= 0 ? edge.half[0] : edge.half[1];
      for (const int end : {0, 1}) {
        const bool is_start = (end == 0) == model.halves[one].forward;
        const int vertex = is_start ? model.halves[one].vertex : end_vertex(model, one);
        edge.range[end] = nearest(model.halves[one], model.vertices[vertex].point, edge.range[end]);
      }
    }
    for (std::size_t v = 0; v < model.vertices.size(); ++v) {
      ModelVertex& at = model.vertices[v];
      spread_vertex(model, static_cast<int>(v));
      for (const int half : at.ring) {
        const HalfEdge& h = model.halves[half];
        if (made_.source_faces[h.face] < 0) continue;
        const double miss = model.faces[h.face].offset.surface->Value(h.start.X(), h.start.Y()).Distance(at.point);
        at.residual = std::max(at.residual, miss);
        if (miss > 2 * tolerances_.gap) take_off_around(first_of_[half]);
      }
    }
    flatten();
  }

  /// All triangles of a face at the start of a side of its border.
  void take_off_around(int side) {
    for (int before = side;; side = twin_[before]) {
      made_.off.push_back(side / 3);
      before = after(after(side));
      if (is_border_[before]) return;
    }
  }

  /// Where the exact faces at a vertex meet that is nearest to where the mesh has it; (u, v) of straight edges there.
  void place_vertex_of(ModelVertex& at) {
    Model& model = made_.model;
    const gp_Pnt& mesh = point(first_of_[at.ring.front()]);
    std::vector<Support> supports;
    std::vector<int> faces;
    for (const int half : at.ring) {
      const HalfEdge& h = model.halves[half];
      if (made_.source_faces[h.face] < 0 || std::find(faces.begin(), faces.end(), h.face) != faces.end()) continue;
      faces.push_back(h.face);
      supports.push_back({model.faces[h.face].offset.surface, {}, h.start, 0});
    }
    at.point = mesh;
    const bool is_there = std::all_of(supports.begin(), supports.end(), [&](const Support& s) {
      return s.surface->Value(s.uv.X(), s.uv.Y()).Distance(mesh) <= kExact * tolerances_.distance;
    });
    if (!is_there) {
      meet(supports, at.point);
      if (at.point.Distance(mesh) > kMostMoved * tolerances_.distance) at.point = mesh;
    }
    placed_[vertex(first_of_[at.ring.front()])] = at.point;
    for (const int half : at.ring) {
      const int before = previous_drawn(model, half);
      if (model.edges[model.halves[half].edge].kind == EdgeKind::Chord)
        set_uv(half, model.halves[half].start, at.point);
      if (model.edges[model.halves[before].edge].kind == EdgeKind::Chord)
        set_uv(before, model.halves[before].end, at.point);
    }
  }

  void set_uv(int half, gp_Pnt2d& uv, const gp_Pnt& at) const {
    const int face = made_.model.halves[half].face;
    if (made_.source_faces[face] >= 0 && !is_at_pole(uv, face, at))
      uv = project(*made_.model.faces[face].offset.surface, at, uv);
  }
  /// Where (u, v) is exact already, as at a pole, where the point leaves one of them open.
  bool is_at_pole(const gp_Pnt2d& uv, int face, const gp_Pnt& at) const {
    return made_.model.faces[face].offset.surface->Value(uv.X(), uv.Y()).Distance(at) <= kExact * tolerances_.distance;
  }

  /// Gives triangles their planes, through placed vertices.
  void flatten() {
    Model& model = made_.model;
    for (std::size_t f = 0; f < model.faces.size(); ++f) {
      if (made_.source_faces[f] >= 0) continue;
      const ShellTriangle& t = mesh_.triangles[made_.triangles_of_face[f].front()];
      const gp_Pnt &a = placed_[t.vertices[0]], &b = placed_[t.vertices[1]], &c = placed_[t.vertices[2]];
      const gp_Vec normal = gp_Vec(a, b).Crossed(gp_Vec(a, c));
      const Handle(Geom_Plane) plane = normal.Magnitude() <= 1e-14 * gp_Vec(a, b).Magnitude()
                                           ? new Geom_Plane(a, gp_Dir(0, 0, 1))
                                           : new Geom_Plane(gp_Pln(gp_Ax3(a, gp_Dir(normal), gp_Dir(gp_Vec(a, b)))));
      model.faces[f].surface = model.faces[f].offset.surface = plane;
      const int first = model.faces[f].loops.front();
      for (int h = first;;) {
        HalfEdge& half = model.halves[h];
        half.start = on(*plane, model.vertices[half.vertex].point);
        half.end = on(*plane, model.vertices[model.halves[half.next].vertex].point);
        h = half.next;
        if (h == first) break;
      }
    }
  }
  static gp_Pnt2d on(const Geom_Plane& plane, const gp_Pnt& at) {
    double u = 0, v = 0;
    ElSLib::Parameters(plane.Pln(), at, u, v);
    return {u, v};
  }

  /// Where along its trimming curve the half-edge is nearest to a point.
  double nearest(const HalfEdge& half, const gp_Pnt& to, double start) const {
    const Geom_Surface& surface = *made_.model.faces[half.face].offset.surface;
    double t = start;
    for (int step = 0; step < 20; ++step) {
      gp_Pnt2d uv;
      gp_Vec2d along;
      evaluate(*half.pcurve, t, uv, along);
      gp_Pnt at;
      gp_Vec du, dv;
      surface.D1(uv.X(), uv.Y(), at, du, dv);
      const gp_Vec way = du * along.X() + dv * along.Y();
      if (way.SquareMagnitude() < 1e-30) break;
      const double more = gp_Vec(at, to).Dot(way) / way.SquareMagnitude();
      t += more;
      if (std::abs(more) * way.Magnitude() < 1e-12) break;
    }
    return t;
  }

  const Model& source_;
  const ShellMesh& mesh_;
  const OnSurfaces& on_;
  const Tolerances& tolerances_;
  const int sides_;
  HybridModel made_;
  std::vector<int> twin_;
  std::vector<std::uint32_t> region_;
  std::vector<char> is_border_;                       // by side
  std::vector<char> is_end_;                          // by vertex: edges end there
  std::vector<int> face_of_;                          // by triangle
  std::unordered_map<std::uint32_t, gp_Pnt> placed_;  // vertices
  std::unordered_map<int, int> edge_of_, half_of_;    // by side
  std::vector<int> first_of_, last_of_;               // sides, by half-edge
};

}  // namespace

HybridModel hybrid_model(const Model& source, const ShellMesh& mesh, const OnSurfaces& on,
                         const Tolerances& tolerances) {
  return Joiner(source, mesh, on, tolerances).join();
}

}  // namespace vdb_offset::cad
