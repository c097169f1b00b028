// SPDX-License-Identifier: Apache-2.0
// Decides which columns of cells stand on the faces of a wall, and whether their cells are valid. A face with an area
// carries one column, over its positions; a quad with a corner that is straight or turns inwards carries two, split so
// that the smaller triangle is as large as it can be. A column of prisms is valid if at each corner the edge up leans
// towards the normals below and above it, if the Jacobian, a quadratic polynomial along that edge, stays above 0, and
// if the volume is positive; two columns are judged at once in vector lanes. Any other column has to rise at its
// corners, too, and its cells are made and measured as for the report. With CellRules::OpenFoam the pyramids of
// OpenFOAM count as well. Positions are judged as they are: nothing is moved or thinned here.
#include "products/layers/growth_columns.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <optional>
#include <utility>

#include "ground/numbers/double_lanes.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/layers/column_mesh.h"
#include "products/layers/fan_splits.h"
#include "products/layers/rails.h"
#include "products/volume/cell_quality.h"
#include "products/volume/foam_measures.h"

namespace vdb_offset {
namespace {

// The number of corners from which on the cell on a face is a polyhedron, whose faces need not be convex: all types of
// cells that formats have end at four.
constexpr std::size_t kPolyhedron = 5;

/// Whether b is the corner after a in a polygon, of which the first follows the last.
bool follows(std::span<const std::uint32_t> polygon, std::uint32_t a, std::uint32_t b) {
  for (std::size_t k = 0; k < polygon.size(); ++k)
    if (polygon[k] == a && polygon[(k + 1) % polygon.size()] == b) return true;
  return false;
}

/// Whether a vector makes less than a right angle with a normal, by kLeastLean.
bool leans(const Vec3d& way, const Vec3d& n) {
  const double dot = n.dot(way);
  return dot > 0 && dot * dot > kLeastLean * kLeastLean * n.lengthSqr() * way.lengthSqr();
}

/// Whether the vectors from the layer below and to the layer above lean towards a normal.
bool rises(std::span<const Vec3d> stack, std::size_t layer, const Vec3d& n) {
  return (layer == 0 || leans(stack[layer] - stack[layer - 1], n)) &&
         (layer + 1 == stack.size() || leans(stack[layer + 1] - stack[layer], n));
}

/// Whether the principal axes of all hexahedra over a quad make a right-handed frame: a bent one may be inside out in
/// its middle although it is not at any corner.
bool has_upright_hexahedra(std::span<const std::uint32_t> corners, const VertexStacks& stacks, int side) {
  for (std::size_t layer = 0; layer < stacks.layers(); ++layer) {
    Vec3d middle[4], up(0.0);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto stack = stacks.of(corners[k]);
      middle[k] = stack[layer] + stack[layer + 1];
      up += stack[layer + 1] - stack[layer];
    }
    const Vec3d n =
        (middle[1] - middle[0] + middle[2] - middle[3]).cross(middle[3] - middle[0] + middle[2] - middle[1]);
    if (!leans(up, n * side)) return false;
  }
  return true;
}

/// The triangles of two columns in a layer, and their normals.
struct TwoTriangles {
  TwoTriangles(const std::array<std::span<const std::uint32_t>, 2>& base, const VertexStacks& stacks,
               std::size_t layer) {
    for (std::size_t k = 0; k < 3; ++k) corner[k] = both(stacks.of(base[0][k])[layer], stacks.of(base[1][k])[layer]);
    normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    square = normal.dot(normal);
  }
  std::array<Vec3Of<double2>, 3> corner;
  Vec3Of<double2> normal;
  double2 square;  // of the normal
};

/// The corners of two triangles in the order of their vertices' numbers, and the signs that their normals then have.
struct TwoOrders {
  TwoOrders(const std::array<std::span<const std::uint32_t>, 2>& base, std::span<const std::uint32_t> welded_to) {
    for (std::size_t i = 0; i < 2; ++i) {
      auto& [p, q, r] = by_number[i];
      p = base[i][0], q = base[i][1], r = base[i][2];
      if (welded_to[p] > welded_to[q]) std::swap(p, q), sign[i] = -sign[i];
      if (welded_to[q] > welded_to[r]) std::swap(q, r), sign[i] = -sign[i];
      if (welded_to[p] > welded_to[q]) std::swap(p, q), sign[i] = -sign[i];
    }
  }
  Vec3Of<double2> at(const VertexStacks& stacks, std::size_t k, std::size_t layer) const {
    return both(stacks.of(by_number[0][k])[layer], stacks.of(by_number[1][k])[layer]);
  }
  std::array<std::array<std::uint32_t, 3>, 2> by_number;
  double2 sign{1, 1};
};

/// Whether prisms have volumes above 0 if their sides are split in two triangles as cell_volume() does it: from the
/// lower corner of the lower number to the upper corner of the higher number. Of the three tetrahedra, two stand on the
/// triangles.
PairMask have_volume(const TwoOrders& order, const VertexStacks& stacks, std::size_t layer, const double2& sign,
                     const Vec3Of<double2>& below, const Vec3Of<double2>& above) {
  const Vec3Of<double2> p = order.at(stacks, 0, layer), upper_p = order.at(stacks, 0, layer + 1);
  const Vec3Of<double2> r = order.at(stacks, 2, layer), upper_r = order.at(stacks, 2, layer + 1);
  const Vec3Of<double2> q = order.at(stacks, 1, layer) - p, upper_q = order.at(stacks, 1, layer + 1) - p;
  const double2 on_triangles = below.dot(upper_r - r) + above.dot(upper_p - p);
  return sign * on_triangles + sign * order.sign * q.cross(upper_r - p).dot(upper_q) > 0.0;
}

/// Whether no prism of two columns is inside out anywhere. In each, the edges up from the corners lean towards the
/// normals of both triangles (see leans()), and between, at height t, the Jacobian is above 0 as well. Along an edge up
/// it is a (1 - t)^2 + (a + c - d) t (1 - t) + c t^2, where a and c are the edge's products with the normals, and d is
/// the triple product of all three edges.
std::array<bool, 2> are_upright(const std::array<std::span<const std::uint32_t>, 2>& base, const VertexStacks& stacks,
                                std::span<const std::uint32_t> welded_to, int side) {
  const double2 sign = double2{} + static_cast<double>(side);
  const TwoOrders order(base, welded_to);
  PairMask upright{-1, -1};
  TwoTriangles below(base, stacks, 0);
  for (std::size_t layer = 0; layer < stacks.layers() && (upright[0] != 0 || upright[1] != 0); ++layer) {
    const TwoTriangles above(base, stacks, layer + 1);
    const Vec3Of<double2> up[] = {above.corner[0] - below.corner[0], above.corner[1] - below.corner[1],
                                  above.corner[2] - below.corner[2]};
    const double2 triple = up[0].cross(up[1]).dot(up[2]) * sign;
    for (const Vec3Of<double2>& way : up) {
      const double2 square = way.dot(way);
      const double2 a = below.normal.dot(way) * sign, c = above.normal.dot(way) * sign;
      upright &= (a > 0.0) & (a * a > kLeastLean * kLeastLean * below.square * square);
      upright &= (c > 0.0) & (c * c > kLeastLean * kLeastLean * above.square * square);
      const double2 over = triple - a - c;
      upright &= (over <= 0.0) | (over * over < 4.0 * a * c);
    }
    upright &= have_volume(order, stacks, layer, sign, below.normal, above.normal);
    below = above;
  }
  return {upright[0] != 0, upright[1] != 0};
}

/// Makes the splits of a ring's sides those of the ring that runs the other way, from the same corner.
void turn_round(std::vector<SideSplit>& splits) {
  std::reverse(splits.begin(), splits.end());
  for (SideSplit& split : splits)
    if (split != SideSplit::None) split = split == SideSplit::UpToNext ? SideSplit::DownToNext : SideSplit::UpToNext;
}

/// Twice the area of triangle abc, as n sees it.
double area_along(const Vec3d& n, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return (b - a).cross(c - a).dot(n);
}

/// The corner, 0 or 1, from which a quad is to be split into two triangles: one of its corners is straight or turns
/// inwards, so that no hexahedron over it can be valid. None for other quads, and where no diagonal gives two
/// triangles.
std::optional<std::size_t> corner_to_split_at(const std::array<Vec3d, 4>& x) {
  // The least sine of the angle by which a corner has to turn: below 1.1 degrees, a hexahedron's Jacobian there is
  // below 0.02, and two prisms are better. Not measured.
  constexpr double kStraight = 0.02;
  const Vec3d n = (x[2] - x[0]).cross(x[3] - x[1]);
  bool convex = true;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3d in = x[k] - x[(k + 3) % 4], out = x[(k + 1) % 4] - x[k];
    const double turn = in.cross(out).dot(n), ahead = in.dot(out) > 0 ? kStraight : 0;
    convex = convex && turn > ahead * in.length() * out.length() * n.length();
  }
  if (convex) return std::nullopt;
  double smaller[2];
  for (std::size_t a = 0; a < 2; ++a)
    smaller[a] = std::min(area_along(n, x[a], x[a + 1], x[a + 2]), area_along(n, x[a + 2], x[(a + 3) % 4], x[a]));
  const std::size_t best = smaller[1] > smaller[0] ? 1 : 0;
  return smaller[best] > 0 ? std::optional(best) : std::nullopt;
}

}  // namespace

GrowthColumns::GrowthColumns(PolygonView mesh, const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                             CellRules rules, std::span<const std::uint32_t> foot)
    : rules_(rules), first_vertex_(constrained.surface.vertices.size(), kNone) {
  VDB_OFFSET_ASSERT(source.size() == constrained.surface.vertices.size());
  VDB_OFFSET_ASSERT(constrained.surface.welded.size() == mesh.positions.size());
  for (auto v = static_cast<std::uint32_t>(constrained.surface.welded.size()); v-- > 0;)
    if (constrained.surface.welded[v] != kNone) first_vertex_[constrained.surface.welded[v]] = v;
  if (!take_all(mesh, constrained, source)) take_some(mesh, constrained, source);
  if (!foot.empty()) find_fans(foot);
}

/// Makes columns on the faces that carry some.
void GrowthColumns::take_some(PolygonView mesh, const ConstrainedSurface& constrained, std::span<const Vec3d> source) {
  const Surface& surface = constrained.surface;
  constexpr std::uint8_t kWithoutArea = 1, kCarries = 2;
  std::vector<std::uint8_t> seen(mesh.face_count(), 0);
  corners_.reserve(mesh.corners.size());
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const std::uint32_t face = surface.face[t];
    if (!constrained.triangle_on_part(t) || seen[face] == kCarries) continue;
    const auto& [a, b, c] = surface.triangles[t];
    seen[face] = (source[b] - source[a]).cross(source[c] - source[a]).lengthSqr() > 0 ? kCarries : kWithoutArea;
    if (seen[face] == kCarries) add(mesh, surface, t, source);
  }
  for (std::uint32_t f = 0; f < seen.size(); ++f)
    if (seen[f] == kWithoutArea) without_area_.push_back(f);
  incident_begin_.assign(source.size() + 2, 0);
  for (const auto v : corners_) ++incident_begin_[v + 2];
  std::partial_sum(incident_begin_.begin(), incident_begin_.end(), incident_begin_.begin());
  incident_.resize(corners_.size());
  for (std::uint32_t column = 0; column < size(); ++column)
    for (const auto v : base(column)) incident_[incident_begin_[v + 1]++] = column;
}

/// Finds the columns over opened edges and beside the ends of fans, whose first cells are of other types.
void GrowthColumns::find_fans(std::span<const std::uint32_t> foot) {
  foot_.assign(first_vertex_.size(), kNone);
  for (std::size_t v = 0; v < foot_.size(); ++v)
    if (first_vertex_[v] != kNone) foot_[v] = foot[first_vertex_[v]];
  splits_ = find_splits(
      corners_, begin_, [&](std::uint32_t v) { return foot_[v]; }, [](std::uint32_t) { return false; });
  at_fan_.assign(size(), 0);
  opened_.assign(foot_.size(), 0);
  for (std::size_t c = 0; c < size(); ++c) {
    const auto ring = base(c);
    for (std::size_t k = 0; k < ring.size(); ++k)
      if (const std::uint32_t v = ring[k], w = ring[(k + 1) % ring.size()]; foot_[v] == foot_[w])
        at_fan_[c] = opened_[v] = opened_[w] = 1;
      else if (!splits_.empty() && splits_[begin_[c] + k] != SideSplit::None) at_fan_[c] = 1;
  }
}

/// Takes the surface's triangles as the columns, if all faces of the mesh are triangles with an area: the usual case.
/// Returns false if they are not.
bool GrowthColumns::take_all(PolygonView mesh, const ConstrainedSurface& constrained, std::span<const Vec3d> source) {
  const Surface& surface = constrained.surface;
  if (!constrained.off_part.empty() || mesh.corners.size() != 3 * mesh.face_count()) return false;
  std::atomic<bool> all = true;
  corners_.resize(3 * surface.triangles.size());
  begin_.resize(surface.triangles.size() + 1);
  for_each_index(surface.triangles.size(), [&](std::size_t t) {
    const auto& [a, b, c] = surface.triangles[t];
    if (!((source[b] - source[a]).cross(source[c] - source[a]).lengthSqr() > 0)) all = false;
    std::copy_n(surface.triangles[t].begin(), 3, corners_.begin() + static_cast<std::ptrdiff_t>(3 * t));
    begin_[t + 1] = static_cast<std::uint32_t>(3 * (t + 1));
  });
  if (!all) {
    corners_.clear();
    begin_.assign(1, 0);
    return false;
  }
  incident_ = surface.incident;
  incident_begin_ = surface.incident_begin;
  return true;
}

/// Adds the column on a face, or two on a quad that has to be split.
/// \param triangle one of the face's, with an area
void GrowthColumns::add(PolygonView mesh, const Surface& surface, std::uint32_t triangle,
                        std::span<const Vec3d> source) {
  const auto& [a, b, c] = surface.triangles[triangle];
  std::vector<std::uint32_t> polygon;
  for (const auto v : mesh.face(surface.face[triangle])) {
    const std::uint32_t w = surface.welded[v];
    if (polygon.empty() || polygon.back() != w) polygon.push_back(w);
  }
  while (polygon.size() > 1 && polygon.back() == polygon.front()) polygon.pop_back();
  VDB_OFFSET_ASSERT(polygon.size() > 2);
  // At least one side of a triangle is a side of its polygon, and shows whether the triangle runs as the polygon does.
  const bool turned = follows(polygon, b, a) || follows(polygon, c, b) || follows(polygon, a, c);
  const auto take = [&](std::vector<std::uint32_t> base) {
    if (turned) std::reverse(base.begin(), base.end());
    corners_.insert(corners_.end(), base.begin(), base.end());
    begin_.push_back(static_cast<std::uint32_t>(corners_.size()));
  };
  std::optional<std::size_t> split;
  if (polygon.size() == 4)
    split = corner_to_split_at({source[polygon[0]], source[polygon[1]], source[polygon[2]], source[polygon[3]]});
  if (!split) return take(std::move(polygon));
  const auto corner = [&](std::size_t k) { return polygon[(*split + k) % 4]; };
  take({corner(0), corner(1), corner(2)});
  take({corner(2), corner(3), corner(0)});
  split_quads_.push_back({surface.face[triangle], static_cast<std::uint32_t>(*split)});
}

Vec3d GrowthColumns::normal(std::size_t column, std::size_t k, const VertexStacks& stacks, std::size_t layer) const {
  const auto corners = base(column);
  const std::size_t count = corners.size();
  const auto at = [&](std::size_t i) { return stacks.of(corners[i % count])[layer]; };
  if (count < kPolyhedron) return (at(k + 1) - at(k)).cross(at(k + count - 1) - at(k));
  Vec3d sum(0.0);
  for (std::size_t i = 1; i + 1 < count; ++i) sum += (at(i) - at(0)).cross(at(i + 1) - at(0));
  return sum;
}

bool GrowthColumns::is_valid(std::size_t column, const VertexStacks& stacks, int side) const {
  VDB_OFFSET_ASSERT(column < size() && (side == 1 || side == -1));
  if (is_of_prisms(column, stacks))
    return are_upright({base(column), base(column)}, stacks, first_vertex_, side)[0] &&
           (rules_ != CellRules::OpenFoam || has_valid_cells(column, stacks, side));
  return rises_everywhere(column, stacks, side) && has_valid_cells(column, stacks, side);
}

/// Whether the edges up from each corner lean towards the normals of the faces below and above it.
bool GrowthColumns::rises_everywhere(std::size_t column, const VertexStacks& stacks, int side) const {
  const auto corners = base(column);
  const std::size_t count = corners.size();
  const bool has_flat = std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return stacks.is_flat(v); });
  if (count == 4 && !has_flat && !has_upright_hexahedra(corners, stacks, side)) return false;
  for (std::size_t layer = 0; layer <= stacks.layers(); ++layer) {
    Vec3d n = normal(column, 0, stacks, layer);
    for (std::size_t k = 0; k < count; ++k) {
      if (k > 0 && count == 4) n = normal(column, k, stacks, layer);
      // A quad with flat corners becomes cells that see it as triangles, split in one way or the other.
      const bool as_triangles = has_flat && count == 4;
      for (const std::size_t i : {k, (k + 1) % count, (k + count - 1) % count}) {
        if (i != k && !as_triangles) break;
        if (!stacks.is_flat(corners[i]) && !rises(stacks.of(corners[i]), layer, n * side)) return false;
      }
    }
  }
  return true;
}

/// The splits of a column's sides, as its ring runs, but for those of what is flat, beside which no fan ends.
void GrowthColumns::find_splits_of(std::size_t column, std::span<const std::uint32_t> ring, const VertexStacks& stacks,
                                   int side, std::vector<SideSplit>& splits) const {
  if (splits_.empty()) return;
  splits.assign(splits_.begin() + begin_[column], splits_.begin() + begin_[column + 1]);
  if (side < 0) turn_round(splits);
  for (std::size_t k = 0; k < ring.size(); ++k)
    if (stacks.is_flat(ring[k]) || stacks.is_flat(ring[(k + 1) % ring.size()])) splits[k] = SideSplit::None;
}

/// Whether the column's cells will pass the quality measures that are reported for them.
bool GrowthColumns::has_valid_cells(std::size_t column, const VertexStacks& stacks, int side) const {
  thread_local ColumnMesh cells;
  thread_local std::vector<std::uint32_t> ring, numbers, feet;
  thread_local std::vector<SideSplit> splits;
  ring.assign(base(column).begin(), base(column).end());
  if (side < 0) std::reverse(ring.begin() + 1, ring.end());
  const auto flat = [&](std::uint32_t v) { return stacks.is_flat(v); };
  if (is_at_fan(column)) {  // flat corners on one point of the wall are one
    const auto are_one = [&](std::uint32_t v, std::uint32_t w) { return flat(v) && flat(w) && foot_[v] == foot_[w]; };
    ring.erase(std::unique(ring.begin(), ring.end(), are_one), ring.end());
    while (ring.size() > 1 && are_one(ring.front(), ring.back())) ring.pop_back();
  }
  if (ring.size() < 3 || std::all_of(ring.begin(), ring.end(), flat)) return true;  // there are none
  numbers.clear();
  for (const std::uint32_t v : ring) numbers.push_back(first_vertex_[v]);
  feet.clear(), splits.clear();
  if (is_at_fan(column)) {
    for (const std::uint32_t v : ring) feet.push_back(foot_[v]);
    if (ring.size() == base(column).size()) find_splits_of(column, ring, stacks, side, splits);
  }
  cells.begin({numbers, feet, splits}, [&](std::size_t k) { return flat(ring[k]); });
  for (std::size_t layer = 0; layer < stacks.layers(); ++layer) {
    const VolumeMesh& mesh = cells.at(layer, [&](std::size_t k) { return stacks.of(ring[k]); });
    for (std::size_t c = 0; c < mesh.cell_count(); ++c)
      if (!(scaled_jacobian(mesh, c) > 0) || !(cell_volume(mesh, c) > 0) ||
          (rules_ == CellRules::OpenFoam && !has_foam_pyramids(mesh, c)))
        return false;
  }
  return true;
}

bool GrowthColumns::is_of_prisms(std::size_t column, const VertexStacks& stacks) const {
  const auto corners = base(column);
  return corners.size() == 3 && !is_at_fan(column) &&
         std::none_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return stacks.is_flat(v); });
}

std::array<bool, 2> GrowthColumns::are_valid(std::size_t column, std::size_t other, const VertexStacks& stacks,
                                             int side) const {
  if (rules_ == CellRules::OpenFoam || !is_of_prisms(column, stacks) || !is_of_prisms(other, stacks))
    return {is_valid(column, stacks, side), is_valid(other, stacks, side)};
  return are_upright({base(column), base(other)}, stacks, first_vertex_, side);
}

}  // namespace vdb_offset
