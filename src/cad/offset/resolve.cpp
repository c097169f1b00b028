// SPDX-License-Identifier: Apache-2.0
#include "offset/resolve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gp_Ax3.hxx>
#include <map>
#include <optional>

namespace vdb_offset::cad {
namespace {

using Triangle = std::array<int, 3>;
using Triangulation = std::vector<Triangle>;

// More corners have too many triangulations (429 of nine).
constexpr int kMostCorners = 9;

// What a border that seems to cross itself counts, in distances.
constexpr double kCrossing = 1e4;

// Faces that miss each other at a vertex by no more, in distances, are joined there where there is no better way.
constexpr double kCloseEnough = 0.015;

// All triangulations of the polygon with corners i, i + 1, ..., k.
std::vector<Triangulation> triangulations(int i, int k) {
  if (k - i < 2) return {{}};
  std::vector<Triangulation> all;
  for (int j = i + 1; j < k; j++)
    for (const Triangulation& left : triangulations(i, j))
      for (const Triangulation& right : triangulations(j, k)) {
        Triangulation t = left;
        t.push_back({i, j, k});
        t.insert(t.end(), right.begin(), right.end());
        all.push_back(t);
      }
  return all;
}

bool cross_each_other(const gp_Pnt2d& a, const gp_Pnt2d& b, const gp_Pnt2d& c, const gp_Pnt2d& d) {
  const auto side = [](const gp_Pnt2d& p, const gp_Pnt2d& q, const gp_Pnt2d& r) {
    return gp_Vec2d(p, q).Crossed(gp_Vec2d(p, r));
  };
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

// One vertex with its ring: corner i of the polygon is the face of ring[i], side i (from corner i - 1 to corner i) is
// the edge of ring[i].
class Splitter {
 public:
  Splitter(Model& model, int vertex, const Tolerances& tolerances)
      : model_(model), number_(vertex), tolerances_(tolerances), ring_(model.vertices[vertex].ring) {
    n_ = static_cast<int>(ring_.size());
    source_ = model.vertices[vertex].source;
    for (int h : ring_) normals_.push_back(start_normal(model, h));
  }

  // Splits the vertex in the way whose new edges are shortest together; false if none has less than `most`.
  bool split(double most) {
    std::optional<Triangulation> best;
    double best_length = 0;
    for (const Triangulation& t : triangulations(0, n_ - 1)) {
      const double length = total_length(t);
      if (length >= 0 && (!best || length < best_length)) {
        best = t;
        best_length = length;
      }
    }
    if (!best || best_length >= most) return false;
    apply(*best);
    return true;
  }

 private:
  int face(int corner) const { return model_.halves[ring_[corner]].face; }

  struct Point {
    gp_Pnt point;
    bool is_good;
  };

  std::vector<int> sides_of(const Triangle& t) const {
    std::vector<int> sides;
    for (int i : t)
      for (int k : t)
        if ((k + 1) % n_ == i) sides.push_back(ring_[i]);
    return sides;
  }

  Point point_of(const Triangle& t) {
    const std::vector<int> corners = {ring_[t[0]], ring_[t[1]], ring_[t[2]]};
    const std::vector<int> sides = sides_of(t);
    gp_Vec along(0, 0, 0);
    for (int side : sides) along += direction(side);
    if (along.Magnitude() > 1e-9) along.Normalize();
    Point p;
    // Where the three touch each other at the vertex, they meet to both sides of it: the point is wanted that lies on
    // the side of the triangle's own edges.
    for (double way : {0.0, 0.5, 1.5, 4.0}) {
      std::vector<Support> supports = supports_of(model_, corners, sides);
      const gp_Pnt miter = miter_point_of(model_, source_, corners);
      p.point = miter.Translated(along * (way * tolerances_.distance));
      for (Support& s : supports)
        if (s.curve.IsNull()) s.uv = project(*s.surface, p.point, s.uv);
      p.is_good = meet(supports, p.point) < tolerances_.gap;
      const gp_Vec moved(miter, p.point);
      if (p.is_good && (moved.Magnitude() < 0.5 * tolerances_.distance || moved.Dot(along) > 0)) break;
    }
    start_[t] = p.point;
    return p;
  }

  // The length of all new edges; below 0 if the triangulation is none that can be.
  double total_length(const Triangulation& t) {
    double length = 0;
    std::vector<Point> points;
    for (const Triangle& k : t) {
      for (int a = 0; a < 3; a++) {
        const int i = k[a], j = k[(a + 1) % 3];
        const bool is_side = (i + 1) % n_ == j || (j + 1) % n_ == i;
        if (!is_side && face(i) == face(j)) return -1;
      }
      points.push_back(point_of(k));
      if (!points.back().is_good) return -1;
    }
    for (int corner = 0; corner < n_; corner++) {
      const std::vector<int> chain = chain_of(t, corner);
      std::vector<gp_Pnt> line;
      for (int k : chain) line.push_back(points[k].point);
      // Only if there is no other: directions in the source say less of the offset the farther it is.
      if (!is_simple(line, corner) || has_spike(line, across(t, corner), corner))
        length += kCrossing * tolerances_.distance;
      for (std::size_t i = 0; i + 1 < line.size(); i++) length += line[i].Distance(line[i + 1]) / 2;
    }
    return length;
  }

  // The corners that are neighbours of one, from that at the side before it to that at the side behind it.
  std::vector<int> across(const Triangulation& t, int corner) const {
    std::vector<int> corners = {(corner + n_ - 1) % n_};
    for (int k : chain_of(t, corner))
      for (int i : t[k])
        if (i != corner && i != corners.back()) {
          corners.push_back(i);
          break;
        }
    return corners;
  }

  // Whether a border goes back over itself: along two of its edges that lie on one curve, as the faces behind them are
  // one surface.
  bool has_spike(const std::vector<gp_Pnt>& line, const std::vector<int>& behind, int corner) const {
    for (std::size_t i = 0; i + 1 < behind.size() && i < line.size(); i++) {
      const int a = behind[i], b = behind[i + 1];
      const int side = (a + 1) % n_ == b ? b : (b + 1) % n_ == a ? a : -1;
      if (side < 0 || !model_.edges[model_.halves[ring_[side]].edge].is_within) continue;
      const gp_Vec to = i > 0 ? gp_Vec(line[i - 1], line[i]) : -direction(ring_[corner]);
      const gp_Vec from = i + 1 < line.size() ? gp_Vec(line[i], line[i + 1]) : direction(ring_[(corner + 1) % n_]);
      if (to.Dot(from) < 0) return true;
    }
    return false;
  }

  // The triangles at a corner, from that at the side before it to that at the side behind it.
  std::vector<int> chain_of(const Triangulation& t, int corner) const {
    std::vector<int> chain;
    for (int other = (corner + n_ - 1) % n_; other != (corner + 1) % n_;) {
      int found = -1, third = -1;
      for (int k = 0; k < static_cast<int>(t.size()); k++) {
        if (std::find(chain.begin(), chain.end(), k) != chain.end()) continue;
        const bool has_both =
            std::count(t[k].begin(), t[k].end(), corner) && std::count(t[k].begin(), t[k].end(), other);
        if (!has_both) continue;
        found = k;
        for (int i : t[k])
          if (i != corner && i != other) third = i;
      }
      if (found < 0) break;
      chain.push_back(found);
      other = third;
    }
    return chain;
  }

  // Away from the vertex along a spoke, in the source.
  gp_Vec direction(int half) const {
    const HalfEdge& h = model_.halves[half];
    const ModelEdge& e = model_.edges[h.edge];
    if (e.curve.IsNull()) {
      const int end = end_vertex(model_, half);
      const gp_Vec way(source_, model_.vertices[end].source);
      return way.Magnitude() < 1e-12 ? way : way.Normalized();
    }
    gp_Pnt p;
    gp_Vec d;
    evaluate(*e.curve, h.forward ? e.first : e.last, p, d);
    if (d.Magnitude() < 1e-12) return d;
    return (h.forward ? d : -d).Normalized();
  }

  // A face's border round the vertex: along one spoke to it, over the new points, and out along the other.
  bool is_simple(const std::vector<gp_Pnt>& points, int corner) const {
    const gp_Vec n = normals_[corner];
    const gp_Ax3 plane(source_, gp_Dir(n));
    const auto flat = [&](const gp_Pnt& p) {
      const gp_Vec v(source_, p);
      return gp_Pnt2d(v.Dot(plane.XDirection()), v.Dot(plane.YDirection()));
    };
    double reach = 0;
    for (const gp_Pnt& p : points) reach = std::max(reach, p.Distance(source_));
    const double far = 30 * reach;
    std::vector<gp_Pnt2d> line;
    line.push_back(flat(points.front().Translated(direction(ring_[corner]) * far)));
    for (const gp_Pnt& p : points) line.push_back(flat(p));
    line.push_back(flat(points.back().Translated(direction(ring_[(corner + 1) % n_]) * far)));
    for (std::size_t i = 0; i + 1 < line.size(); i++)
      for (std::size_t k = i + 2; k + 1 < line.size(); k++)
        if (cross_each_other(line[i], line[i + 1], line[k], line[k + 1])) return false;
    return !is_turned_cusp(points, corner);
  }

  // Where the two spokes of a face leave in one direction the face is a cusp: its border comes in to the left of where
  // it goes out, before and after.
  bool is_turned_cusp(const std::vector<gp_Pnt>& points, int corner) const {
    const int out = ring_[corner], in = ring_[(corner + 1) % n_];
    const gp_Vec along = direction(out);
    if (along.Magnitude() < 0.5 || along.Angle(direction(in)) > 0.2) return false;
    const gp_Vec left = normals_[corner].Crossed(along);
    const gp_Vec apart(point_along(out), point_along(in));
    return apart.Dot(left) > 0 && gp_Vec(points.front(), points.back()).Dot(left) < 0;
  }

  // A point of the source's spoke, a third of the way.
  gp_Pnt point_along(int half) const {
    const HalfEdge& h = model_.halves[half];
    const ModelEdge& e = model_.edges[h.edge];
    if (e.curve.IsNull()) return model_.vertices[end_vertex(model_, half)].source;
    return e.curve->Value(e.first + (e.last - e.first) * (h.forward ? 1.0 / 3 : 2.0 / 3));
  }

  void apply(const Triangulation& t);

  Model& model_;
  int number_;
  const Tolerances& tolerances_;
  std::vector<int> ring_;
  std::vector<gp_Vec> normals_;
  gp_Pnt source_;
  int n_ = 0;
  std::map<Triangle, gp_Pnt> start_;  // Of what was tried, where its point was found.
};

void Splitter::apply(const Triangulation& t) {
  // Vertices: the first triangle keeps the old one.
  std::vector<int> vertex;
  for (std::size_t k = 0; k < t.size(); k++) {
    if (k > 0) {
      ModelVertex v;
      v.source = source_;
      model_.vertices.push_back(v);
    }
    vertex.push_back(k == 0 ? number_ : static_cast<int>(model_.vertices.size()) - 1);
    model_.vertices[vertex.back()].ring.clear();
  }
  // Half-edges of the new edges, by (corner, across).
  std::vector<std::array<int, 3>> diagonals;
  const auto half_of = [&](int corner, int across) {
    for (const auto& d : diagonals)
      if (d[0] == corner && d[1] == across) return d[2];
    return -1;
  };
  for (const Triangle& k : t)
    for (int a = 0; a < 3; a++) {
      const int i = k[a], j = k[(a + 1) % 3];
      if ((i + 1) % n_ == j || (j + 1) % n_ == i || half_of(i, j) >= 0) continue;
      ModelEdge e;
      e.half = {static_cast<int>(model_.halves.size()), static_cast<int>(model_.halves.size()) + 1};
      for (int side = 0; side < 2; side++) {
        HalfEdge h;
        h.edge = static_cast<int>(model_.edges.size());
        h.forward = side == 0;
        const HalfEdge& like = model_.halves[ring_[side == 0 ? i : j]];
        h.face = like.face;
        h.origin = h.start = h.end = like.origin;
        h.twin = e.half[1 - side];
        model_.halves.push_back(h);
      }
      diagonals.push_back({i, j, e.half[0]});
      diagonals.push_back({j, i, e.half[1]});
      model_.edges.push_back(e);
    }
  // Borders: in each face from the edge that comes in, over the chain backwards, to the edge that goes out.
  for (int corner = 0; corner < n_; corner++) {
    const std::vector<int> chain = chain_of(t, corner);
    int last = model_.halves[ring_[corner]].previous;
    for (int k = static_cast<int>(chain.size()) - 1; k > 0; k--) {
      // The diagonal between triangles chain[k] and chain[k - 1].
      int across = -1;
      for (int i : t[chain[k]])
        if (i != corner && std::count(t[chain[k - 1]].begin(), t[chain[k - 1]].end(), i)) across = i;
      const int h = half_of(corner, across);
      model_.halves[h].vertex = vertex[chain[k]];
      model_.halves[h].previous = last;
      model_.halves[last].next = h;
      last = h;
    }
    model_.halves[ring_[corner]].previous = last;
    model_.halves[last].next = ring_[corner];
    model_.halves[ring_[corner]].vertex = vertex[chain.front()];
  }
  for (std::size_t k = 0; k < t.size(); k++) {
    // The ring of a triangle's corners, in turn.
    Triangle c = t[k];
    std::sort(c.begin(), c.end());
    for (int a = 0; a < 3; a++) {
      const int corner = c[a], before = c[(a + 2) % 3];
      const int h = (before + 1) % n_ == corner ? ring_[corner] : half_of(corner, before);
      model_.vertices[vertex[k]].ring.push_back(h);
      model_.halves[h].vertex = vertex[k];
    }
  }
  for (std::size_t k = 0; k < t.size(); k++) {
    model_.vertices[vertex[k]].near = start_[t[k]];
    model_.vertices[vertex[k]].has_near = true;
    place_vertex(model_, vertex[k], tolerances_);
    if (model_.vertices[vertex[k]].residual > tolerances_.gap) place_astray(model_, vertex[k], tolerances_);
  }
}

}  // namespace

bool resolve_vertex(Model& model, int vertex, const Tolerances& tolerances) {
  const int n = static_cast<int>(model.vertices[vertex].ring.size());
  const auto is_far = [&] {
    // Of more than three faces that touch each other at the vertex the offsets may meet far off, to one side of it.
    const ModelVertex& v = model.vertices[vertex];
    return n > 3 && !v.is_open && v.point.Distance(miter_point_of(model, v.source, v.ring)) > tolerances.distance;
  };
  place_vertex(model, vertex, tolerances);
  if (model.vertices[vertex].residual <= tolerances.gap && !is_far()) return true;
  const bool is_close = model.vertices[vertex].residual <= kCloseEnough * tolerances.distance;
  const bool may_split = n >= 4 && n <= kMostCorners && !model.vertices[vertex].is_open;
  const auto split = [&](double most) { return may_split && Splitter(model, vertex, tolerances).split(most); };
  if (split(kCrossing * tolerances.distance)) return true;
  // Edges that end at a new edge stay where they are; those within one surface may also leave their trimming curves, as
  // where a step goes up between two faces of one plane.
  if (place_astray(model, vertex, tolerances) && !is_far()) return true;
  place_vertex(model, vertex, tolerances);
  if (split(INFINITY)) return true;
  if (let_stray(model, model.vertices[vertex].ring, true) && split(INFINITY)) return true;
  place_vertex(model, vertex, tolerances);
  return is_close;
}

}  // namespace vdb_offset::cad
