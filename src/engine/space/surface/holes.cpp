// SPDX-License-Identifier: Apache-2.0
#include "space/surface/holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "ground/numbers/disjoint_sets.h"

namespace vdb_offset {
namespace {

// Largest area of a hole that may be filled, as a share of its part's area: of any hole; of a hole whose filling goes
// on as the faces around it do; and of all holes together. Not measured beside other shares.
constexpr double kTinyHole = 0.002, kFlatHole = 0.05, kAllHoles = 0.1;
// Mean cosine of the angles between faces and filling along a rim, above which the filling goes on as the faces do: 60
// degrees. Not measured.
constexpr double kFlatRim = 0.5;
// How far a plane loop may be off its plane, as a share of the diagonal: the rounding of files that keep seven digits.
constexpr double kPlane = 1e-6;

/// An edge that lacks a face, in the direction in which that face would run.
struct OpenEdge {
  std::uint32_t from, to, triangle;
  bool is_border;  // it has one face
};

/// Numbers the parts, which are connected over edges, in the order of their first triangle.
std::uint32_t number_parts(const Surface& surface, std::vector<std::uint32_t>& part_of) {
  DisjointSets parts(surface.triangles.size());
  for (std::uint32_t edge = 0; edge < surface.next_around_edge.size(); ++edge)
    parts.join(edge / 3, surface.next_around_edge[edge] / 3);
  part_of = std::move(parts).firsts();
  std::vector<std::uint32_t> number(part_of.size(), kNone);
  std::uint32_t count = 0;
  for (std::uint32_t& part : part_of) {
    if (number[part] == kNone) number[part] = count++;
    part = number[part];
  }
  return count;
}

/// The edges along which more faces run in one direction than in the other; each one as many times as there are more.
std::vector<OpenEdge> find_open_edges(const Surface& surface) {
  std::vector<OpenEdge> open;
  for (std::uint32_t edge = 0; edge < surface.next_around_edge.size(); ++edge) {
    int forwards = 0, backwards = 0;
    bool is_first = true;
    std::uint32_t other = edge;
    do {
      is_first = is_first && other >= edge;
      ++(surface.from(other) == surface.from(edge) ? forwards : backwards);
      other = surface.next_around_edge[other];
    } while (other != edge);
    if (!is_first || forwards == backwards) continue;
    std::uint32_t from = surface.to(edge), to = surface.from(edge);
    if (forwards < backwards) std::swap(from, to);
    for (int i = std::abs(forwards - backwards); i > 0; --i)
      open.push_back({from, to, edge / 3, forwards + backwards == 1});
  }
  return open;
}

/// Cuts the open edges into loops, which pass no vertex twice.
class LoopFinder {
 public:
  explicit LoopFinder(const std::vector<OpenEdge>& edges) : edges_(edges) {
    for (std::uint32_t e = 0; e < edges.size(); ++e) leaving_[edges[e].from].push_back(e);
    for (auto& [vertex, some] : leaving_)
      std::reverse(some.begin(), some.end());  // edges are taken from the back, the first one first
  }

  std::vector<std::vector<std::uint32_t>> find() {
    for (auto& [vertex, some] : leaving_)
      while (!some.empty()) walk_from(vertex);
    return std::move(loops_);
  }

 private:
  /// Walks along open edges and cuts off each loop that closes. As many open edges arrive at a vertex as leave it, so
  /// that the walk ends where it began.
  void walk_from(std::uint32_t start) {
    std::vector<std::uint32_t> path;
    std::map<std::uint32_t, std::size_t> step{{start, 0}};  // of each vertex on the path: how many edges lead to it
    for (std::uint32_t at = start; !leaving_[at].empty();) {
      const std::uint32_t edge = leaving_[at].back();
      leaving_[at].pop_back();
      path.push_back(edge);
      at = edges_[edge].to;
      const auto [known, is_new] = step.emplace(at, path.size());
      if (is_new) continue;
      const auto begin = path.begin() + static_cast<std::ptrdiff_t>(known->second);
      loops_.emplace_back(begin, path.end());
      for (auto e = begin + 1; e < path.end(); ++e) step.erase(edges_[*e].from);
      path.erase(begin, path.end());
    }
  }

  const std::vector<OpenEdge>& edges_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> leaving_;
  std::vector<std::vector<std::uint32_t>> loops_;
};

/// A hole, and what decides whether it may be filled.
struct JudgedHole {
  Hole hole;
  Vec3d centre{0.0}, across{0.0};  // of the rim; the vector area of the fan that fills it
  double cosine = 0;               // of the angles between faces and filling, the mean along the rim
  bool is_inner = true;            // no edge of the rim is a border
};

JudgedHole judge(const Surface& surface, const std::vector<OpenEdge>& edges, const std::vector<std::uint32_t>& loop) {
  JudgedHole judged;
  Hole& hole = judged.hole;
  for (const auto e : loop) {
    hole.rim.push_back(edges[e].from);
    judged.is_inner = judged.is_inner && !edges[e].is_border;
  }
  hole.beside = edges[loop.front()].triangle;
  judged.centre = centre_of(surface, hole);
  double length = 0;
  for (const auto e : loop) {
    const Vec3d &from = surface.vertices[edges[e].from], &to = surface.vertices[edges[e].to];
    const auto& [a, b, c] = surface.triangles[edges[e].triangle];
    const Vec3d filling = (from - judged.centre).cross(to - judged.centre),
                face = (surface.vertices[b] - surface.vertices[a]).cross(surface.vertices[c] - surface.vertices[a]);
    judged.across += filling / 2.0;
    hole.area += filling.length() / 2;
    hole.radius = std::max(hole.radius, (from - judged.centre).length());
    const double both = filling.length() * face.length(), edge = (to - from).length();
    length += edge;
    if (both > 0) judged.cosine += edge * filling.dot(face) / both;
  }
  if (length > 0) judged.cosine /= length;
  return judged;
}

bool is_plane(const Surface& surface, const JudgedHole& judged) {
  if (!(judged.across.lengthSqr() > 0)) return true;
  const Vec3d normal = judged.across.unit();
  return std::all_of(judged.hole.rim.begin(), judged.hole.rim.end(), [&](std::uint32_t v) {
    return std::abs(normal.dot(surface.vertices[v] - judged.centre)) <= kPlane * surface.facts.diagonal;
  });
}

double triangle_area(const Surface& surface, std::size_t t) {
  const auto& [a, b, c] = surface.triangles[t];
  return (surface.vertices[b] - surface.vertices[a]).cross(surface.vertices[c] - surface.vertices[a]).length() / 2;
}

}  // namespace

Vec3d centre_of(const Surface& surface, const Hole& hole) {
  Vec3d sum(0.0);
  for (const auto v : hole.rim) sum += surface.vertices[v];
  return sum / static_cast<double>(hole.rim.size());
}

std::size_t Solidity::solid_parts() const {
  return static_cast<std::size_t>(std::count(is_solid.begin(), is_solid.end(), 1));
}

std::size_t Solidity::hole_count() const {
  return static_cast<std::size_t>(std::count_if(holes.begin(), holes.end(), [](const Hole& h) { return !h.is_wall; }));
}

double Solidity::hole_area() const {
  return std::accumulate(holes.begin(), holes.end(), 0.0,
                         [](double sum, const Hole& h) { return h.is_wall ? sum : sum + h.area; });
}

Solidity find_solid_parts(const Surface& surface) {
  Solidity found;
  const std::uint32_t parts = number_parts(surface, found.part_of);
  found.is_solid.assign(parts, 1);
  std::vector<double> area(parts, 0), of_holes(parts, 0);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) area[found.part_of[t]] += triangle_area(surface, t);
  const std::vector<OpenEdge> edges = find_open_edges(surface);
  for (const auto& loop : LoopFinder(edges).find()) {
    JudgedHole judged = judge(surface, edges, loop);
    const std::uint32_t part = found.part_of[judged.hole.beside];
    const double share = judged.hole.area / area[part];
    judged.hole.is_wall = judged.is_inner && is_plane(surface, judged);
    if (!judged.hole.is_wall) {
      of_holes[part] += share;
      const bool is_small = share <= kTinyHole || (share <= kFlatHole && judged.cosine >= kFlatRim);
      if (!is_small || of_holes[part] > kAllHoles) found.is_solid[part] = 0;
    }
    found.holes.push_back(std::move(judged.hole));
  }
  std::erase_if(found.holes, [&](const Hole& hole) { return !found.is_solid[found.part_of[hole.beside]]; });
  const Vec3d origin = surface.vertices.front();
  const auto six_volumes = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return (a - origin).dot((b - origin).cross(c - origin));
  };
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!found.is_solid[found.part_of[t]]) continue;
    const auto& [a, b, c] = surface.triangles[t];
    found.area += triangle_area(surface, t);
    found.volume += six_volumes(surface.vertices[a], surface.vertices[b], surface.vertices[c]) / 6;
  }
  for (const Hole& hole : found.holes) {
    const Vec3d centre = centre_of(surface, hole);
    for (std::size_t i = 0; i < hole.rim.size(); ++i)
      found.volume +=
          six_volumes(centre, surface.vertices[hole.rim[i]], surface.vertices[hole.rim[(i + 1) % hole.rim.size()]]) / 6;
  }
  return found;
}

}  // namespace vdb_offset
