// SPDX-License-Identifier: Apache-2.0
// Finds where the corners of wedges belong near junctions of sheets. Dijkstra's algorithm measures how far each wedge
// is from a junction, along edges and in thicknesses. A wedge within reach, or anywhere on a flat sheet that ends at a
// junction, goes by the shortest displacement to the least-squares point of its sides' planes, each moved by its
// thickness, and no farther than four thicknesses. The displacements of junctions and of creases on such sheets spread
// over the sheets around by Gauss-Seidel relaxation; of what arrives, a wedge takes the part along its own planes, and
// at the border that along the border. The weight of a position falls to 0 with the distance from the junction. Faults
// are not looked for here.
#include "products/shell/wedge_positions.h"

#include <openvdb/math/Mat3.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "ground/mesh/edge_sides.h"
#include "ground/mesh/triangulate.h"
#include "ground/system/assert.h"

namespace vdb_offset {
namespace {

// The longest miter, in thicknesses: sheets at less than 29 degrees get a blunt corner instead of a long spike. Not
// measured.
constexpr double kLongestMiter = 4;
// The distance from a junction, in thicknesses, within which vertices make room for it: beyond the longest miter, with
// some room to fade out. Not measured.
constexpr double kRoom = 6;
// The distance from a junction, in thicknesses, within which vertices are entirely on the planes of their faces; from
// there to kRoom they fade to where the offset is. Not measured.
constexpr double kOnPlanes = 3;
// The largest sine of the angle between the normals of two faces across an edge that are on one plane. Far above the
// rounding of single precision, far below all bends that are meant. Not measured.
constexpr double kOneSheetPlane = 1e-4;
// The share of the sum of squared normals that an axis must have for the planes to say where a corner is along it:
// normals that are 7 degrees apart have less. Not measured.
constexpr double kFlatCorner = 0.004;
// The share of the sum of squared normals from which on an axis counts as one across a crease: two planes that meet at
// 30 degrees have it.
constexpr double kCrease = 0.065;
// The least weight of a side's plane, in radians of its angle at the vertex: narrow faces still count. Not measured.
constexpr double kLeastAngle = 0.2;
// The weight of the plane that keeps two ends of sheets on one plane together, in radians as those of sides. Not
// measured.
constexpr double kStepWeight = 0.5;
// The largest cosine between the two border edges at a vertex that may move along the border: it is straight to 26
// degrees. Not measured.
constexpr double kStraightBorder = -0.9;
// Rounds of relaxation that spread the displacements of junctions over the sheets around. Not measured.
constexpr int kSpreadRounds = 200;

/// The planes n . x = t that a vertex is to lie on.
class Planes {
 public:
  void add(const Vec3d& n, double t, double weight) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) squares_(i, j) += weight * n[i] * n[j];
    sum_ += n * (t * weight);
    weight_ += weight;
  }

  /// Finds the shortest x that is nearest to all planes, in the sense of least squares, and the directions that lead
  /// along all of them.
  void solve() {
    if (!(weight_ > 0)) return;
    openvdb::math::Mat3d axes;
    Vec3d sizes;
    openvdb::math::diagonalizeSymmetricMatrix(squares_, axes, sizes);
    for (int k = 0; k < 3; ++k) {
      const Vec3d axis = axes.col(k);
      creases_ += sizes[k] > kCrease * weight_;
      if (sizes[k] > kFlatCorner * weight_) solution_ += axis * (axis.dot(sum_) / sizes[k]);
      else free_.push_back(axis);
    }
  }
  const Vec3d& solution() const { return solution_; }
  bool is_crease() const { return creases_ > 1; }
  /// The part of a displacement that leads along all planes.
  Vec3d along(const Vec3d& displacement) const {
    Vec3d sum(0.0);
    for (const Vec3d& axis : free_) sum += axis * axis.dot(displacement);
    return sum;
  }

 private:
  openvdb::math::Mat3d squares_ = openvdb::math::Mat3d::zero();
  Vec3d sum_{0.0}, solution_{0.0};
  double weight_ = 0;
  int creases_ = 0;
  std::vector<Vec3d> free_;
};

class WedgePositionFinder {
 public:
  WedgePositionFinder(const Sheets& sheets, const SheetSides& sides, std::span<const std::uint8_t> junctions)
      : sheets_(sheets), mesh_(sheets.mesh), sides_(sides) {
    find_wedges(junctions);
    find_neighbours();
    mark_flat_sheets();
    distance_ = measure_distances(at_junction_);
  }

  WedgePositions find() {
    result_.is_near.assign(sides_.wedges, 0);
    result_.position.assign(sides_.wedges, Vec3d(0.0));
    result_.weight.assign(sides_.wedges, 0.0);
    for (std::uint32_t w = 0; w < sides_.wedges; ++w) result_.weight[w] = weight_of(w);
    for (std::uint32_t w = 0; w < sides_.wedges; ++w) result_.is_near[w] = result_.weight[w] > 0;
    miter();
    make_room();
    for (std::uint32_t w = 0; w < sides_.wedges; ++w) result_.position[w] += origin(w);
    return std::move(result_);
  }

 private:
  const Vec3d& origin(std::uint32_t wedge) const { return mesh_.positions[vertex_[wedge]]; }

  void find_wedges(std::span<const std::uint8_t> junctions) {
    vertex_.assign(sides_.wedges, 0);
    thickness_.assign(sides_.wedges, 0.0);
    at_junction_.assign(sides_.wedges, 0);
    for (std::uint32_t i = 0; i < sides_.wedge.size(); ++i) {
      const std::uint32_t v = mesh_.corners[i / 2], w = sides_.wedge[i];
      vertex_[w] = v;
      at_junction_[w] |= junctions[v];
      for (const double t : sheets_.thickness(v)) thickness_[w] = std::max(thickness_[w], std::abs(t));
    }
  }

  /// Finds the wedges that the edges of a wedge's sides lead to.
  void find_neighbours() {
    neighbours_.resize(sides_.wedges);
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      const std::uint32_t begin = mesh_.face_begin[f], end = mesh_.face_begin[f + 1];
      for (std::uint32_t c = begin; c < end; ++c)
        for (std::uint32_t side = 0; side < 2; ++side) {
          const std::uint32_t a = sides_.wedge[2 * c + side],
                              b = sides_.wedge[2 * (c + 1 < end ? c + 1 : begin) + side];
          if (a == b) continue;
          neighbours_[a].push_back(b);
          neighbours_[b].push_back(a);
        }
    }
    for (auto& some : neighbours_) {
      std::sort(some.begin(), some.end());
      some.erase(std::unique(some.begin(), some.end()), some.end());
    }
  }

  Vec3d unit_normal(std::size_t f) const {
    Vec3d normal = area_vector(mesh_, f);
    return normal.lengthSqr() > 0 ? normal.unit() : Vec3d(0.0);
  }

  /// Of each face the faces on its plane, across edges of two faces.
  std::vector<std::vector<std::uint32_t>> find_planes() const {
    std::vector<std::vector<std::uint32_t>> others(mesh_.face_count());
    visit_edges(mesh_, sheets_.welded_to, [&](auto, std::span<const EdgeSide> sides) {
      if (sides.size() != 2) return;
      const std::uint32_t a = face_of(sides[0].corner), b = face_of(sides[1].corner);
      if (!(unit_normal(a).cross(unit_normal(b)).length() < kOneSheetPlane)) return;
      others[a].push_back(b);
      others[b].push_back(a);
    });
    return others;
  }

  /// Marks all of each flat sheet that ends at a junction: it gets the thickness that it should have all over.
  void mark_flat_sheets() {
    on_sheet_ = at_junction_;
    const auto others = find_planes();
    std::vector<std::uint8_t> found(mesh_.face_count(), 0);
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < sides_.wedge.size(); ++i)
      if (at_junction_[sides_.wedge[i]]) open.push_back(face_of(i / 2));
    while (!open.empty()) {
      const std::uint32_t f = open.back();
      open.pop_back();
      if (found[f]) continue;
      found[f] = 1;
      for (std::uint32_t i = 2 * mesh_.face_begin[f]; i < 2 * mesh_.face_begin[f + 1]; ++i)
        on_sheet_[sides_.wedge[i]] = 1;
      open.insert(open.end(), others[f].begin(), others[f].end());
    }
  }

  std::uint32_t face_of(std::uint32_t corner) const {
    const auto next = std::upper_bound(mesh_.face_begin.begin(), mesh_.face_begin.end(), corner);
    return static_cast<std::uint32_t>(next - mesh_.face_begin.begin()) - 1;
  }

  /// The distance along edges from each wedge to the nearest of `starts`, in thicknesses, where it is below kRoom.
  std::vector<double> measure_distances(const std::vector<std::uint8_t>& starts) const {
    constexpr double kUnreached = 1e300;  // stands for any distance above kRoom
    std::vector<double> distances(sides_.wedges, kUnreached);
    using Entry = std::pair<double, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (std::uint32_t w = 0; w < sides_.wedges; ++w) {
      if (starts[w]) queue.emplace(distances[w] = 0, w);
    }
    while (!queue.empty()) {
      const auto [distance, w] = queue.top();
      queue.pop();
      if (distance > distances[w]) continue;
      for (const auto n : neighbours_[w]) {
        const double scale = std::max(thickness_[w], thickness_[n]);
        if (!(scale > 0)) continue;
        const double there = distance + (origin(n) - origin(w)).length() / scale;
        if (there < kRoom && there < distances[n]) queue.emplace(distances[n] = there, n);
      }
    }
    return distances;
  }

  double weight_of(std::uint32_t w) const {
    if (on_sheet_[w]) return 1;
    return distance_[w] < kRoom ? std::min(1.0, (kRoom - distance_[w]) / (kRoom - kOnPlanes)) : 0;
  }

  double angle_at(std::size_t f, std::uint32_t corner) const {
    const std::uint32_t begin = mesh_.face_begin[f], size = mesh_.face_begin[f + 1] - begin, k = corner - begin;
    const auto at = [&](std::uint32_t i) { return mesh_.positions[mesh_.corners[begin + i % size]]; };
    const Vec3d next = at(k + 1) - at(k), previous = at(k + size - 1) - at(k);
    return std::atan2(next.cross(previous).length(), next.dot(previous));
  }

  /// Puts each wedge that is near a junction onto the planes of its sides.
  void miter() {
    slot_.assign(sides_.wedges, 0);
    std::uint32_t near = 0;
    for (std::uint32_t w = 0; w < sides_.wedges; ++w)
      if (result_.is_near[w]) slot_[w] = ++near;
    planes_.resize(near + 1);
    std::vector<std::uint8_t> has_first_side(sides_.wedges, 0);
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      Vec3d normal(0.0);
      for (std::uint32_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c) {
        const std::uint32_t front = sides_.wedge[2 * c], back = sides_.wedge[2 * c + 1];
        if (!result_.is_near[front] && !result_.is_near[back]) continue;
        if (normal.lengthSqr() == 0) normal = area_vector(mesh_, f);
        if (!(normal.lengthSqr() > 0)) break;
        normal.normalize();
        const double weight = std::max(angle_at(f, c), kLeastAngle);
        const std::uint32_t v = mesh_.corners[c];
        planes_[slot_[front]].add(normal, sheets_.thickness_on(f, 0, v), weight);
        planes_[slot_[back]].add(-normal, sheets_.thickness_on(f, 1, v), weight);
        if (front == back) has_first_side[front] = 1;  // the face ends there, and both of its sides are one wedge
      }
    }
    add_steps();
    add_shared();
    for (std::uint32_t w = 0; w < sides_.wedges; ++w) {
      if (!result_.is_near[w] || has_first_side[w]) continue;
      planes_[slot_[w]].solve();
      const double length = planes_[slot_[w]].solution().length(), most = kLongestMiter * thickness_[w];
      result_.position[w] =
          length > most ? planes_[slot_[w]].solution() * (most / length) : planes_[slot_[w]].solution();
    }
  }

  /// Adds planes that keep the ends of sheets on one plane, but of different thickness, together.
  void add_steps() {
    for (const SheetSides::Gap& gap : sides_.gaps) {
      const double length = gap.shift.length();
      if (!(length > 0)) continue;
      for (std::size_t i = 0; i < 2; ++i)
        for (const std::uint32_t corner : {gap.corner[i], next(gap.corner[i])})
          planes_[slot_[sides_.wedge[2 * corner + gap.side[i]]]].add(gap.shift / length, length, kStepWeight);
    }
  }
  /// Adds the planes of sides that reach to two pieces of a wedge that was cut.
  void add_shared() {
    for (const auto& [side, corner] : sides_.shared) {
      const std::uint32_t c = side / 2, f = face_of(c);
      const Vec3d normal = unit_normal(f);
      planes_[slot_[sides_.wedge[corner]]].add(side % 2 == 0 ? normal : -normal,
                                               sheets_.thickness_on(f, side % 2, mesh_.corners[c]),
                                               std::max(angle_at(f, c), kLeastAngle));
    }
  }
  std::uint32_t next(std::uint32_t corner) const {
    const std::uint32_t f = face_of(corner);
    return corner + 1 < mesh_.face_begin[f + 1] ? corner + 1 : mesh_.face_begin[f];
  }

  /// Spreads the displacements of junctions, and of corners of flat sheets, over the sheets around, where they fade
  /// away: harmonic, weighted by the inverse lengths of edges.
  void make_room() {
    std::vector<std::uint8_t> starts = at_junction_;
    for (std::uint32_t w = 0; w < sides_.wedges; ++w)
      starts[w] |= static_cast<std::uint8_t>(on_sheet_[w] && planes_[slot_[w]].is_crease());
    const std::vector<double> distances = measure_distances(starts);
    std::vector<std::uint32_t> within;
    std::vector<Vec3d> moved(sides_.wedges, Vec3d(0.0));
    for (std::uint32_t w = 0; w < sides_.wedges; ++w) {
      if (starts[w]) moved[w] = result_.position[w];
      else if (distances[w] < kRoom && result_.is_near[w]) within.push_back(w);
    }
    std::stable_sort(within.begin(), within.end(), [&](auto a, auto b) { return distances[a] < distances[b]; });
    for (int round = 0; round < kSpreadRounds && !within.empty(); ++round)
      for (const auto w : within) moved[w] = mean_around(w, moved);
    for (const auto w : within) result_.position[w] += on_border(w, planes_[slot_[w]].along(moved[w]));
  }

  Vec3d mean_around(std::uint32_t w, const std::vector<Vec3d>& moved) const {
    Vec3d sum(0.0);
    double weight = 0;
    for (const auto n : neighbours_[w]) {
      const double length = (origin(n) - origin(w)).length();
      if (!(length > 0)) continue;
      sum += moved[n] / length;
      weight += 1 / length;
    }
    return weight > 0 ? sum / weight : sum;
  }

  /// The part of a displacement that keeps a vertex at the border of the mesh on it.
  Vec3d on_border(std::uint32_t w, const Vec3d& displacement) {
    if (border_.empty()) find_border();
    const auto& ends = border_[w];
    if (ends.empty()) return displacement;
    if (ends.size() != 2) return Vec3d(0.0);
    const Vec3d a = (mesh_.positions[ends[0]] - origin(w)).unit(), b = (mesh_.positions[ends[1]] - origin(w)).unit();
    if (a.dot(b) > kStraightBorder) return Vec3d(0.0);
    const Vec3d along = (a - b).unit();
    return along * along.dot(displacement);
  }

  void find_border() {
    border_.resize(sides_.wedges);
    for (const SheetSides::Gap& gap : sides_.gaps) {
      if (gap.corner[0] != gap.corner[1]) continue;
      const std::uint32_t from = gap.corner[0], to = next(from);
      for (std::uint32_t side = 0; side < 2; ++side) {
        border_[sides_.wedge[2 * from + side]].push_back(mesh_.corners[to]);
        border_[sides_.wedge[2 * to + side]].push_back(mesh_.corners[from]);
      }
    }
  }

  const Sheets& sheets_;
  PolygonView mesh_;
  const SheetSides& sides_;
  WedgePositions result_;
  // All of these are of each wedge.
  std::vector<std::uint32_t> vertex_;
  std::vector<double> thickness_, distance_;  // the distance to the nearest junction, in thicknesses
  std::vector<std::uint8_t> at_junction_, on_sheet_;
  std::vector<std::vector<std::uint32_t>> neighbours_, border_;
  std::vector<std::uint32_t>
      slot_;  // the index of its planes if it is near a junction; else 0, whose planes are not used
  std::vector<Planes> planes_;
};

}  // namespace

WedgePositions find_wedge_positions(const Sheets& sheets, const SheetSides& sides,
                                    std::span<const std::uint8_t> junctions) {
  VDB_OFFSET_ASSERT(junctions.size() == sheets.mesh.positions.size());
  VDB_OFFSET_ASSERT(sides.wedge.size() == 2 * sheets.mesh.corners.size());
  return WedgePositionFinder(sheets, sides, junctions).find();
}

}  // namespace vdb_offset
