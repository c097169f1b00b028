// SPDX-License-Identifier: Apache-2.0
#include "space/sheets/sheet_sides.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>

#include "ground/mesh/edge_sides.h"
#include "ground/mesh/triangulate.h"
#include "ground/numbers/disjoint_sets.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "space/sheets/wedge_cuts.h"

namespace vdb_offset {
namespace {

// The largest angle, in radians, between two sheets that count as being on one plane: if these are thick on different
// sides, a common corner would be far away. Not measured.
constexpr double kOneLevel = 0.6;
// The largest distance between the unit vectors from an edge into two faces that lie on each other. Far above rounding,
// far below all angles that are meant; not measured.
constexpr double kOnEachOther = 1e-6;

/// A face as seen along an edge.
struct Leaf {
  std::uint32_t corner, face;
  bool forwards;     // it runs through the edge from the smaller vertex to the larger one
  Vec3d into{0.0};   // unit vector from the edge into the face
  double angle = 0;  // around the edge
  /// The side towards the leaf at the next larger angle.
  std::uint8_t next_side() const { return forwards ? 0 : 1; }
  std::uint8_t previous_side() const { return 1 - next_side(); }
};

class SideFinder {
 public:
  explicit SideFinder(const Sheets& sheets)
      : sheets_(sheets), mesh_(sheets.mesh), joined_(2 * sheets.mesh.corners.size()), face_of_(mesh_.corners.size()) {
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f)
      for (std::uint32_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c) face_of_[c] = f;
  }

  SheetSides find() {
    join_all();
    cut_wedges();
    std::stable_sort(found_.gaps.begin(), found_.gaps.end(),
                     [](const auto& a, const auto& b) { return a.corner[0] < b.corner[0]; });
    number_wedges();
    return std::move(found_);
  }

 private:
  /// A sector at an edge of three faces or more, at one of its ends.
  struct Sector {
    std::uint32_t edge, vertex, corner;  // as 2 c + s
  };

  void join_all() {
    edge_ = 0;
    visit_edges(mesh_, sheets_.welded_to, [&](std::uint32_t smaller, std::span<const EdgeSide> sides) {
      ++edge_;
      if (sides.size() == 1) leave_open({{sides[0].corner, sides[0].corner}, {0, 1}, Vec3d(0.0)});
      else if (sides.size() == 2) join_two(leaf_of(smaller, sides[0]), leaf_of(smaller, sides[1]));
      else join_around(smaller, sides);
    });
  }

  /// Cuts wedges that come by one edge twice (see find_cuts()).
  void cut_wedges() {
    for (Sector& sector : sectors_) sector.corner = joined_.first(sector.corner);
    const auto key = [](const Sector& s) { return std::tuple(s.edge, s.vertex, s.corner); };
    std::sort(sectors_.begin(), sectors_.end(), [&](const Sector& a, const Sector& b) { return key(a) < key(b); });
    for (std::size_t i = 1; i < sectors_.size(); ++i)
      if (key(sectors_[i]) == key(sectors_[i - 1])) links_[sectors_[i].corner];
    if (links_.empty()) return;
    is_joined_ = true;
    join_all();
    for (const auto& [wedge, links] : links_) cut(links);
  }

  void cut(const std::vector<WedgeLink>& links) {
    const std::vector<WedgeCut> cuts = find_cuts(mesh_, links);
    if (cuts.empty()) return;
    std::vector<std::uint8_t> is_cut(links.size(), 0);
    for (const WedgeCut& cut : cuts) {
      is_cut[cut.link] = 1;
      const SheetSides::Gap& gap = links[cut.link].gap;
      if (cut_.insert({gap.corner[0], gap.side[0]}).second) found_.gaps.push_back(gap);  // else at its other end, too
      found_.shared.insert(found_.shared.end(), cut.shared.begin(), cut.shared.end());
    }
    for (const WedgeLink& link : links)
      for (const auto corner : link.corners) joined_.part(corner);
    for (std::size_t i = 0; i < links.size(); ++i)
      if (!is_cut[i]) joined_.join(links[i].corners[0], links[i].corners[1]);
  }

  void leave_open(const SheetSides::Gap& gap) {
    if (!is_joined_) found_.gaps.push_back(gap);
  }

  std::uint32_t next(std::uint32_t corner) const {
    const std::uint32_t f = face_of_[corner];
    return corner + 1 < mesh_.face_begin[f + 1] ? corner + 1 : mesh_.face_begin[f];
  }
  Leaf leaf_of(std::uint32_t smaller, const EdgeSide& side) const {
    return {side.corner, face_of_[side.corner], sheets_.welded_to[mesh_.corners[side.corner]] == smaller};
  }
  /// The leaf's corners at the smaller and the larger position.
  std::array<std::uint32_t, 2> ends(const Leaf& leaf) const {
    const std::uint32_t other = next(leaf.corner);
    return leaf.forwards ? std::array{leaf.corner, other} : std::array{other, leaf.corner};
  }

  /// Joins two sides at both ends of their edge. In the second pass, when all are joined, notes the links of wedges
  /// that may have to be cut instead.
  void join(const Leaf& a, std::uint8_t side_of_a, const Leaf& b, std::uint8_t side_of_b, bool is_sector = false) {
    const auto at_a = ends(a), at_b = ends(b);
    for (std::size_t end = 0; end < 2; ++end) {
      const std::uint32_t own = 2 * at_a[end] + side_of_a, other = 2 * at_b[end] + side_of_b;
      if (!is_joined_) {
        joined_.join(own, other);
        if (is_sector) sectors_.push_back({edge_, sheets_.welded_to[mesh_.corners[at_a[end]]], own});
      } else if (const auto links = links_.find(joined_.first(own)); links != links_.end()) {
        links->second.push_back(
            {{own, other}, is_sector ? edge_ : kNone, {{a.corner, b.corner}, {side_of_a, side_of_b}, Vec3d(0.0)}});
      }
    }
  }

  bool agree(const Leaf& a, const Leaf& b) const {
    return (a.forwards != sheets_.is_turned(a.face)) != (b.forwards != sheets_.is_turned(b.face));
  }

  void join_two(Leaf a, Leaf b) {
    const bool opposite = a.forwards != b.forwards;
    if (agree(a, b)) {
      for (std::uint8_t side = 0; side < 2; ++side) join(a, side, b, opposite ? side : 1 - side);
      return;
    }
    std::vector<Leaf> leaves = {a, b};
    join_sectors(leaves);
  }

  void join_around(std::uint32_t smaller, std::span<const EdgeSide> sides) {
    std::vector<Leaf> leaves, repeats;
    for (const EdgeSide& side : sides) {
      const Leaf leaf = leaf_of(smaller, side);
      (sheets_.repeats[leaf.face] ? repeats : leaves).push_back(leaf);
    }
    if (leaves.empty()) std::swap(leaves, repeats);
    if (leaves.size() == 1) leave_open({{leaves[0].corner, leaves[0].corner}, {0, 1}, Vec3d(0.0)});
    else if (leaves.size() == 2) join_two(leaves[0], leaves[1]);
    else join_sectors(leaves);
    for (const Leaf& repeat : repeats) follow(repeat, leaves);
  }

  /// Joins the sides of a repeated face to those of the face that it repeats.
  void follow(const Leaf& repeat, const std::vector<Leaf>& leaves) {
    const auto vertices = [&](const Leaf& leaf) {
      std::vector<std::uint32_t> all;
      for (const auto v : mesh_.face(leaf.face)) all.push_back(sheets_.welded_to[v]);
      std::sort(all.begin(), all.end());
      return all;
    };
    const auto own = vertices(repeat);
    for (const Leaf& leaf : leaves)
      if (vertices(leaf) == own)
        for (std::uint8_t side = 0; side < 2; ++side)
          return join(repeat, 0, leaf, repeat.forwards == leaf.forwards ? 0 : 1),
                 join(repeat, 1, leaf, repeat.forwards == leaf.forwards ? 1 : 0);
  }

  void sort_by_angle(std::vector<Leaf>& leaves) const {
    const auto [p, q] = ends(leaves[0]);
    Vec3d axis = mesh_.positions[mesh_.corners[q]] - mesh_.positions[mesh_.corners[p]];
    axis.normalize();
    for (Leaf& leaf : leaves) {
      leaf.into = area_vector(mesh_, leaf.face).cross(leaf.forwards ? axis : -axis);
      leaf.into.normalize();
      leaf.angle = std::atan2(axis.dot(leaves[0].into.cross(leaf.into)), leaves[0].into.dot(leaf.into));
      if (leaf.angle < 0) leaf.angle += 2 * std::numbers::pi;
    }
    std::stable_sort(leaves.begin() + 1, leaves.end(), [](const Leaf& a, const Leaf& b) { return a.angle < b.angle; });
  }

  void join_sectors(std::vector<Leaf>& leaves) {
    sort_by_angle(leaves);
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      const bool last = i + 1 == leaves.size();
      const Leaf &a = leaves[i], &b = leaves[last ? 0 : i + 1];
      const double sector = b.angle - a.angle + (last ? 2 * std::numbers::pi : 0);
      const std::uint8_t side_of_a = a.next_side(), side_of_b = b.previous_side();
      const std::optional<Vec3d> step =
          std::abs(sector - std::numbers::pi) < kOneLevel ? find_step(a, side_of_a, b, side_of_b) : std::nullopt;
      if (step) leave_open({{a.corner, b.corner}, {side_of_a, side_of_b}, *step});
      else join(a, side_of_a, b, side_of_b, leaves.size() > 2);
    }
  }

  /// Half of the difference in height of two sides on one plane, as a vector from the thicker sheet to the thinner;
  /// none if they have one height.
  std::optional<Vec3d> find_step(const Leaf& a, std::uint8_t side_of_a, const Leaf& b, std::uint8_t side_of_b) const {
    double difference = 0;
    const auto at_a = ends(a), at_b = ends(b);
    for (std::size_t end = 0; end < 2; ++end)
      difference += (sheets_.thickness_on(a.face, side_of_a, mesh_.corners[at_a[end]]) -
                     sheets_.thickness_on(b.face, side_of_b, mesh_.corners[at_b[end]])) /
                    2;
    if (difference == 0) return std::nullopt;
    return difference > 0 ? b.into * (difference / 2) : a.into * (-difference / 2);
  }

  void number_wedges() {
    constexpr std::uint32_t kUnnumbered = kNone;
    std::vector<std::uint32_t> number(2 * mesh_.corners.size(), kUnnumbered);
    found_.wedge.resize(number.size());
    for (std::uint32_t i = 0; i < number.size(); ++i) {
      std::uint32_t& own = number[joined_.first(i)];
      if (own == kUnnumbered) own = static_cast<std::uint32_t>(found_.wedges++);
      found_.wedge[i] = own;
    }
  }

  const Sheets& sheets_;
  PolygonView mesh_;
  DisjointSets joined_;
  std::vector<std::uint32_t> face_of_;  // of each corner
  std::uint32_t edge_ = 0;              // number of the edge that is being looked at
  std::vector<Sector> sectors_;
  bool is_joined_ = false;
  std::map<std::uint32_t, std::vector<WedgeLink>> links_;  // by wedge, of wedges that come by an edge twice
  std::set<std::pair<std::uint32_t, std::uint8_t>> cut_;   // first corners and sides of the gaps of cuts
  SheetSides found_;
};

/// The sheets around one vertex of a surface.
class VertexSheets {
 public:
  VertexSheets(const Surface& surface, std::uint32_t vertex)
      : surface_(surface), around_(surface.triangles_around(vertex)), vertex_(vertex) {}

  bool is_junction() const {
    DisjointSets fans(around_.size());
    for (std::uint32_t i = 0; i < around_.size(); ++i)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t h = 3 * around_[i] + k;
        if (surface_.from(h) != vertex_ && surface_.to(h) != vertex_) continue;
        const std::uint32_t other = surface_.next_around_edge[h];
        if (other == h) continue;
        const bool two = surface_.next_around_edge[other] == h;
        if (two ? surface_.from(other) == surface_.from(h) : branches(h)) return true;
        fans.join(i, static_cast<std::uint32_t>(std::lower_bound(around_.begin(), around_.end(), other / 3) -
                                                around_.begin()));
      }
    for (std::uint32_t i = 1; i < around_.size(); ++i)
      if (fans.first(i) != 0) return true;
    return false;
  }

 private:
  /// Whether the faces at an edge all leave it in different directions.
  bool branches(std::uint32_t half_edge) const {
    const Vec3d& a = surface_.vertices[surface_.from(half_edge)];
    Vec3d axis = surface_.vertices[surface_.to(half_edge)] - a;
    if (!(axis.lengthSqr() > 0)) return false;
    axis.normalize();
    std::vector<Vec3d> directions;
    std::uint32_t h = half_edge;
    do {
      Vec3d into = surface_.vertices[surface_.triangles[h / 3][(h % 3 + 2) % 3]] - a;
      into -= axis * into.dot(axis);
      if (!(into.lengthSqr() > 0)) return false;
      directions.push_back(into.unit());
      h = surface_.next_around_edge[h];
    } while (h != half_edge);
    for (std::size_t i = 0; i < directions.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if ((directions[i] - directions[j]).lengthSqr() < kOnEachOther * kOnEachOther) return false;
    return true;
  }

  const Surface& surface_;
  std::span<const std::uint32_t> around_;
  std::uint32_t vertex_;
};

}  // namespace

SheetSides find_sides(const Sheets& sheets) {
  VDB_OFFSET_ASSERT(sheets.welded_to.size() == sheets.mesh.positions.size());
  VDB_OFFSET_ASSERT(sheets.turned.size() == sheets.mesh.face_count());
  VDB_OFFSET_ASSERT(sheets.repeats.size() == sheets.mesh.face_count());
  return SideFinder(sheets).find();
}

namespace {

/// Takes the marks off vertices of faces that the surface leaves out.
void leave_out_repeats(const Surface& surface, PolygonView mesh, std::span<const std::uint8_t> only,
                       std::vector<std::uint8_t>& junctions) {
  if (surface.facts.repeated_faces + surface.facts.folded_triangles == 0) return;
  std::vector<std::uint8_t> is_there(mesh.face_count(), 0);
  for (const auto f : surface.face) is_there[f] = 1;
  std::size_t of_surface = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    if (!only.empty() && !only[f]) continue;
    if (is_there[of_surface++]) continue;
    for (const auto v : mesh.face(f)) junctions[surface.welded[v]] = 0;
  }
}

}  // namespace

std::vector<std::uint8_t> find_junctions(const Surface& surface, PolygonView mesh, std::span<const std::uint8_t> only) {
  VDB_OFFSET_ASSERT(only.empty() || only.size() == mesh.face_count());
  std::vector<std::uint8_t> found(surface.vertices.size(), 0);
  for_each_index(found.size(),
                 [&](std::size_t v) { found[v] = VertexSheets(surface, static_cast<std::uint32_t>(v)).is_junction(); });
  leave_out_repeats(surface, mesh, only, found);
  if (std::find(found.begin(), found.end(), 1) == found.end()) found.clear();
  return found;
}

}  // namespace vdb_offset
