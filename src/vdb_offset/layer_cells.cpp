#include "vdb_offset/layer_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "vdb_offset/cell_quality.h"
#include "vdb_offset/edge_sides.h"
#include "vdb_offset/error.h"
#include "vdb_offset/parallel.h"
#include "vdb_offset/repeated_faces.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

/// The faces that carry cells, which run so that their normals point into the layers.
struct Columns {
  std::vector<Index> corners;  // places, by a vertex that stands there; later points of the wall
  std::vector<Index> begin{0};
  std::vector<Index> face;          // of the input
  std::vector<std::uint8_t> open;   // of each corner: 1 if the side from it to the next one is on the boundary
  std::vector<Index> cells;         // of a layer, before each column; one more than columns
  std::vector<std::uint64_t> size;  // the same of the cells' corners

  std::size_t count() const { return face.size(); }
  std::span<const Index> ring(std::size_t c) const {
    return std::span(corners).subspan(begin[c], begin[c + 1] - begin[c]);
  }
  Index next(std::size_t c, Index corner) const { return corner + 1 < begin[c + 1] ? corner + 1 : begin[c]; }
};

/// The points: 0 .. wall() - 1 on the wall, and `risen` in each layer above it.
struct Numbering {
  std::vector<Index> vertex;    // of the mesh, of each point of the wall
  std::vector<Index> in_layer;  // of each point of the wall: its number among those that rise; kNone for flat ones
  Index risen = 0;

  Index wall() const { return static_cast<Index>(vertex.size()); }
  bool flat(Index point) const { return in_layer[point] == kNone; }
  Index at(Index point, std::size_t layer) const {
    return layer == 0 || flat(point) ? point : wall() + static_cast<Index>(layer - 1) * risen + in_layer[point];
  }
};

void require_layers_of(PolygonView mesh, const LayersResult& layers, const WallNames& names) {
  const auto require = [](const char* what, std::size_t expected, std::size_t got) {
    if (got != expected)
      throw InvalidInput("layer_cells: expected " + std::to_string(expected) + " " + what + ", got " +
                         std::to_string(got));
  };
  require("surfaces, one more than heights", layers.count() + 1, layers.positions.size());
  for (const auto& positions : layers.positions)
    require("positions in each layer", mesh.positions.size(), positions.size());
  require("shares", mesh.positions.size(), layers.share.size());
  require("states", mesh.positions.size(), layers.states.size());
  require("distances achieved", mesh.positions.size(), layers.achieved.size());
  require("distances of the first layer", mesh.positions.size(), layers.first_achieved.size());
  for (const Distances& heights : layers.heights)
    if (!heights.uniform()) require("heights", mesh.positions.size(), heights.count());
  if (!layers.carries.empty()) require("marks of faces", mesh.face_count(), layers.carries.size());
  if (names.of_face.empty()) return;
  require("names of faces", mesh.face_count(), names.of_face.size());
  for (const Index name : names.of_face)
    if (name >= names.names.size())
      throw InvalidInput("layer_cells: expected names below " + std::to_string(names.names.size()) + ", got " +
                         std::to_string(name));
}

std::vector<std::uint8_t> find_flat(const LayersResult& layers) {
  std::vector<std::uint8_t> flat(layers.positions[0].size());
  for_each_index(flat.size(), [&](std::size_t v) {
    flat[v] = std::all_of(layers.positions.begin() + 1, layers.positions.end(),
                          [&](const auto& positions) { return positions[v] == layers.positions[0][v]; });
  });
  return flat;
}

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
Columns find_polygons(PolygonView mesh, const LayersResult& layers, std::span<const Index> place,
                      LayerCellFacts& facts) {
  Columns columns;
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
void keep_columns(const LayersResult& layers, std::span<const std::uint8_t> flat, Columns& columns,
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
  SideMatch(std::size_t vertices, std::span<const std::uint8_t> flat, Columns& columns, LayerCellFacts& facts)
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

  Columns& columns_;
  std::span<const std::uint8_t> flat_;
  std::vector<Index> places_;
  std::vector<std::uint8_t> crowded_;
};

/// Numbers the points, and replaces the columns' places by those of the wall.
Numbering number_points(std::span<const std::uint8_t> flat, const SideMatch& sides, Columns& columns,
                        LayerCellFacts& facts) {
  Numbering points;
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

/// The cells of one column in one layer. Corners are numbered around the face, and go on with 0.
class Stack {
 public:
  Stack(const Numbering& points, std::span<const Index> ring, std::size_t layer)
      : points_(points), ring_(ring), n_(static_cast<Index>(ring.size())), layer_(layer), apex_(find_apex()) {}

  Index corner(Index k) const {
    while (k >= n_) k -= n_;
    return ring_[k];
  }
  Index below(Index k) const { return points_.at(corner(k), layer_); }
  Index above(Index k) const { return points_.at(corner(k), layer_ + 1); }
  bool flat(Index k) const { return points_.flat(corner(k)); }

  /// Calls begin(CellType) for each cell, then add(corner) for each of its corners.
  template <class Begin, class Add>
  void visit_cells(Begin&& begin, Add&& add) const {
    if (n_ > 4) {
      begin(CellType::Polyhedron);
      visit_polyhedron(add);
    } else if (has_apex()) {
      for (Index k = apex_ + 1; k < apex_ + n_ - 1; ++k) visit_cone(k, begin, add);
    } else if (const Index first = first_flat(); first < n_) {
      begin(CellType::Prism);
      for (const Index k : {first, first + 1}) {
        const Index far = k == first ? first + 3 : first + 2;
        add(below(k)), add(below(far)), add(above(far));
      }
    } else {
      begin(n_ == 3 ? CellType::Prism : CellType::Hexahedron);
      for (Index k = 0; k < n_; ++k) add(below(k));
      for (Index k = 0; k < n_; ++k) add(above(k));
    }
  }

  /// Calls visit(corners, cell) for each face of the column's cells below or above: of the first, second ... of them.
  template <class Visit>
  void visit_below(std::vector<Index>& face, Visit&& visit) const {
    visit_cap([&](Index k) { return below(k); }, face,
              [&](Index cell) {
                std::reverse(face.begin() + 1, face.end());
                visit(face, cell);
              });
  }
  template <class Visit>
  void visit_above(std::vector<Index>& face, Visit&& visit) const {
    visit_cap([&](Index k) { return above(k); }, face, [&](Index cell) { visit(face, cell); });
  }

  /// The face on the side from corner k to the next, seen from outside; returns its number of corners, which is 0 if
  /// both are flat.
  Index side(Index k, std::array<Index, 4>& face) const {
    Index size = 0;
    face[size++] = below(k), face[size++] = below(k + 1);
    if (!flat(k + 1)) face[size++] = above(k + 1);
    if (!flat(k)) face[size++] = above(k);
    return size < 3 ? 0 : size;
  }
  /// The cell that has that face.
  Index cell_at_side(Index k) const {
    if (!has_apex()) return 0;
    const Index from_apex = (k + n_ - apex_) % n_;
    return std::min(from_apex == 0 ? 0 : from_apex - 1, n_ - 3);
  }

 private:
  bool has_apex() const { return apex_ < n_; }
  Index first_flat() const {
    Index k = 0;
    while (k < n_ && !flat(k)) ++k;
    // In a row around the end, the last one is the first.
    return k == 0 && flat(0) && flat(n_ - 1) ? n_ - 1 : k;
  }
  /// A flat corner from which cones over the sides that do not hold it fill the column: in a quad not one of two in
  /// a row, which need no cone, and of three in a row the middle one, from where the cones cover the whole wall.
  Index find_apex() const {
    for (Index k = 0; n_ < 5 && k < n_; ++k)
      if (flat(k) && (n_ == 3 || flat(k + 1) == flat(k + n_ - 1))) return k;
    return n_;
  }

  /// The base is the side, seen from inside.
  template <class Begin, class Add>
  void visit_cone(Index k, Begin& begin, Add& add) const {
    std::array<Index, 4> base;
    const Index size = side(k, base);
    begin(size == 4 ? CellType::Pyramid : CellType::Tetrahedron);
    add(base[0]);
    for (Index i = size - 1; i > 0; --i) add(base[i]);
    add(below(apex_));
  }

  template <class Add>
  void visit_polyhedron(Add& add) const {
    std::array<Index, 4> face;
    Index sides = 0;
    for (Index k = 0; k < n_; ++k) sides += side(k, face) > 0;
    add(sides + 2);
    add(n_);
    for (Index k = 0; k < n_; ++k) add(below(n_ - k));
    add(n_);
    for (Index k = 0; k < n_; ++k) add(above(k));
    for (Index k = 0; k < n_; ++k) {
      const Index size = side(k, face);
      if (size > 0) add(size);
      for (Index i = 0; i < size; ++i) add(face[i]);
    }
  }

  template <class Point, class Visit>
  void visit_cap(Point&& point, std::vector<Index>& face, Visit&& visit) const {
    if (!has_apex()) {
      face.clear();
      for (Index k = 0; k < n_; ++k) face.push_back(point(k));
      visit(0);
      return;
    }
    for (Index k = apex_ + 1; k < apex_ + n_ - 1; ++k) {
      face.assign({point(apex_), point(k), point(k + 1)});
      visit(k - apex_ - 1);
    }
  }

  const Numbering& points_;
  std::span<const Index> ring_;
  Index n_;
  std::size_t layer_;
  Index apex_;
};

/// Counts what a layer has, and so where each column's cells are.
void count_cells(const Numbering& points, Columns& columns, LayerCellFacts& facts) {
  columns.cells.assign(columns.count() + 1, 0);
  columns.size.assign(columns.count() + 1, 0);
  for_each_index(columns.count(), [&](std::size_t c) {
    Stack(points, columns.ring(c), 0)
        .visit_cells([&](CellType) { ++columns.cells[c + 1]; }, [&](Index) { ++columns.size[c + 1]; });
  });
  for (std::size_t c = 0; c < columns.count(); ++c)
    facts.cells[columns.face[c]] = static_cast<std::uint8_t>(facts.cells[columns.face[c]] + columns.cells[c + 1]);
  std::partial_sum(columns.cells.begin(), columns.cells.end(), columns.cells.begin());
  std::partial_sum(columns.size.begin(), columns.size.end(), columns.size.begin());
}

void require_countable(const Numbering& points, const Columns& columns, std::size_t layers) {
  const std::uint64_t all_points = points.wall() + std::uint64_t{points.risen} * layers;
  const std::uint64_t all_cells = std::uint64_t{columns.cells.back()} * layers;
  if (all_points >= kNone || all_cells >= kNone)
    throw InvalidInput("layer_cells: expected fewer than 2^32 points and cells, got " + std::to_string(all_points) +
                       " and " + std::to_string(all_cells) + " (ask for fewer layers)");
}

/// The distance of a layer's vertex: as measured at the lowest and the outermost, what its share asks for between.
double achieved(const LayersResult& layers, std::size_t layer, Index v) {
  if (layer == 0) return 0;
  if (layer == layers.count()) return layers.achieved[v];
  return layer == 1 ? layers.first_achieved[v] : layers.share[v] * std::abs(layers.heights[layer - 1][v]);
}

void place_points(const LayersResult& layers, const Numbering& points, VolumeMesh& volume) {
  const std::size_t count = points.wall() + std::size_t{points.risen} * layers.count();
  volume.points.resize(count);
  volume.point_fields = {{"layer", {}}, {"share", {}}, {"height", {}}, {"achieved", {}}, {"state", {}}};
  for (VolumeField& field : volume.point_fields) field.values.resize(count);
  for (std::size_t layer = 0; layer <= layers.count(); ++layer)
    for_each_index(points.wall(), [&](std::size_t p) {
      if (layer > 0 && points.flat(static_cast<Index>(p))) return;
      const Index at = points.at(static_cast<Index>(p), layer), v = points.vertex[p];
      volume.points[at] = layers.positions[layer][v];
      const double height = layer > 0 ? layers.heights[layer - 1][v] : 0;
      const double values[] = {static_cast<double>(layer), layers.share[v], height, achieved(layers, layer, v),
                               static_cast<double>(layers.states[v])};
      for (std::size_t i = 0; i < std::size(values); ++i)
        volume.point_fields[i].values[at] = static_cast<float>(values[i]);
    });
}

void fill_cells(const Numbering& points, const Columns& columns, const WallNames& names, std::size_t layers,
                VolumeMesh& volume) {
  const std::size_t cells = columns.cells.back();
  const std::uint64_t size = columns.size.back();
  volume.cell_types.resize(cells * layers);
  volume.corners.resize(size * layers);
  volume.cell_begin.resize(cells * layers + 1);
  volume.cell_fields = {{"layer", {}}, {"face", {}}, {"patch", {}}};
  for (VolumeField& field : volume.cell_fields) field.values.resize(cells * layers);
  for (std::size_t layer = 0; layer < layers; ++layer)
    for_each_index(columns.count(), [&](std::size_t c) {
      std::size_t cell = layer * cells + columns.cells[c];
      std::uint64_t at = layer * size + columns.size[c];
      const Index face = columns.face[c];
      const float values[] = {static_cast<float>(layer + 1), static_cast<float>(face),
                              names.of_face.empty() ? 0.0F : static_cast<float>(names.of_face[face])};
      Stack(points, columns.ring(c), layer)
          .visit_cells(
              [&](CellType type) {
                for (std::size_t i = 0; i < std::size(values); ++i) volume.cell_fields[i].values[cell] = values[i];
                volume.cell_begin[cell] = at;
                volume.cell_types[cell++] = type;
              },
              [&](Index corner) { volume.corners[at++] = corner; });
    });
  volume.cell_begin.back() = size * layers;
}

void add_face(std::span<const Index> face, std::size_t cell, VolumePatch& patch) {
  patch.corners.insert(patch.corners.end(), face.begin(), face.end());
  patch.face_begin.push_back(static_cast<Index>(patch.corners.size()));
  patch.cell.push_back(static_cast<Index>(cell));
}

void add_walls(const Numbering& points, const Columns& columns, const WallNames& names, VolumeMesh& volume) {
  for (const std::string& name : patch_names(names)) volume.patches.emplace_back().name = name;
  std::vector<Index> scratch;
  for (std::size_t c = 0; c < columns.count(); ++c) {
    VolumePatch& patch = volume.patches[names.of_face.empty() ? 0 : names.of_face[columns.face[c]]];
    Stack(points, columns.ring(c), 0).visit_below(scratch, [&](std::span<const Index> face, Index cell) {
      add_face(face, columns.cells[c] + cell, patch);
    });
  }
}

void add_outer(const Numbering& points, const Columns& columns, std::size_t layers, VolumeMesh& volume) {
  VolumePatch& patch = volume.patches.emplace_back();
  patch.name = "outer";
  patch.kind = VolumePatch::Kind::Outer;
  patch.corners.reserve(columns.corners.size());
  patch.face_begin.reserve(columns.cells.back() + 1);
  patch.cell.reserve(columns.cells.back());
  const std::size_t below = (layers - 1) * columns.cells.back();
  std::vector<Index> scratch;
  for (std::size_t c = 0; c < columns.count(); ++c)
    Stack(points, columns.ring(c), layers - 1).visit_above(scratch, [&](std::span<const Index> face, Index cell) {
      add_face(face, below + columns.cells[c] + cell, patch);
    });
}

void add_sides(const Numbering& points, const Columns& columns, std::size_t layers, VolumeMesh& volume) {
  VolumePatch patch;
  patch.name = "sides";
  patch.kind = VolumePatch::Kind::Side;
  for (std::size_t layer = 0; layer < layers; ++layer)
    for (std::size_t c = 0; c < columns.count(); ++c)
      for (Index k = 0; k < columns.ring(c).size(); ++k) {
        if (columns.open[columns.begin[c] + k] == 0) continue;
        const Stack stack(points, columns.ring(c), layer);
        std::array<Index, 4> face;
        const Index size = stack.side(k, face);
        add_face(std::span(face).first(size), layer * columns.cells.back() + columns.cells[c] + stack.cell_at_side(k),
                 patch);
      }
  if (patch.face_count() > 0) volume.patches.push_back(std::move(patch));
}

}  // namespace

const char* name(FaceRole role) {
  constexpr const char* kNames[kFaceRoleCount] = {"bare", "full", "transition", "flat", "degenerate", "repeated"};
  return kNames[static_cast<std::size_t>(role)];
}

VolumeMesh make_cells(PolygonView mesh, const LayersResult& layers, const WeldOptions& weld, const WallNames& names,
                      LayerCellFacts* facts_out) {
  require_layers_of(mesh, layers, names);
  const std::vector<Index> place = weld_by_position(mesh, weld);
  LayerCellFacts facts;
  facts.role.assign(mesh.face_count(), FaceRole::Bare);
  facts.cells.assign(mesh.face_count(), 0);
  const std::vector<std::uint8_t> flat = find_flat(layers);
  Columns columns = find_polygons(mesh, layers, place, facts);
  keep_columns(layers, flat, columns, facts);
  const Numbering points = number_points(flat, SideMatch(mesh.positions.size(), flat, columns, facts), columns, facts);
  count_cells(points, columns, facts);
  require_countable(points, columns, layers.count());

  VolumeMesh volume;
  place_points(layers, points, volume);
  fill_cells(points, columns, names, layers.count(), volume);
  if (layers.count() > 0) {
    add_walls(points, columns, names, volume);
    add_outer(points, columns, layers.count(), volume);
    add_sides(points, columns, layers.count(), volume);
  }
  for (VolumeField& field : quality_fields(volume)) volume.cell_fields.push_back(std::move(field));
  if (facts_out != nullptr) *facts_out = std::move(facts);
  return volume;
}

}  // namespace vdb_offset
