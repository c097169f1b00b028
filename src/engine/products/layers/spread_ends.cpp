// SPDX-License-Identifier: Apache-2.0
// Spreads the ends of paths that crowd, before layers are put below them: the rails of the layers bend towards where
// the ends are then, and the wall's right angles stay. An edge is crowded if it has less than a fifth of the wall's
// length, and less than half of what it would have if both its vertices had gone straight along their normals: inside
// of a pipe, edges get short without being crowded. Springs are relaxed over the crowded vertices and a few rings
// around them, in the order of vertices and by one thread; vertices are put back to their distances in parallel. Rings
// are added where edges are still crowded.
#include "products/layers/spread_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// An edge is crowded below this share of the wall's edge, as are the segments of curves. Larger shares move more
// vertices farther.
constexpr double kCrowded = 0.2;
// What springs are relaxed to is more than that: the layers below are on rails, and no nearer to each other. Not
// measured.
constexpr double kAim = 0.25;
// Edges that are shorter than this share of what their vertices' normals ask for are crowded, others shrink with all
// that is around them.
constexpr double kShareOfStraight = 0.5;
// The cosine of the angle between two faces beyond which the edge between them is sharp: 40 degrees. Vertices of sharp
// edges stay on these. Not measured.
constexpr double kSharpEdge = 0.77;
// The most rings around what was crowded at first: each makes room for four more vertices on a line. Not measured.
constexpr int kMostRings = 6;
// The most sweeps over all springs before a ring is added, and after how many of them vertices go back to their
// distances. Means alone, as over-relaxed vertices overtake others that stay. Measured: with a third of the sweeps, an
// L tube keeps edges of 0.06 at ten spacings.
constexpr int kSweeps = 96, kSweepsAtOnce = 24;
// The most steps of putting a vertex back to its distance, and the error at which that ends, as a share of
// kReachedTolerance. On planes one step is exact.
constexpr int kStepsBack = 8;
constexpr double kStepTolerance = 1e-3;
// A vertex goes no farther from where its path ended than so many distances. Not measured.
constexpr double kFarthest = 4;

/// Between two vertices whose columns share a side.
struct Spring {
  std::uint32_t other;
  double on_wall;                                        // length, world units
  double least = std::numeric_limits<double>::lowest();  // share of that below which it is crowded
};

/// Two planes beside a sharp edge, by their normals, and the line where their fronts meet.
struct FrontCrease {
  Vec3d n, m;
  /// The way to that line from a place that is so far from where it ought to be along both normals.
  Vec3d way(double along_n, double along_m) const {
    const double cosine = n.dot(m), det = 1 - cosine * cosine;
    return n * ((along_n - cosine * along_m) / det) + m * ((along_m - cosine * along_n) / det);
  }
};

/// The two corners beside one in a ring.
std::array<std::uint32_t, 2> corners_beside(std::span<const std::uint32_t> ring, std::uint32_t corner) {
  const auto k = static_cast<std::size_t>(std::find(ring.begin(), ring.end(), corner) - ring.begin());
  return {ring[(k + 1) % ring.size()], ring[(k + ring.size() - 1) % ring.size()]};
}

/// Calls visit(edge) for each side of columns that a vertex is on: twice where two columns share it.
template <class Visit>
void for_each_spring(const SpreadInput& input, std::uint32_t v, Visit&& visit) {
  for (const auto column : input.columns.around(v))
    for (const auto w : corners_beside(input.columns.base(column), v))
      if (const double length = (input.source[w] - input.source[v]).length(); length > 0) visit(Spring{w, length});
}

class EndSpreader {
 public:
  EndSpreader(const SpreadInput& input, const Paths& paths)
      : input_(input),
        part_(input.constrained.moving_part.surface()),
        paths_(paths),
        place_(input.source.size(), kNone) {}

  /// The vertices that are to move. Their places follow by position().
  Indices run() {
    Indices crowded = crowded_at_ends();
    if (crowded.empty()) return {};
    add(crowded);
    for (int ring = 0; ring < kMostRings && !crowded.empty(); ++ring) {
      for (int sweep = 0; sweep < kSweeps && !crowded.empty(); sweep += kSweepsAtOnce) {
        relax();
        crowded = still_crowded();
      }
      if (!add_ring(crowded)) break;
    }
    Indices moved;
    for (std::size_t r = 0; r < region_.size(); ++r)
      if (is_pulled_[r] && put_exactly(r)) moved.push_back(region_[r]);
    sort_unique(moved);
    return moved;
  }
  /// Where a vertex of the surface is, in its frame.
  Vec3d position(std::uint32_t v) const { return place_[v] == kNone ? end_of(v) : at_[place_[v]]; }
  std::uint32_t closest(std::uint32_t v) const { return hint_[place_[v]]; }
  /// The shortest crowded edge of a vertex, as a share of the wall's; 1 if none is.
  double least_crowded(std::uint32_t v) const {
    double least = 1;
    if (!has_arrived(v)) return least;
    for_each_spring(v, [&](const Spring& edge) {
      if (!has_arrived(edge.other)) return;
      const double share = share_of(v, edge);
      if (share < kCrowded && share < least_share(v, edge, kCrowded)) least = std::min(least, share);
    });
    return least;
  }

 private:
  Vec3d end_of(std::uint32_t v) const { return input_.constrained.surface.vertices[v] + paths_.displacement[v]; }
  std::uint32_t on_part(std::uint32_t v) const { return input_.constrained.part_vertex_of(v); }
  double target(std::uint32_t v) const { return std::abs(input_.distances[v]); }
  double side(std::uint32_t v) const { return input_.distances[v] < 0 ? -1 : 1; }

  /// Whether a vertex has a place on the outermost surface that may be another one.
  bool has_arrived(std::uint32_t v) const {
    return input_.constrained.vertex_on_part(v) && input_.distances[v] != 0 && !falls_short(paths_.state[v]) &&
           paths_.state[v] != VertexState::Unused;
  }
  bool may_move(std::uint32_t v) const {
    return has_arrived(v) && paths_.state[v] == VertexState::Reached && !input_.constrained.is_bound(v) &&
           !input_.columns.is_opened(v) && has_way(along_sharp_edges(v));
  }
  /// Whether a vertex with these sharp edges may go anywhere: on its surface, or along one line of edges.
  static bool has_way(const Indices& along_sharp) { return along_sharp.empty() || along_sharp.size() == 2; }
  /// The other ends of the sharp edges at a vertex.
  Indices along_sharp_edges(std::uint32_t v) const {
    Indices others;
    const auto columns = input_.columns.around(v);
    for (std::size_t i = 0; i < columns.size(); ++i)
      for (std::size_t j = i + 1; j < columns.size(); ++j) {
        const Vec3d n = normal_of(columns[i]), m = normal_of(columns[j]);
        if (!(n.dot(m) < kSharpEdge * n.length() * m.length())) continue;
        for (const auto w : corners_beside(columns[i], v))
          for (const auto u : corners_beside(columns[j], v))
            if (u == w) others.push_back(w);
      }
    sort_unique(others);
    return others;
  }
  /// The crease of the front that a vertex on a line of sharp edges stays on: none where the edge is convex there, and
  /// the front round, or where its faces are all but back to back.
  std::optional<FrontCrease> crease_over(std::uint32_t v) const {
    constexpr double kBackToBack = -0.95;  // cosine; not measured
    const auto columns = input_.columns.around(v);
    for (std::size_t i = 0; i < columns.size(); ++i)
      for (std::size_t j = i + 1; j < columns.size(); ++j) {
        const FrontCrease crease{normal_of(columns[i]).unit(), normal_of(columns[j]).unit()};
        const double cosine = crease.n.dot(crease.m);
        if (!(cosine < kSharpEdge) || !have_common_side(columns[i], columns[j], v)) continue;
        Vec3d middle(0.0);
        const auto ring = input_.columns.base(columns[j]);
        for (const auto w : ring) middle += input_.source[w] / static_cast<double>(ring.size());
        const bool is_concave = side(v) * crease.n.dot(middle - input_.source[v]) > 0;
        if (is_concave && cosine > kBackToBack) return crease;
      }
    return std::nullopt;
  }
  bool have_common_side(std::uint32_t column, std::uint32_t other, std::uint32_t v) const {
    const auto a = corners_beside(column, v), b = corners_beside(other, v);
    return a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
  }
  /// The two corners beside one in a column's base.
  std::array<std::uint32_t, 2> corners_beside(std::uint32_t column, std::uint32_t v) const {
    return vdb_offset::corners_beside(input_.columns.base(column), v);
  }
  /// Of a column's base on the wall, not normalised.
  Vec3d normal_of(std::uint32_t column) const {
    const auto ring = input_.columns.base(column);
    Vec3d sum(0.0);
    for (std::size_t i = 1; i + 1 < ring.size(); ++i)
      sum +=
          (input_.source[ring[i]] - input_.source[ring[0]]).cross(input_.source[ring[i + 1]] - input_.source[ring[0]]);
    return sum;
  }

  template <class Visit>
  void for_each_spring(std::uint32_t v, Visit&& visit) const {
    vdb_offset::for_each_spring(input_, v, visit);
  }

  /// The share of the wall's edge below which an edge is crowded: `aim`, or less where the straight ways along its
  /// vertices' normals bring these nearer to each other, as inside of a pipe. Beside a sharp edge that says nothing:
  /// the normals there lean towards its neighbours.
  double least_share(std::uint32_t v, const Spring& edge, double aim) const {
    if (along_sharp_edges(v).empty() != along_sharp_edges(edge.other).empty()) return aim;
    const auto straight = [&](std::uint32_t w) { return start_direction(part_, on_part(w)) * input_.distances[w]; };
    const Vec3d along = input_.source[edge.other] - input_.source[v];
    const double share = (along + straight(edge.other) - straight(v)).dot(along) / along.lengthSqr();
    return share > 0 ? std::min(aim, kShareOfStraight * share) : aim;
  }
  double share_of(std::uint32_t v, const Spring& edge) const {
    return (position(edge.other) - position(v)).length() / edge.on_wall;
  }
  /// The vertices that may move and whose edges are crowded where paths end.
  Indices crowded_at_ends() const {
    std::vector<std::uint8_t> is_one(input_.source.size(), 0);
    for_each_index(input_.source.size(), [&](std::size_t i) {
      const auto v = static_cast<std::uint32_t>(i);
      is_one[v] = least_crowded(v) < 1 && may_move(v);
    });
    Indices crowded;
    for (std::uint32_t v = 0; v < is_one.size(); ++v)
      if (is_one[v]) crowded.push_back(v);
    return crowded;
  }
  /// Whether a vertex is crowded, or beside where it ought to be of a neighbour: edges count along those of the wall.
  bool is_crowded(std::size_t r) const {
    const std::uint32_t v = region_[r];
    return std::any_of(edges_[r].begin(), edges_[r].end(), [&](const Spring& edge) {
      const Vec3d along = input_.source[edge.other] - input_.source[v], way = position(edge.other) - position(v);
      return way.dot(along) < edge.least * along.lengthSqr();
    });
  }
  Indices still_crowded() const {
    Indices crowded;
    for (std::size_t r = 0; r < region_.size(); ++r)
      if (is_crowded(r)) crowded.push_back(region_[r]);
    return crowded;
  }

  /// Adds vertices to those that are spread.
  void add(const Indices& vertices) {
    for (const auto v : vertices) {
      if (place_[v] != kNone) continue;
      place_[v] = static_cast<std::uint32_t>(region_.size());
      region_.push_back(v);
      at_.push_back(end_of(v));
      hint_.push_back(paths_.closest[v]);
      is_pulled_.push_back(0);
      edges_.emplace_back();
      const Indices along_sharp = along_sharp_edges(v);
      crease_.push_back(along_sharp.empty() ? std::nullopt : crease_over(v));
      for_each_spring(v, [&](Spring edge) {
        if (!input_.constrained.vertex_on_part(edge.other)) return;
        if (!along_sharp.empty() && !std::binary_search(along_sharp.begin(), along_sharp.end(), edge.other)) return;
        if (has_arrived(edge.other)) edge.least = least_share(v, edge, kAim);
        edges_.back().push_back(edge);
      });
    }
  }
  /// Adds the neighbours of vertices that may move. Returns whether there are any.
  bool add_ring(const Indices& around) {
    Indices ring;
    for (const auto v : around)
      for (const Spring& edge : edges_[place_[v]])
        if (place_[edge.other] == kNone && may_move(edge.other)) ring.push_back(edge.other);
    sort_unique(ring);
    add(ring);
    return !ring.empty();
  }

  void relax() {
    for (int i = 0; i < kSweepsAtOnce; ++i)
      for (std::size_t r = 0; r < region_.size(); ++r)
        if (is_crowded(r)) pull(r);
    for_each_index(
        region_.size(),
        [&](std::size_t r) {
          if (is_pulled_[r]) put_back(r, 1);
        },
        64);
  }
  /// Moves a vertex to the mean of its neighbours, each weighted by the shortness of its edge.
  void pull(std::size_t r) {
    is_pulled_[r] = 1;
    Vec3d sum(0.0);
    double weights = 0;
    for (const Spring& edge : edges_[r]) {
      sum += position(edge.other) / edge.on_wall;
      weights += 1 / edge.on_wall;
    }
    const std::uint32_t v = region_[r];
    Vec3d to = sum / weights;
    if (crease_[r]) {
      const Vec3d from_wall = to - input_.constrained.surface.vertices[v];
      const double distance = input_.distances[v];
      to += crease_[r]->way(distance - crease_[r]->n.dot(from_wall), distance - crease_[r]->m.dot(from_wall));
    }
    at_[r] += part_.along_border(on_part(v), to - at_[r]);
  }
  /// Puts a vertex back to its distance in no more than so many steps. Returns whether it is there, on its side.
  bool put_back(std::size_t r, int steps) {
    const std::uint32_t v = region_[r];
    for (int i = 0; i < steps; ++i) {
      const Closest closest = input_.constrained.moving_part(at_[r], hint_[r]);
      hint_[r] = closest.triangle;
      const Vec3d away = at_[r] - closest.point;
      if (!(side(v) * part_.pseudonormal(closest.triangle, closest.feature).dot(away) > 0)) return false;
      const double error = target(v) - closest.distance;
      if (std::abs(error) <= kStepTolerance * kReachedTolerance * target(v)) return true;
      const Vec3d way = part_.along_border(on_part(v), away);
      const double slope = way.dot(away);
      if (!(slope > 0.1 * away.lengthSqr())) return false;
      at_[r] += way * (error * closest.distance / slope);
    }
    return false;
  }
  /// Puts a vertex to its distance exactly; or back to the end of its path, and returns false.
  bool put_exactly(std::size_t r) {
    const std::uint32_t v = region_[r];
    if (put_back(r, kStepsBack) && (at_[r] - end_of(v)).length() <= kFarthest * target(v)) return true;
    at_[r] = end_of(v);
    hint_[r] = paths_.closest[v];
    return false;
  }

  const SpreadInput& input_;
  const Surface& part_;
  const Paths& paths_;
  std::vector<std::uint32_t> place_;  // of each of the surface's vertices: in region_, kNone if it is not there
  std::vector<std::uint32_t> region_;
  // Of each vertex of the region: where it is, in the surface's frame; the triangle closest to it; whether it was
  // moved; its edges; what it stays on.
  std::vector<Vec3d> at_;
  std::vector<std::uint32_t> hint_;
  std::vector<std::uint8_t> is_pulled_;
  std::vector<std::vector<Spring>> edges_;
  std::vector<std::optional<FrontCrease>> crease_;
};

}  // namespace

std::vector<Vec3d> spread_ends(const SpreadInput& input, FaultFinder& faults, Paths& paths) {
  EndSpreader spreader(input, paths);
  Indices moved = spreader.run();
  if (moved.empty()) return {};
  const std::vector<Vec3d> before = paths.displacement;
  const std::vector<std::uint32_t> ends = paths.closest;
  for (const auto v : moved) {
    const Vec3d displacement = spreader.position(v) - input.constrained.surface.vertices[v];
    paths.displacement[v] = round_displacement(displacement, std::abs(input.distances[v]));
    paths.closest[v] = spreader.closest(v);
  }
  faults.move_to_ends(paths, moved);
  // What goes back may be in the way of others that have moved.
  const auto has_moved = [&](std::uint32_t v) { return paths.displacement[v] != before[v]; };
  const auto each_neighbour = [&](std::uint32_t v, const auto& visit) {
    for_each_spring(input, v, [&](const Spring& edge) { visit(edge.other); });
  };
  for (;;) {
    const Indices back = spread_together(faults.faulty_vertices(), before.size(), has_moved, each_neighbour);
    if (back.empty()) break;
    for (const auto v : back) {
      paths.displacement[v] = before[v];
      paths.closest[v] = ends[v];
    }
    faults.move_to_ends(paths, back);
  }
  return paths.displacement == before ? std::vector<Vec3d>() : before;
}

void count_crowded(const SpreadInput& input, const Paths& paths, std::span<const double> shares,
                   LayerStatistics& statistics) {
  const EndSpreader ends(input, paths);
  std::vector<double> least(shares.size());
  for_each_index(shares.size(), [&](std::size_t v) {
    least[v] = shares[v] == 1 ? ends.least_crowded(static_cast<std::uint32_t>(v)) : 1;
  });
  for (const double each : least) {
    statistics.crowded_vertices += each < 1;
    statistics.least_edge = std::min(statistics.least_edge, each);
  }
}

}  // namespace vdb_offset
