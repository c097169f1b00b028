#include "vdb_offset/layer_columns.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_offset/edge_sides.h"
#include "vdb_offset/parallel.h"
#include "vdb_offset/repeated_faces.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

/// The face's places without those that repeat the one before. False if these are no polygon.
bool clean_ring(std::span<const Index> face, std::span<const Index> place, std::vector<Index>& ring,
                std::vector<Index>& sorted) {
  ring.clear();
  for (const Index v : face)
    if (ring.empty() || ring.back() != place[v]) ring.push_back(place[v]);
  while (ring.size() > 1 && ring.back() == ring.front()) ring.pop_back();
  sorted.assign(ring.begin(), ring.end());
  std::sort(sorted.begin(), sorted.end());
  return ring.size() > 2 && std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
}

/// On which side of a face its first layer lies: above 0 if its normal points there. Farther out, a face may have
/// turned its back to where it came from.
double rises(const LayersResult& layers, std::span<const Index> ring) {
  const std::vector<Vec3d>&wall = layers.positions[0], &first = layers.positions[1];
  Vec3d normal(0.0), rise(0.0);
  for (std::size_t k = 2; k < ring.size(); ++k)
    normal += (wall[ring[k - 1]] - wall[ring[0]]).cross(wall[ring[k]] - wall[ring[0]]);
  for (const Index v : ring) rise += first[v] - wall[v];
  return normal.dot(rise);
}

/// Faces that are polygons; facts know what became of the others.
LayerColumns find_polygons(PolygonView mesh, const LayersResult& layers, std::span<const Index> place,
                           LayerCellFacts& facts) {
  LayerColumns columns;
  columns.corners.reserve(mesh.corners.size());
  columns.begin.reserve(mesh.face_count() + 1);
  columns.face.reserve(mesh.face_count());
  std::vector<Index> ring, sorted;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    if (!layers.carries.empty() && layers.carries[f] == 0) continue;
    if (!clean_ring(mesh.face(f), place, ring, sorted)) {
      facts.role[f] = FaceRole::Degenerate;
      continue;
    }
    facts.role[f] = FaceRole::Full;
    const bool split = !layers.carries.empty() && layers.carries[f] > 1 && ring.size() == 4;
    const auto add = [&](std::initializer_list<std::size_t> places) {
      for (const std::size_t k : places) columns.corners.push_back(ring[k % 4]);
    };
    const auto close = [&] {
      columns.begin.push_back(static_cast<Index>(columns.corners.size()));
      columns.face.push_back(static_cast<Index>(f));
    };
    if (split) {
      const std::size_t from = layers.carries[f] - 2u;
      add({from, from + 1, from + 2});
      close();
      add({from + 2, from + 3, from});
    } else {
      columns.corners.insert(columns.corners.end(), ring.begin(), ring.end());
    }
    close();
  }
  return columns;
}

/// Leaves out what gives no cell, and turns what lies on the other side.
void keep_columns(const LayersResult& layers, std::span<const std::uint8_t> flat, LayerColumns& columns,
                  LayerCellFacts& facts) {
  const bool inward = layers.count() > 0 && layers.heights.back().farthest() < 0;
  const std::vector<std::uint8_t> repeated = find_repeated_faces(columns.corners, columns.begin);
  const std::vector<Index> face = columns.face;
  std::size_t kept = 0;
  Index end = 0, last_face = kNone;
  for (std::size_t c = 0, begin = 0; c < face.size(); ++c) {
    const auto ring = std::span(columns.corners).subspan(begin, columns.begin[c + 1] - begin);
    begin = columns.begin[c + 1];
    const auto flats =
        static_cast<std::size_t>(std::count_if(ring.begin(), ring.end(), [&](Index v) { return flat[v] != 0; }));
    const FaceRole role = repeated[c] != 0       ? FaceRole::Repeated
                          : flats == ring.size() ? FaceRole::Flat
                          : flats > 0            ? FaceRole::Transition
                                                 : FaceRole::Full;
    // The second of a split quad's columns: where they differ, layers end in it.
    const bool second = face[c] == last_face;
    last_face = face[c];
    FaceRole& of_face = facts.role[face[c]];
    of_face = second && of_face != role ? FaceRole::Transition : role;
    if (role == FaceRole::Repeated || role == FaceRole::Flat) continue;
    const double side = rises(layers, ring);
    const bool turned = side != 0 && (side < 0) != inward;
    facts.turned_faces += turned && !second;
    if (turned != inward) std::reverse(ring.begin() + 1, ring.end());
    std::copy(ring.begin(), ring.end(), columns.corners.begin() + end);
    end += static_cast<Index>(ring.size());
    columns.face[kept++] = face[c];
    columns.begin[kept] = end;
  }
  columns.face.resize(kept);
  columns.begin.resize(kept + 1);
  columns.corners.resize(end);
}

/// Corners at one point of the wall, where some places have several.
class CornerSets {
 public:
  explicit CornerSets(std::size_t corners) : parent_(corners) {
    for (std::size_t c = 0; c < corners; ++c) parent_[c] = static_cast<Index>(c);
  }
  Index first(Index corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void join(Index a, Index b) {
    a = first(a), b = first(b);
    (a < b ? parent_[b] : parent_[a]) = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

/// Two sides of opposite directions, by the corners at which they start.
struct SidePair {
  Index forwards, backwards;
};

/// Calls pair(SidePair) for sides of an edge that belong together, the first with the first, and left(corner) for
/// those that stay single. `sides` are sorted by corner.
template <class Pair, class Left>
void pair_sides(std::span<const EdgeSide> sides, std::span<const Index> corners, Index smaller, Pair&& pair,
                Left&& left) {
  const auto seek = [&](std::size_t from, bool forwards) {
    while (from < sides.size() && (corners[sides[from].corner] == smaller) != forwards) ++from;
    return from;
  };
  std::size_t f = seek(0, true), b = seek(0, false);
  for (; f < sides.size() && b < sides.size(); f = seek(f + 1, true), b = seek(b + 1, false))
    pair(SidePair{sides[f].corner, sides[b].corner});
  for (; f < sides.size(); f = seek(f + 1, true)) left(sides[f].corner);
  for (; b < sides.size(); b = seek(b + 1, false)) left(sides[b].corner);
}

/// Finds the sides on the boundary, and the places that have a side too many.
class SideMatch {
 public:
  SideMatch(std::size_t vertices, std::span<const std::uint8_t> flat, LayerColumns& columns, LayerCellFacts& facts)
      : columns_(columns), flat_(flat), places_(vertices), crowded_(vertices, 0) {
    for (std::size_t v = 0; v < vertices; ++v) places_[v] = static_cast<Index>(v);
    columns.open.assign(columns.corners.size(), 0);
    for_edges([&](Index a, Index b, std::span<const EdgeSide> sides) {
      pair_sides(
          sides, columns_.corners, a, [](SidePair) {},
          [&](Index corner) {
            columns_.open[corner] = 1;
            ++(sides.size() == 1 ? facts.border_sides : facts.unpaired_sides);
            if (sides.size() > 1) crowded_[a] = crowded_[b] = 1;
          });
    });
  }
  bool crowded(Index place) const { return crowded_[place] != 0; }

  /// The corners at crowded places that paired sides join.
  CornerSets join_fans() const {
    CornerSets sets(columns_.corners.size());
    for_edges([&](Index a, Index b, std::span<const EdgeSide> sides) {
      if (!crowded(a) && !crowded(b)) return;
      pair_sides(
          sides, columns_.corners, a,
          [&](SidePair pair) {
            sets.join(pair.forwards, next(pair.backwards));
            sets.join(next(pair.forwards), pair.backwards);
          },
          [](Index) {});
    });
    return sets;
  }

  /// Unpaired sides that have the points of other ones. \pre none of them is a border.
  std::size_t count_coincident(CornerSets& sets) const {
    std::size_t count = 0;
    for_edges([&](Index a, Index, std::span<const EdgeSide> sides) {
      const auto ends = [&](Index corner) {
        std::pair at(sets.first(corner), sets.first(next(corner)));
        return columns_.corners[corner] == a ? at : std::pair(at.second, at.first);
      };
      for (const EdgeSide& side : sides)
        if (columns_.open[side.corner] != 0 && sides.size() > 1)
          count += std::count_if(sides.begin(), sides.end(),
                                 [&](const EdgeSide& other) { return ends(other.corner) == ends(side.corner); }) > 1;
    });
    return count;
  }

 private:
  template <class Visit>
  void for_edges(Visit&& visit) const {
    visit_edges({{}, columns_.corners, columns_.begin}, places_, [&](Index smaller, std::span<const EdgeSide> sides) {
      const Index larger = sides[0].larger_end;
      if (flat_[smaller] == 0 || flat_[larger] == 0) visit(smaller, larger, sides);
    });
  }
  Index next(Index corner) const {
    const auto column = std::upper_bound(columns_.begin.begin(), columns_.begin.end(), corner) - 1;
    return columns_.next(static_cast<std::size_t>(column - columns_.begin.begin()), corner);
  }

  LayerColumns& columns_;
  std::span<const std::uint8_t> flat_;
  std::vector<Index> places_;
  std::vector<std::uint8_t> crowded_;
};

}  // namespace

LayerColumns find_columns(PolygonView mesh, const LayersResult& layers, std::span<const Index> place,
                          std::span<const std::uint8_t> flat, LayerCellFacts& facts) {
  LayerColumns columns = find_polygons(mesh, layers, place, facts);
  keep_columns(layers, flat, columns, facts);
  return columns;
}

LayerPoints number_points(std::span<const std::uint8_t> flat, LayerColumns& columns, LayerCellFacts& facts) {
  const SideMatch sides(flat.size(), flat, columns, facts);
  LayerPoints points;
  std::vector<Index> of_place(flat.size(), kNone);
  for (const Index place : columns.corners) of_place[place] = 0;
  for (std::size_t v = 0; v < flat.size(); ++v)
    if (of_place[v] != kNone) {
      of_place[v] = points.wall();
      points.vertex.push_back(static_cast<Index>(v));
    }
  std::vector<Index> point(columns.corners.size());
  for_each_index(point.size(), [&](std::size_t c) { point[c] = of_place[columns.corners[c]]; });
  if (facts.unpaired_sides > 0) {
    CornerSets fans = sides.join_fans();
    facts.coincident_sides = sides.count_coincident(fans);
    std::vector<std::uint8_t> taken(flat.size(), 0);
    for (Index c = 0; c < point.size(); ++c) {
      const Index place = columns.corners[c], first = fans.first(c);
      if (!sides.crowded(place)) continue;
      if (first != c) {
        point[c] = point[first];
      } else if (taken[place] != 0) {
        point[c] = points.wall();
        points.vertex.push_back(place);
        ++facts.split_points;
      }
      taken[place] = 1;
    }
  }
  columns.corners = std::move(point);
  points.in_layer.assign(points.wall(), kNone);
  for (Index p = 0; p < points.wall(); ++p)
    if (flat[points.vertex[p]] == 0) points.in_layer[p] = points.risen++;
  return points;
}

}  // namespace vdb_offset
