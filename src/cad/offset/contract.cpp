// SPDX-License-Identifier: Apache-2.0
#include "offset/contract.h"

#include <GCPnts_AbscissaPoint.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <algorithm>
#include <array>
#include <cmath>

#include "offset/contact.h"

namespace vdb_offset::cad {
namespace {

// A face is long, and not to become a vertex, if its longest side is so many times its shortest.
constexpr double kLong = 2.5;

void drop_loop_start(Model& model, int half) {
  const HalfEdge& h = model.halves[half];
  std::vector<int>& loops = model.faces[h.face].loops;
  for (auto l = loops.begin(); l != loops.end(); ++l)
    if (*l == half) {
      if (h.next == half) loops.erase(l);
      else *l = h.next;
      break;
    }
  if (loops.empty()) model.faces[h.face].is_gone = true;
}

void unlink(Model& model, int half) {
  drop_loop_start(model, half);
  HalfEdge& h = model.halves[half];
  model.halves[h.previous].next = h.next;
  model.halves[h.next].previous = h.previous;
  h.face = -1;
}

void unlink_edge(Model& model, int edge) {
  for (int half : model.edges[edge].half)
    if (half >= 0 && model.halves[half].face >= 0) unlink(model, half);
  model.edges[edge].is_gone = true;
}

bool is_drawn(const Model& model, int half) {
  return model.halves[half].face >= 0 && model.edges[model.halves[half].edge].kind != EdgeKind::Pole;
}

// Finds a vertex's ring anew. False if its half-edges are more than one ring, or an open one.
bool rebuild_ring(Model& model, int vertex) {
  std::vector<int> all;
  for (int h = 0; h < static_cast<int>(model.halves.size()); h++)
    if (model.halves[h].vertex == vertex && is_drawn(model, h)) all.push_back(h);
  ModelVertex& v = model.vertices[vertex];
  v.ring.clear();
  if (all.empty()) {
    v.is_gone = true;
    return true;
  }
  for (int h = all.front();;) {
    v.ring.push_back(h);
    h = model.halves[previous_drawn(model, h)].twin;
    if (h == all.front()) break;
    if (h < 0 || v.ring.size() > all.size()) return false;
  }
  return v.ring.size() == all.size();
}

// Joins vertices: the first one stays.
bool join(Model& model, std::vector<int> vertices) {
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  gp_XYZ sum(0, 0, 0);
  for (int v : vertices) sum += model.vertices[v].source.XYZ();
  model.vertices[vertices.front()].source = gp_Pnt(sum / static_cast<double>(vertices.size()));
  for (HalfEdge& h : model.halves)
    if (std::binary_search(vertices.begin(), vertices.end(), h.vertex)) h.vertex = vertices.front();
  for (std::size_t i = 1; i < vertices.size(); i++) {
    model.vertices[vertices[i]].is_gone = true;
    model.vertices[vertices[i]].ring.clear();
  }
  model.vertices[vertices.front()].has_near = false;
  return rebuild_ring(model, vertices.front());
}

double length_of(const Model& model, int edge) {
  const ModelEdge& e = model.edges[edge];
  if (!e.curve.IsNull()) return GCPnts_AbscissaPoint::Length(GeomAdaptor_Curve(e.curve), e.first, e.last);
  const int h = e.half[0];
  return model.vertices[model.halves[h].vertex].source.Distance(model.vertices[end_vertex(model, h)].source);
}

std::vector<int> loop_of(const Model& model, int half) {
  std::vector<int> loop = {half};
  for (int h = model.halves[half].next; h != half; h = model.halves[h].next) loop.push_back(h);
  return loop;
}

double length_of_loop(const Model& model, int half) {
  double length = 0;
  for (int h : loop_of(model, half)) length += length_of(model, model.halves[h].edge);
  return length;
}

// A loop of a face that borders a group of faces with all of its edges.
struct Rim {
  int half = -1;     // One of the loop.
  int other = -1;    // Of the face's other loop, if it has one other.
  double width = 0;  // Of the face between the two, as a difference of their lengths; without bounds if it has more.
};

// Finds what the face behind a rim has beside it. `known` are half-edges of rims.
void measure(const Model& model, const std::vector<int>& known, Rim& rim) {
  const std::vector<int>& loops = model.faces[model.halves[rim.half].face].loops;
  for (int l : loops)
    if (std::find(known.begin(), known.end(), l) == known.end()) rim.other = l;
  rim.width = loops.size() == 2 && rim.other >= 0
                  ? std::abs(length_of_loop(model, rim.other) - length_of_loop(model, rim.half))
                  : INFINITY;
}

// The rims around a group; none if it has borders of other kinds.
std::vector<Rim> rims_of(const Model& model, const std::vector<int>& faces) {
  const auto is_inside = [&](int f) { return std::find(faces.begin(), faces.end(), f) != faces.end(); };
  std::vector<Rim> rims;
  std::vector<int> known;
  for (int face : faces)
    for (int first : model.faces[face].loops)
      for (int h : loop_of(model, first)) {
        const int twin = model.halves[h].twin;
        if (twin < 0) return {};
        if (is_inside(model.halves[twin].face) || std::find(known.begin(), known.end(), twin) != known.end()) continue;
        const std::vector<int> loop = loop_of(model, twin);
        for (int o : loop)
          if (model.halves[o].twin < 0 || !is_inside(model.halves[model.halves[o].twin].face)) return {};
        known.insert(known.end(), loop.begin(), loop.end());
        rims.push_back({twin});
      }
  for (Rim& rim : rims) measure(model, known, rim);
  return rims;
}

// Takes a loop from its face, whose half-edges stay.
void drop_loop(Model& model, int half) {
  const std::vector<int> loop = loop_of(model, half);
  std::erase_if(model.faces[model.halves[half].face].loops,
                [&](int l) { return std::find(loop.begin(), loop.end(), l) != loop.end(); });
}

// Gives a loop to another face, whose edges it has in common with those behind it from now on.
void move_loop(Model& model, int half, int face, const gp_Pnt2d& near) {
  const std::vector<int> loop = loop_of(model, half);
  drop_loop(model, half);
  model.faces[face].loops.push_back(half);
  for (int i : loop) {
    HalfEdge& h = model.halves[i];
    ModelEdge& e = model.edges[h.edge];
    h.face = face;
    h.pcurve.Nullify();
    h.origin = h.start = project(*model.faces[face].surface, model.vertices[h.vertex].source, near);
    e.kind = EdgeKind::Sharp;
    e.is_within = false;
    e.strays = {false, false};
  }
  for (int i : loop) model.halves[i].end = model.halves[model.halves[i].next].origin;
}

// How two loops that face each other lie: `one` from i to i + 1 goes along `other` from k + 1 to k, with k for each i.
// Nothing if they do not lie along each other.
std::vector<std::size_t> facing_halves(const Model& model, const std::vector<int>& one, const std::vector<int>& other) {
  const std::size_t n = one.size();
  const auto start = [&](int h) { return model.vertices[model.halves[h].vertex].source; };
  double best = INFINITY, length = 0;
  std::size_t best_shift = 0;
  for (std::size_t shift = 0; shift < n && other.size() == n; shift++) {
    double worst = 0;
    for (std::size_t i = 0; i < n; i++)
      worst = std::max(worst, start(one[i]).Distance(start(other[(shift + n - i + 1) % n])));
    if (worst < best) best = worst, best_shift = shift;
  }
  for (int h : one) length += length_of(model, model.halves[h].edge);
  if (!(best < 0.5 * length / static_cast<double>(n))) return {};
  std::vector<std::size_t> facing;
  for (std::size_t i = 0; i < n; i++) facing.push_back((best_shift + n - i) % n);
  return facing;
}

// Has the faces behind two loops meet each other along one; the loops' own faces lose them. `vertices` are those that
// become one. False if the loops do not lie along each other.
bool join_loops(Model& model, int a, int b, std::vector<std::array<int, 2>>& vertices) {
  const std::vector<int> one = loop_of(model, a), other = loop_of(model, b);
  for (const std::vector<int>* const loop : {&one, &other})
    for (int h : *loop)
      if (model.halves[h].twin < 0) return false;
  const std::vector<std::size_t> facing = facing_halves(model, one, other);
  if (facing.empty()) return false;
  for (int h : {a, b}) drop_loop(model, h);
  for (std::size_t i = 0; i < one.size(); i++) {
    HalfEdge &h = model.halves[one[i]], &o = model.halves[other[facing[i]]];
    vertices.push_back({h.vertex, model.halves[o.next].vertex});
    const int mine = h.twin, theirs = o.twin;
    HalfEdge &kept = model.halves[mine], &taken = model.halves[theirs];
    model.edges[o.edge].is_gone = true;
    ModelEdge& e = model.edges[h.edge];
    taken.edge = h.edge;
    taken.forward = !kept.forward;
    taken.pcurve.Nullify();
    kept.pcurve.Nullify();
    kept.twin = theirs;
    taken.twin = mine;
    e.half = {kept.forward ? mine : theirs, kept.forward ? theirs : mine};
    e.kind = EdgeKind::Sharp;
    e.is_within = false;
    e.strays = {false, false};
  }
  for (const std::vector<int>* const loop : {&one, &other})
    for (int h : *loop) model.halves[h].face = -1;
  return true;
}

// Merges the two edges of a face that has no others: that of the first side stays, between the two neighbours.
bool merge_sides(Model& model, int face, int first, int second) {
  const int inner = model.edges[first].half[0], inner_twin = model.edges[first].half[1];
  const int mine = model.halves[inner].face == face ? inner : inner_twin;
  const int a = model.edges[second].half[0], b = model.edges[second].half[1];
  const int other = model.halves[a].face == face ? b : a;
  if (model.halves[model.halves[mine].twin].face == model.halves[other].face) return false;
  // The face's own half-edge of the first side takes the place of the neighbour's behind the second side.
  drop_loop_start(model, mine);
  model.faces[face].is_gone = true;
  HalfEdge &h = model.halves[mine], &o = model.halves[other];
  const int neighbour = o.face;
  h.face = neighbour;
  h.pcurve.Nullify();
  h.origin = o.origin;
  h.start = o.start;
  h.end = o.end;
  h.next = o.next == other ? mine : o.next;
  h.previous = o.previous == other ? mine : o.previous;
  h.vertex = o.vertex;
  model.halves[h.next].previous = mine;
  model.halves[h.previous].next = mine;
  for (int& l : model.faces[neighbour].loops)
    if (l == other) l = mine;
  o.face = -1;
  model.halves[o.twin].face = -1;
  model.edges[second].is_gone = true;
  model.edges[first].kind = EdgeKind::Sharp;
  // Both ends of what was the face's border are ends of the edge now.
  return true;
}

// The face behind a side.
int behind(const Model& model, int face, int edge) {
  const int h = model.edges[edge].half[0], o = model.edges[edge].half[1];
  return model.halves[h].face == face ? o : h;
}

// Two sides whose neighbours meet once the face is gone: of those that do, the pair that is longest together.
std::array<int, 2> sides_that_meet(const Model& model, int face, const std::vector<int>& round,
                                   const std::vector<double>& lengths) {
  const int n = static_cast<int>(round.size());
  std::array<int, 2> best = {0, -1};
  double best_length = -1;
  for (int i = 0; i < n; i++)
    for (int k = i + 1; k < n; k++) {
      const bool touches = n > 3 && (k == i + 1 || (i == 0 && k == n - 1));
      const int a = behind(model, face, round[i]), b = behind(model, face, round[k]);
      if (touches || lengths[i] + lengths[k] <= best_length || model.halves[a].face == model.halves[b].face) continue;
      std::vector<Support> supports;
      for (int h : {a, b})
        supports.push_back({model.faces[model.halves[h].face].offset.surface, {}, model.halves[h].origin, 0});
      if (supports[0].surface.IsNull() || supports[1].surface.IsNull()) continue;
      gp_Pnt point = model.vertices[model.halves[a].vertex].source;
      if (meet(supports, point) > 1e-6 * (lengths[i] + lengths[k])) continue;
      best = {i, k};
      best_length = lengths[i] + lengths[k];
    }
  return best;
}

}  // namespace

std::vector<int> sides_of_face(const Model& model, int face) {
  std::vector<int> sides;
  for (int first : model.faces[face].loops)
    for (int h = first;;) {
      const int twin = model.halves[h].twin;
      if (twin >= 0 && model.halves[twin].face != face) sides.push_back(model.halves[h].edge);
      h = model.halves[h].next;
      if (h == first) break;
    }
  return sides;
}

bool contract_edges(Model& model, const std::vector<int>& edges) {
  std::vector<int> vertices;
  for (int e : edges) {
    const int h = model.edges[e].half[0] >= 0 ? model.edges[e].half[0] : model.edges[e].half[1];
    if (model.halves[h].face < 0) continue;
    vertices.push_back(model.halves[h].vertex);
    vertices.push_back(end_vertex(model, h));
  }
  for (int e : edges)
    if (!model.edges[e].is_gone) unlink_edge(model, e);
  return vertices.empty() || join(model, vertices);
}

bool close_hole(Model& model, std::vector<int> faces) {
  const auto is_inside = [&](int f) { return std::find(faces.begin(), faces.end(), f) != faces.end(); };
  // A whole loop behind the border: all of its edges border faces of the group.
  const auto is_whole = [&](int half) {
    for (int o = half;;) {
      const int inner = model.halves[o].twin;
      if (inner < 0 || !is_inside(model.halves[inner].face)) return false;
      o = model.halves[o].next;
      if (o == half) return true;
    }
  };
  std::vector<int> edges, vertices;
  for (std::size_t i = 0; i < faces.size(); i++)
    for (int first : model.faces[faces[i]].loops)
      for (int h = first;;) {
        edges.push_back(model.halves[h].edge);
        vertices.push_back(model.halves[h].vertex);
        const int twin = model.halves[h].twin;
        if (twin < 0 && model.edges[model.halves[h].edge].kind != EdgeKind::Pole) return false;
        if (twin >= 0 && !is_inside(model.halves[twin].face)) {
          const int behind = model.halves[twin].face;
          if (!is_whole(twin)) return false;
          // A face that is bordered by the group alone goes with it: the bottom of a hole, the top of a boss.
          const std::vector<int>& loops = model.faces[behind].loops;
          if (std::all_of(loops.begin(), loops.end(), is_whole)) faces.push_back(behind);
        }
        h = model.halves[h].next;
        if (h == first) break;
      }
  for (int e : edges)
    if (!model.edges[e].is_gone) unlink_edge(model, e);
  for (int v : vertices) {
    model.vertices[v].ring.clear();
    model.vertices[v].is_gone = true;
  }
  return true;
}

std::optional<bool> close_neck(Model& model, const std::vector<int>& faces) {
  // A face whose radius is used up is a hole or boss that closes.
  if (std::any_of(faces.begin(), faces.end(), [&](int f) { return model.faces[f].offset.surface.IsNull(); }))
    return std::nullopt;
  std::vector<Rim> rims = rims_of(model, faces);
  if (rims.size() != 2 || model.halves[rims[0].half].face == model.halves[rims[1].half].face) return std::nullopt;
  if (rims[0].width > rims[1].width) std::swap(rims[0], rims[1]);
  const Rim &narrow = rims[0], &wide = rims[1];
  if (narrow.other < 0 || wide.other < 0) return std::nullopt;
  constexpr double kNarrower = 1 - 1e-6;
  std::vector<std::array<int, 2>> joined;
  if (narrow.width < kNarrower * wide.width)
    move_loop(model, narrow.other, model.halves[wide.half].face, model.halves[wide.half].origin);
  else if (!std::isfinite(wide.width) || !join_loops(model, narrow.other, wide.other, joined)) return std::nullopt;
  std::vector<int> edges, vertices;
  for (int face : faces)
    for (int first : model.faces[face].loops)
      for (int h : loop_of(model, first)) {
        edges.push_back(model.halves[h].edge);
        vertices.push_back(model.halves[h].vertex);
      }
  for (int e : edges)
    if (!model.edges[e].is_gone) unlink_edge(model, e);
  for (int v : vertices) {
    model.vertices[v].ring.clear();
    model.vertices[v].is_gone = true;
  }
  return std::all_of(joined.begin(), joined.end(), [&](const auto& two) { return join(model, {two[0], two[1]}); });
}

bool remove_face(Model& model, int face) {
  // Seams and poles go with the face.
  std::vector<int> inner, round;
  for (int first : model.faces[face].loops)
    for (int h = first;;) {
      const int twin = model.halves[h].twin;
      if (twin < 0 && model.edges[model.halves[h].edge].kind != EdgeKind::Pole) return false;
      if (twin < 0 || model.halves[twin].face == face) inner.push_back(model.halves[h].edge);
      else round.push_back(model.halves[h].edge);
      h = model.halves[h].next;
      if (h == first) break;
    }
  std::sort(inner.begin(), inner.end());
  inner.erase(std::unique(inner.begin(), inner.end()), inner.end());
  if (round.empty() || model.faces[face].loops.size() > 1) return false;
  std::vector<double> lengths;
  for (int e : round) lengths.push_back(length_of(model, e));
  const int n = static_cast<int>(round.size());
  const double longest = *std::max_element(lengths.begin(), lengths.end());
  const double shortest = *std::min_element(lengths.begin(), lengths.end());
  const bool is_ring = n == 2 && !inner.empty();
  if (n == 1) return false;
  const std::array<int, 2> pair = n == 2 ? std::array<int, 2>{0, 1} : sides_that_meet(model, face, round, lengths);
  const int a = pair[0], b = pair[1];
  // Of four sides those that meet become one however short they are: a fillet in a shallow pocket.
  const bool is_short = n == 3 ? longest < 3 * kLong * shortest : n > 4 && longest < kLong * shortest;
  if (n > 2 && (is_short || b < 0)) {
    std::vector<int> all = round;
    all.insert(all.end(), inner.begin(), inner.end());
    return contract_edges(model, all);
  }
  // The sides between them become vertices.
  if (!is_ring) {
    for (int from : {a, b}) {
      const int to = from == a ? b : a;
      std::vector<int> ends;
      for (int i = (from + 1) % n; i != to; i = (i + 1) % n) ends.push_back(round[i]);
      if (!ends.empty() && !contract_edges(model, ends)) return false;
    }
  } else if (!contract_edges(model, inner)) {
    // A ring has its seam contracted: two closed edges at one vertex.
    return false;
  }
  if (model.faces[face].is_gone) return true;
  std::vector<int> touched;
  for (int h : {model.edges[round[a]].half[0], model.edges[round[a]].half[1]})
    touched.push_back(model.halves[h].vertex);
  if (!merge_sides(model, face, round[a], round[b])) return false;
  for (int v : touched)
    if (!rebuild_ring(model, v)) return false;
  return true;
}

}  // namespace vdb_offset::cad
