// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "ground/mesh/single_edges.h"
#include "ground/numbers/box_tree.h"
#include "ground/numbers/index_set.h"
#include "ground/numbers/morton.h"
#include "ground/system/parallel.h"
#include "space/surface/weld.h"

namespace vdb_offset {
namespace {

// Least length of what an edge is split into, in reaches: the direction of a shorter one says nothing. Not measured.
constexpr double kLongInReaches = 4;
// Cosine of the angle between two faces at an edge from which they are folded onto each other: sheets that lie on each
// other are not joined. Not measured.
constexpr double kFolded = 0.99;
// How many boxes of edges a vertex is held against, and how many sides it may be on: of a vertex in more of them
// nothing is known. Bounds the time where long edges are all across each other, and the pieces. Reasoned: far above
// what a mesh has that hangs together.
constexpr std::size_t kMostLookedAt = 512, kMostSides = 8;

/// The sides of triangles that have no other beside them.
std::vector<SingleEdge> border_of(const Surface& surface) {
  std::vector<std::uint32_t> corners, begin(surface.triangles.size() + 1), position(surface.vertices.size());
  corners.reserve(3 * surface.triangles.size());
  for (const auto& triangle : surface.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  for (std::size_t t = 0; t < begin.size(); ++t) begin[t] = static_cast<std::uint32_t>(3 * t);
  std::iota(position.begin(), position.end(), 0U);
  return find_single_edges({surface.vertices, corners, begin}, position);
}

/// A vertex on a side of a triangle: at which share of the way from the side's first corner to its second.
struct Hanging {
  std::uint32_t side;  // 3 t + k, as half-edges
  double share;
  std::uint32_t vertex;
  double off;  // its distance from the side

  bool operator<(const Hanging& other) const {
    return std::tie(side, share, vertex) < std::tie(other.side, other.share, other.vertex);
  }
};

/// Finds the vertices of a border that lie on its edges.
class HangingFinder {
 public:
  HangingFinder(const Surface& surface, std::vector<SingleEdge> border, double reach)
      : surface_(surface), border_(std::move(border)), reach_(reach) {
    sort_in_space();
    for (const SingleEdge& edge : border_) {
      ends_.push_back({edge.a, edge.b, edge.corner});
      ends_.push_back({edge.b, edge.a, edge.corner});
    }
    std::sort(ends_.begin(), ends_.end());
    tree_.build(border_.size(), [this](std::size_t i) { return box_of(border_[i]); });
  }

  std::vector<Hanging> all() const {
    std::vector<std::vector<Hanging>> of_end(ends_.size());
    for_each_index(
        ends_.size(),
        [&](std::size_t i) {
          if (i == 0 || ends_[i - 1].vertex != ends_[i].vertex) of_end[i] = at_vertex(ends_[i].vertex);
        },
        64);
    std::vector<Hanging> found;
    for (const std::vector<Hanging>& some : of_end) found.insert(found.end(), some.begin(), some.end());
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  /// An edge of the border as seen from one of its ends.
  struct End {
    std::uint32_t vertex, other, side;
    bool operator<(const End& end) const {
      return std::tie(vertex, other, side) < std::tie(end.vertex, end.other, end.side);
    }
  };

  const Vec3d& at(std::uint32_t v) const { return surface_.vertices[v]; }

  FloatBox box_of(const SingleEdge& edge) const {
    FloatBox box;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const double low = std::min(at(edge.a)[k], at(edge.b)[k]) - reach_,
                   high = std::max(at(edge.a)[k], at(edge.b)[k]) + reach_;
      box.lower[axis] = std::nextafter(static_cast<float>(low), -FloatBox::kInfinity);
      box.upper[axis] = std::nextafter(static_cast<float>(high), FloatBox::kInfinity);
    }
    return box;
  }

  /// Puts edges that are near each other next to each other, as the tree needs them.
  void sort_in_space() {
    const MortonCurve curve(surface_.facts.lower, surface_.facts.upper);
    std::vector<std::pair<std::uint64_t, std::size_t>> order(border_.size());
    for (std::size_t i = 0; i < order.size(); ++i)
      order[i] = {curve(at(border_[i].a) / 2.0 + at(border_[i].b) / 2.0), i};
    std::sort(order.begin(), order.end());
    std::vector<SingleEdge> sorted;
    sorted.reserve(order.size());
    for (const auto& [key, i] : order) sorted.push_back(border_[i]);
    border_ = std::move(sorted);
  }

  std::vector<Hanging> at_vertex(std::uint32_t v) const {
    std::vector<Hanging> found;
    std::size_t looked_at = 0;
    const bool is_too_much = tree_.any_overlap(box_of({v, v, 0}), [&](std::size_t i) {
      if (const Hanging here = on_side(v, border_[i].corner); here.off <= reach_) add(here, found);
      return ++looked_at > kMostLookedAt || found.size() > kMostSides;
    });
    return is_too_much ? std::vector<Hanging>() : found;
  }

  /// Adds a side that a vertex is on. Of two sides of one triangle the nearer counts.
  static void add(const Hanging& here, std::vector<Hanging>& found) {
    const auto same =
        std::find_if(found.begin(), found.end(), [&](const Hanging& each) { return each.side / 3 == here.side / 3; });
    if (same == found.end()) found.push_back(here);
    else if (std::tie(here.off, here.side) < std::tie(same->off, same->side)) *same = here;
  }

  /// Where a vertex hangs on a side of a triangle; off by more than the reach if it does not.
  Hanging on_side(std::uint32_t v, std::uint32_t side) const {
    const Hanging none{side, 0, v, std::numeric_limits<double>::infinity()};
    const auto& corners = surface_.triangles[side / 3];
    if (std::find(corners.begin(), corners.end(), v) != corners.end()) return none;
    const Vec3d &from = at(surface_.from(side)), along = at(surface_.to(side)) - from, to_v = at(v) - from;
    const double length = along.length(), share = along.dot(to_v) / along.lengthSqr();
    const double off = (to_v - along * share).length();
    if (!(off <= reach_) || !(std::min(share, 1 - share) * length > kLongInReaches * reach_)) return none;
    // A triangle that is as narrow as that is next to a line.
    if (!(away_from(side).length() > kLongInReaches * reach_) || !runs_along(v, side)) return none;
    return {side, share, v, off};
  }

  /// What leads from the line of a side, at right angles to it, to the triangle's third corner.
  Vec3d away_from(std::uint32_t side) const {
    const std::uint32_t third = surface_.triangles[side / 3][(side % 3 + 2) % 3];
    const Vec3d along = at(surface_.to(side)) - at(surface_.from(side)), to = at(third) - at(surface_.from(side));
    return to - along * (along.dot(to) / along.lengthSqr());
  }

  /// Whether another edge of the border at a vertex on a side runs along that side, with a face that is not folded onto
  /// the side's.
  bool runs_along(std::uint32_t v, std::uint32_t side) const {
    const Vec3d away = away_from(side);
    const auto first = std::lower_bound(ends_.begin(), ends_.end(), End{v, 0, 0});
    for (auto end = first; end != ends_.end() && end->vertex == v; ++end) {
      if (end->side / 3 == side / 3) continue;
      const Vec3d other = away_from(end->side);
      if (away.dot(other) > kFolded * away.length() * other.length()) continue;
      for (const std::uint32_t limit : {surface_.from(side), surface_.to(side)})
        if (covers(at(end->other) - at(v), at(limit) - at(v))) return true;
    }
    return false;
  }

  /// Whether the shorter of two vectors ends on the longer one.
  bool covers(Vec3d longer, Vec3d shorter) const {
    if (longer.lengthSqr() < shorter.lengthSqr()) std::swap(longer, shorter);
    if (!(shorter.length() > kLongInReaches * reach_) || !(longer.dot(shorter) > 0)) return false;
    return (shorter - longer * (longer.dot(shorter) / longer.lengthSqr())).length() <= reach_;
  }

  const Surface& surface_;
  std::vector<SingleEdge> border_;
  double reach_;
  std::vector<End> ends_;  // each edge from both ends, sorted
  BoxTree tree_;
};

/// Splits a triangle at vertices on its sides, in their order from corner to corner: at one of them, then what comes of
/// that.
void split_at(const std::array<std::uint32_t, 3>& corner, const std::array<std::span<const Hanging>, 3>& on_side,
              std::vector<std::array<std::uint32_t, 3>>& pieces) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (on_side[k].empty()) continue;
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3, middle = on_side[k].size() / 2;
    const std::uint32_t v = on_side[k][middle].vertex;
    split_at({corner[k], v, corner[last]}, {on_side[k].first(middle), {}, on_side[last]}, pieces);
    split_at({v, corner[next], corner[last]}, {on_side[k].subspan(middle + 1), on_side[next], {}}, pieces);
    return;
  }
  pieces.push_back(corner);
}

/// Splits triangles at the vertices on their sides, which are sorted. The first piece of each takes its place.
void split_triangles(std::span<const Hanging> all, Surface& surface) {
  surface.piece_of.assign(surface.triangles.size(), kNone);
  while (!all.empty()) {
    const std::uint32_t t = all.front().side / 3;
    std::array<std::span<const Hanging>, 3> on_side;
    for (std::uint32_t k = 0; k < 3; ++k) {
      std::size_t count = 0;
      while (count < all.size() && all[count].side == 3 * t + k) ++count;
      on_side[k] = all.first(count);
      all = all.subspan(count);
    }
    std::vector<std::array<std::uint32_t, 3>> pieces;
    split_at(surface.triangles[t], on_side, pieces);
    surface.piece_of[t] = static_cast<std::uint32_t>(surface.split.size());
    surface.split.push_back({surface.triangles[t], {}});
    surface.triangles[t] = pieces.front();
    surface.triangles.insert(surface.triangles.end(), pieces.begin() + 1, pieces.end());
    surface.face.resize(surface.triangles.size(), surface.face[t]);
    surface.piece_of.resize(surface.triangles.size(), surface.piece_of[t]);
  }
}

}  // namespace

void join_hanging_vertices(Surface& surface, double reach) {
  std::vector<SingleEdge> border = border_of(surface);
  if (border.empty()) return;
  std::vector<Hanging> hanging = HangingFinder(surface, std::move(border), reach).all();
  const auto too_near = [&](const Hanging& a, const Hanging& b) {
    return a.side == b.side &&
           (surface.vertices[a.vertex] - surface.vertices[b.vertex]).length() <= kLongInReaches * reach;
  };
  hanging.erase(std::unique(hanging.begin(), hanging.end(), too_near), hanging.end());
  constexpr std::size_t kMostHalfEdges = std::size_t{1} << 31;  // numbers of half-edges have 32 bits
  if (hanging.empty() || surface.triangles.size() + hanging.size() >= kMostHalfEdges / 3) return;
  split_triangles(hanging, surface);
  Indices vertices;
  for (const Hanging& each : hanging) {
    vertices.push_back(each.vertex);
    surface.facts.seams.widest_hanging = std::max(surface.facts.seams.widest_hanging, each.off);
  }
  sort_unique(vertices);
  surface.facts.seams.hanging = vertices.size();
}

}  // namespace vdb_offset
