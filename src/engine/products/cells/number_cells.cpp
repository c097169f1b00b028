// SPDX-License-Identifier: Apache-2.0
// Numbers the points and cells over layers before any is made. Faces that are polygons by position carry a column, or
// two where growing has split a quad; columns that repeat an earlier one, or have no height at any corner, go, and
// those on the other side are turned round. The sides of columns at each edge are paired, forwards with backwards. A
// side without a partner is on the boundary; where that is no border, the position is split, and fans that are joined
// over paired sides keep one point each. Over opened edges several stacks share a point of the wall. Points of the wall
// come first, then those that rise, layer by layer, then those in the middle of cells beside fans. Counting the cells
// of each column gives all their numbers. No position is changed here. Numbers follow the order of faces and
// vertices, and do not depend on the number of threads.
#include "products/cells/number_cells.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "ground/mesh/repeated_faces.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/cells/side_match.h"
#include "products/layers/fan_splits.h"
#include "space/surface/weld.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

/// The vertex that stands for one in columns: the first that it moves with; of flat ones the first on their point of
/// the wall.
Index stands_for(const LayersResult& layers, std::span<const std::uint8_t> flat, Index v) {
  const Index first = layers.welded_to[v];
  return !layers.foot.empty() && flat[first] != 0 ? layers.foot[first] : first;
}

/// The positions of a face's corners without those that repeat the one before. Returns false if they are no polygon.
bool clean_ring(std::span<const Index> face, const LayersResult& layers, std::span<const std::uint8_t> flat,
                std::vector<Index>& ring, std::vector<Index>& sorted) {
  ring.clear();
  for (const Index v : face)
    if (const Index w = stands_for(layers, flat, v); ring.empty() || ring.back() != w) ring.push_back(w);
  while (ring.size() > 1 && ring.back() == ring.front()) ring.pop_back();
  if (ring.size() <= 3) return ring.size() == 3;  // neighbours differ, and all three are neighbours
  sorted.assign(ring.begin(), ring.end());
  std::sort(sorted.begin(), sorted.end());
  return ring.size() > 2 && std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
}

/// Whether some corners of a column share a point of the wall.
bool is_over_ridge(const LayersResult& layers, std::span<const Index> ring) {
  if (layers.foot.empty()) return false;
  Index last = layers.foot[ring.back()];
  return std::any_of(ring.begin(), ring.end(), [&](Index v) { return std::exchange(last, layers.foot[v]) == last; });
}

/// The side of a face that its first layer lies on: above 0 if its normal points there. Farther layers may have turned
/// their backs to the wall. Faces over ridges have no area there, and are seen in the first layer.
double rises(const LayersResult& layers, std::span<const Index> ring) {
  const auto at = [&](Index v, std::size_t layer) -> const Vec3d& { return layers.stacks.of(v)[layer]; };
  const std::size_t seen = is_over_ridge(layers, ring) ? 1 : 0;
  Vec3d normal(0.0), rise(0.0);
  for (std::size_t k = 2; k < ring.size(); ++k)
    normal += (at(ring[k - 1], seen) - at(ring[0], seen)).cross(at(ring[k], seen) - at(ring[0], seen));
  for (const Index v : ring) rise += at(v, 1) - at(v, 0);
  return normal.dot(rise);
}

/// The corner at which the diagonal of a quad with two columns starts; kNone for other faces.
Index split_from(const LayersResult& layers, std::size_t f, std::size_t corners) {
  return !layers.carries.empty() && layers.carries[f] > 1 && corners == 4 ? layers.carries[f] - 2u : kNone;
}

/// Makes columns on the faces that are polygons, and notes down the roles of faces.
NumberedColumns find_polygons(PolygonView mesh, const LayersResult& layers, std::span<const std::uint8_t> flat,
                              LayerCellFacts& facts) {
  // Of each face the numbers of its columns and corners, then the sums of those before it.
  std::vector<Index> columns_before(mesh.face_count() + 1, 0), corners_before(mesh.face_count() + 1, 0);
  const auto visit_rings = [&](auto&& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.face_count(), 1024), [&](const auto& range) {
      std::vector<Index> ring, sorted;
      for (std::size_t f = range.begin(); f != range.end(); ++f)
        if (layers.carries.empty() || layers.carries[f] != 0)
          visit(f, ring, clean_ring(mesh.face(f), layers, flat, ring, sorted));
    });
  };
  visit_rings([&](std::size_t f, const std::vector<Index>& ring, bool is_polygon) {
    facts.role[f] = is_polygon ? FaceRole::Full : FaceRole::Degenerate;
    if (!is_polygon) return;
    const bool split = split_from(layers, f, ring.size()) != kNone;
    columns_before[f + 1] = split ? 2 : 1;
    corners_before[f + 1] = split ? 6 : static_cast<Index>(ring.size());
  });
  std::partial_sum(columns_before.begin(), columns_before.end(), columns_before.begin());
  std::partial_sum(corners_before.begin(), corners_before.end(), corners_before.begin());
  NumberedColumns columns;
  columns.corners.resize(corners_before.back());
  columns.begin.assign(columns_before.back() + std::size_t{1}, 0);
  columns.face.resize(columns_before.back());
  visit_rings([&](std::size_t f, const std::vector<Index>& ring, bool is_polygon) {
    if (!is_polygon) return;
    const auto to = columns.corners.begin() + corners_before[f];
    const Index from = split_from(layers, f, ring.size()), first = columns_before[f];
    columns.face[first] = static_cast<Index>(f);
    columns.begin[columns_before[f + 1]] = corners_before[f + 1];
    if (from == kNone) {
      std::copy(ring.begin(), ring.end(), to);
      return;
    }
    for (Index i = 0; i < 6; ++i) to[i] = ring[(from + (i < 3 ? i : i - 1)) % 4];
    columns.face[first + 1] = static_cast<Index>(f);
    columns.begin[first + 1] = corners_before[f] + 3;
  });
  return columns;
}

/// What becomes of a column.
struct ColumnRole {
  FaceRole role;
  bool turned;  // it lies on the side opposite to the sign of the heights
};
std::vector<ColumnRole> find_roles(const LayersResult& layers, std::span<const std::uint8_t> flat, bool inward,
                                   const NumberedColumns& columns) {
  // Columns ahead whose stacks, which are far apart in memory, are prefetched. For speed alone; not measured.
  constexpr std::size_t kAhead = 8;
  std::vector<std::uint8_t> repeated(columns.count(), 0);
  if (!layers.known.paired)
    for (const RepeatedFace& each : find_repeated_faces(columns.corners, columns.begin)) repeated[each.face] = 1;
  const bool none_turned = layers.known.none_turned;
  std::vector<ColumnRole> roles(columns.count());
  for_each_index(columns.count(), [&](std::size_t c) {
    const auto ring = columns.ring(c);
    for (const Index v : columns.ring(std::min(c + kAhead, columns.count() - 1))) {
      if (none_turned) break;
      const Vec3d* const stack = layers.stacks.of(v).data();
      __builtin_prefetch(stack), __builtin_prefetch(stack + 1);
    }
    const auto flats =
        static_cast<std::size_t>(std::count_if(ring.begin(), ring.end(), [&](Index v) { return flat[v] != 0; }));
    const FaceRole role = repeated[c] != 0       ? FaceRole::Repeated
                          : flats == ring.size() ? FaceRole::Flat
                          : flats > 0            ? FaceRole::Transition
                                                 : FaceRole::Full;
    const bool unknown = !none_turned && role != FaceRole::Repeated && role != FaceRole::Flat;
    const double side = unknown ? rises(layers, ring) : 0;
    roles[c] = {role, side != 0 && (side < 0) != inward};
  });
  return roles;
}

/// Removes columns without cells, and turns those on the other side round. Returns false if any was turned.
bool keep_columns(const LayersResult& layers, std::span<const std::uint8_t> flat, NumberedColumns& columns,
                  LayerCellFacts& facts) {
  const bool inward = layers.count() > 0 && layers.heights.back().farthest() < 0;
  const std::vector<ColumnRole> roles = find_roles(layers, flat, inward, columns);
  std::size_t kept = 0;
  bool none_turned = true;
  Index end = 0, last_face = kNone;
  for (std::size_t c = 0, begin = 0; c < roles.size(); ++c) {
    const auto ring = std::span(columns.corners).subspan(begin, columns.begin[c + 1] - begin);
    begin = columns.begin[c + 1];
    const Index face = columns.face[c];
    const auto [role, turned] = roles[c];
    // If the roles of a split quad's two columns differ, layers end in the quad.
    const bool second = face == last_face;
    last_face = face;
    FaceRole& of_face = facts.role[face];
    of_face = second && of_face != role ? FaceRole::Transition : role;
    if (role == FaceRole::Repeated || role == FaceRole::Flat) continue;
    none_turned = none_turned && !turned;
    facts.turned_faces += turned && !second;
    if (turned != inward) std::reverse(ring.begin() + 1, ring.end());
    std::copy(ring.begin(), ring.end(), columns.corners.begin() + end);
    end += static_cast<Index>(ring.size());
    columns.face[kept++] = face;
    columns.begin[kept] = end;
  }
  columns.face.resize(kept);
  columns.begin.resize(kept + 1);
  columns.corners.resize(end);
  return none_turned;
}

/// Makes the columns of faces over which layers rise, on the side where they do, with the first vertex at each corner's
/// position, and notes down the roles of all faces.
/// \param flat of each vertex: 1 if it rises in no layer
/// \param all_paired becomes true if each side that rises is known to have one partner; sides of flat faces do not rise
NumberedColumns find_columns(PolygonView mesh, const LayersResult& layers, std::span<const std::uint8_t> flat,
                             LayerCellFacts& facts, bool& all_paired) {
  NumberedColumns columns = find_polygons(mesh, layers, flat, facts);
  const bool none_turned = keep_columns(layers, flat, columns, facts);
  all_paired = none_turned && layers.known.paired &&
               std::none_of(facts.role.begin(), facts.role.end(),
                            [](FaceRole role) { return role == FaceRole::Bare || role == FaceRole::Degenerate; });
  return columns;
}

/// Puts the stacks first that have a point of the wall of their own, and notes down which ones the others share.
void share_points(std::span<const Index> foot, NumberedColumns& columns, LayerPoints& points) {
  std::vector<Index> first(foot.size(), kNone), shares(points.stacks(), kNone), order, number(points.stacks());
  for (Index p = 0; p < points.stacks(); ++p) {
    Index& of_foot = first[foot[points.vertex[p]]];
    // A vertex that several fans of columns meet at is not opened: each has a point of its own.
    if (of_foot == kNone || points.vertex[of_foot] == points.vertex[p]) of_foot = p;
    else shares[p] = of_foot;
  }
  for (const bool own : {true, false})
    for (Index p = 0; p < points.stacks(); ++p)
      if ((shares[p] == kNone) == own) number[p] = static_cast<Index>(order.size()), order.push_back(p);
  std::vector<Index> vertex;
  vertex.reserve(order.size());
  for (const Index p : order) {
    vertex.push_back(points.vertex[p]);
    if (shares[p] != kNone) points.shared.push_back(number[shares[p]]);
  }
  points.vertex = std::move(vertex);
  for (Index& corner : columns.corners) corner = number[corner];
}

/// Numbers the points, of which sides without a partner get some of their own, makes the corners of columns stacks
/// instead of vertices, and marks the open sides of columns.
LayerPoints number_points(std::span<const std::uint8_t> flat, std::span<const Index> foot, bool all_paired,
                          NumberedColumns& columns, LayerCellFacts& facts) {
  columns.open.assign(columns.corners.size(), 0);
  std::optional<SideMatch> sides;
  if (!all_paired) sides.emplace(flat.size(), flat, columns, facts);
  LayerPoints points;
  std::vector<Index> of_vertex(flat.size(), kNone);
  for_each_index(columns.corners.size(), [&](std::size_t c) {
    std::atomic_ref(of_vertex[columns.corners[c]]).store(0, std::memory_order_relaxed);
  });
  for (std::size_t v = 0; v < flat.size(); ++v)
    if (of_vertex[v] != kNone) {
      of_vertex[v] = points.stacks();
      points.vertex.push_back(static_cast<Index>(v));
    }
  std::vector<Index> point(columns.corners.size());
  for_each_index(point.size(), [&](std::size_t c) { point[c] = of_vertex[columns.corners[c]]; });
  if (sides && sides->has_unpaired()) {
    DisjointSets fans = sides->join_fans();
    facts.coincident_sides = sides->count_coincident(fans);
    std::vector<std::uint8_t> taken(flat.size(), 0);
    for (Index c = 0; c < point.size(); ++c) {
      const Index vertex = columns.corners[c], first = fans.first(c);
      if (!sides->crowded(vertex)) continue;
      if (first != c) {
        point[c] = point[first];
      } else if (taken[vertex] != 0) {
        point[c] = points.stacks();
        points.vertex.push_back(vertex);
        ++facts.split_points;
      }
      taken[vertex] = 1;
    }
  }
  columns.corners = std::move(point);
  if (!foot.empty()) share_points(foot, columns, points);
  points.in_layer.assign(points.stacks(), kNone);
  for (Index p = 0; p < points.stacks(); ++p)
    if (flat[points.vertex[p]] == 0) {
      points.in_layer[p] = points.risen();
      points.rising.push_back(p);
    }
  return points;
}

std::vector<std::uint8_t> find_flat(const SharedStacks& stacks) {
  std::vector<std::uint8_t> flat(stacks.vertices());
  for_each_index(flat.size(), [&](std::size_t v) {
    const auto stack = stacks.of(v);
    flat[v] = std::all_of(stack.begin(), stack.end(), [&](const Vec3d& x) { return x == stack[0]; });
  });
  return flat;
}

/// Counts the cells of each column in a layer, and their corners, and so numbers them.
CellNumbers count_cells(const LayerPoints& points, const NumberedColumns& columns, std::size_t layer) {
  CellNumbers numbers;
  numbers.cells.assign(columns.count() + 1, 0);
  numbers.size.assign(columns.count() + 1, 0);
  for_each_index(columns.count(), [&](std::size_t c) {
    columns.column(points, c, layer)
        .visit_cells([&](CellType) { ++numbers.cells[c + 1]; }, [&](Index) { ++numbers.size[c + 1]; });
  });
  std::partial_sum(numbers.cells.begin(), numbers.cells.end(), numbers.cells.begin());
  std::partial_sum(numbers.size.begin(), numbers.size.end(), numbers.size.begin());
  return numbers;
}

std::vector<std::uint8_t> cells_of_faces(const NumberedColumns& columns, const CellNumbers& numbers,
                                         std::size_t faces) {
  std::vector<std::uint8_t> cells(faces, 0);
  for (std::size_t c = 0; c < columns.count(); ++c)
    cells[columns.face[c]] =
        static_cast<std::uint8_t>(cells[columns.face[c]] + numbers.cells[c + 1] - numbers.cells[c]);
  return cells;
}

/// Finds the columns whose first cell has a point in its middle, beside fans that end.
void find_middles(LayerCells& cells) {
  NumberedColumns& columns = cells.columns;
  columns.splits = find_splits(
      columns.corners, columns.begin, [&](Index stack) { return cells.points.foot(stack); },
      [&](Index stack) { return cells.points.flat(stack); });
  if (columns.splits.empty()) return;
  columns.middle.assign(columns.count(), kNone);
  for (std::size_t c = 0; c < columns.count(); ++c)
    if (columns.column(cells.points, c, 0).has_middle())
      columns.middle[c] = static_cast<Index>(cells.risen_points() + cells.middles++);
}

void require_countable(const LayerCells& cells) {
  const auto countable = [](std::uint64_t points, std::uint64_t in_all) {
    if (points >= kNone || in_all >= kNone)
      throw InvalidInput("layer_cells: expected fewer than 2^32 points and cells, got " + std::to_string(points) +
                         " and " + std::to_string(in_all) + " (ask for fewer layers)");
  };
  countable(cells.point_count(), cells.count());
}

}  // namespace

void require_layers_of(PolygonView mesh, const LayersResult& layers) {
  const auto require = [](const char* what, std::size_t expected, std::size_t got) {
    if (got != expected)
      throw InvalidInput("layers: expected " + std::to_string(expected) + " " + what + ", got " + std::to_string(got));
  };
  require("layers in a stack", layers.count(), layers.stacks.layers());
  require("stacks", mesh.positions.size(), layers.stacks.vertices());
  require("welded vertices", mesh.positions.size(), layers.welded_to.size());
  require("shares", mesh.positions.size(), layers.share.size());
  require("states", mesh.positions.size(), layers.states.size());
  require("distances achieved", mesh.positions.size(), layers.achieved.size());
  require("distances of the first layer", mesh.positions.size(), layers.first_achieved.size());
  for (const Distances& heights : layers.heights)
    if (!heights.uniform()) require("heights", mesh.positions.size(), heights.count());
  if (!layers.carries.empty()) require("marks of faces", mesh.face_count(), layers.carries.size());
  require_usable(mesh, 1);
  const auto is_welded = [&](Index v) {
    return v < layers.welded_to.size() && layers.welded_to[v] < layers.welded_to.size();
  };
  const auto all = [](std::size_t count, auto&& holds) {
    std::atomic<bool> found = true;
    for_each_index(count, [&](std::size_t i) {
      if (!holds(i)) found.store(false, std::memory_order_relaxed);
    });
    return found.load();
  };
  // Checking vertices is faster, as they are in order; only vertices of faces need a position.
  if (!all(layers.welded_to.size(), [&](std::size_t v) { return is_welded(static_cast<Index>(v)); }) &&
      !all(mesh.corners.size(), [&](std::size_t c) { return is_welded(mesh.corners[c]); }))
    throw InvalidInput("layers: expected layers of this mesh, got some that lack welded vertices of its corners");
}

const char* name(FaceRole role) {
  constexpr const char* kNames[kFaceRoleCount] = {"bare", "full", "transition", "flat", "degenerate", "repeated"};
  return kNames[static_cast<std::size_t>(role)];
}

bool LayerCells::is_of_prisms(std::size_t column) const {
  // A triangle's cells have six corners in all only if none of its corners is flat.
  return columns.is_first_alike() && columns.ring(column).size() == 3 &&
         columns.upper.size[column + 1] - columns.upper.size[column] == 6;
}

LayerCells number_cells(PolygonView mesh, const LayersResult& layers) {
  require_layers_of(mesh, layers);
  LayerCells cells;
  cells.layers = layers.count();
  cells.facts.role.assign(mesh.face_count(), FaceRole::Bare);
  const std::vector<std::uint8_t> flat = find_flat(layers.stacks);
  bool all_paired = false;
  cells.columns = find_columns(mesh, layers, flat, cells.facts, all_paired);
  cells.points = number_points(flat, layers.foot, all_paired, cells.columns, cells.facts);
  VDB_OFFSET_ASSERT(std::is_sorted(cells.columns.begin.begin(), cells.columns.begin.end()));
  VDB_OFFSET_ASSERT(std::all_of(cells.columns.corners.begin(), cells.columns.corners.end(),
                                [&](Index p) { return p < cells.points.stacks(); }));
  NumberedColumns& columns = cells.columns;
  if (!layers.foot.empty()) find_middles(cells);
  columns.upper = count_cells(cells.points, columns, 1);
  cells.facts.cells = cells_of_faces(columns, columns.upper, mesh.face_count());
  if (!layers.foot.empty()) {
    columns.first = count_cells(cells.points, columns, 0);
    cells.facts.first_cells = cells_of_faces(columns, columns.first, mesh.face_count());
  }
  require_countable(cells);
  return cells;
}

}  // namespace vdb_offset
