// SPDX-License-Identifier: Apache-2.0
// Puts vertices of a new iso-surface onto its creases and corners. The sheets at a vertex are those that it and its
// neighbours are closest to: the second is the one whose gradient turns away most, the third the one that spans the
// largest volume with both. Newton's method goes by shortest steps to a point with the distance to all of them, and
// walks over each sheet on the way; three sheets are tried first, then two. A point counts in the vertex's own voxel,
// or within a voxel of it where voxels were merged, and only if no other surface is nearer. All places are found before
// any vertex moves, so that the result does not depend on the number of threads. Faces are not changed here. Kobbelt et
// al. (2001) extract such features with tangent planes instead of sheets.
#include "products/iso/snap_to_creases.h"

#include <openvdb/math/Mat3.h>

#include <array>
#include <cmath>
#include <optional>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// The largest cosine of the angle between the gradients of two sheets. Where the surface is rounded by a radius of
// three voxels or more, which is the distance, its gradient turns by less than that from one voxel to the next.
constexpr double kSharp = 0.9;
// The least volume that the gradients of three sheets span: less of it makes a corner that rounding moves far. Not
// measured.
constexpr double kCorner = 0.2;

/// Two or three sheets, each told by a triangle of the source that a point of it is closest to.
struct CreaseSheets {
  std::array<std::uint32_t, 3> triangle;
  std::size_t count;
};

class CreasePlaces {
 public:
  CreasePlaces(const IsoLevel& level, const VoxelMesh& mesh, const std::vector<Vec3d>& positions,
               const std::vector<std::uint32_t>& closest)
      : level_(level),
        surface_(level.query().surface()),
        mesh_(mesh),
        positions_(positions),
        closest_(closest),
        away_(positions.size()),
        second_(positions.size(), kNone),
        third_(positions.size(), kNone) {
    for_each_index(positions.size(), [&](std::size_t v) {
      const Vec3d away = positions_[v] - surface_.closest_on(closest_[v], positions_[v]).point;
      away_[v] = away.lengthSqr() > 0 ? away.unit() : Vec3d(0.0);
    });
    for_each_neighbour([&](std::uint32_t v, std::uint32_t w) { note_second(v, w); });
    for_each_neighbour([&](std::uint32_t v, std::uint32_t w) { note_third(v, w); });
  }

  /// The position of a vertex on a crease, if its voxel holds one, and the triangle that it is closest to there.
  std::optional<std::pair<Vec3d, std::uint32_t>> find(std::size_t v) const {
    if (second_[v] == kNone) return std::nullopt;
    const std::uint32_t own = closest_[v], second = closest_[second_[v]];
    if (third_[v] == kNone) return meet(v, {{own, second, kNone}, 2});
    const std::uint32_t third = closest_[third_[v]];
    if (const auto corner = meet(v, {{own, second, third}, 3})) return corner;
    if (const auto crease = meet(v, {{own, second, kNone}, 2})) return crease;
    return meet(v, {{own, third, kNone}, 2});
  }

 private:
  /// Calls visit(v, w) for neighbours, also across quads: at a corner, the voxel across a quad may be the only one that
  /// holds one sheet and no other.
  template <class Visit>
  void for_each_neighbour(Visit&& visit) const {
    const auto visit_pairs = [&](const auto& face, unsigned size) {
      for (unsigned i = 0; i < size; ++i)
        for (unsigned j = 0; j < size; ++j)
          if (i != j) visit(face[i], face[j]);
    };
    for (const auto& quad : mesh_.quads) visit_pairs(quad, 4);
    for (const auto& triangle : mesh_.triangles) visit_pairs(triangle, 3);
  }

  /// Takes a neighbour as the second sheet if its gradient turns away most; of equals the lowest number counts.
  void note_second(std::uint32_t v, std::uint32_t w) {
    const double cosine = away_[v].dot(away_[w]);
    if (cosine > kSharp || away_[w] == Vec3d(0.0)) return;
    std::uint32_t& second = second_[v];
    const double known = second == kNone ? 2 : away_[v].dot(away_[second]);
    if (cosine < known || (cosine == known && w < second)) second = w;
  }

  /// Takes a neighbour as the third sheet if the gradients of all three span the largest volume.
  void note_third(std::uint32_t v, std::uint32_t w) {
    if (second_[v] == kNone) return;
    const Vec3d across = away_[v].cross(away_[second_[v]]);
    const double volume = std::abs(across.dot(away_[w]));
    if (volume < kCorner) return;
    std::uint32_t& third = third_[v];
    const double known = third == kNone ? 0 : std::abs(across.dot(away_[third]));
    if (volume > known || (volume == known && w < third)) third = w;
  }

  /// The point nearest to a vertex that has the distance to all of these sheets, by Newton's method.
  std::optional<std::pair<Vec3d, std::uint32_t>> meet(std::size_t v, CreaseSheets sheets) const {
    constexpr int kMostSteps = 12;  // Newton's method converges in three or four; not measured beyond that.
    Vec3d x = positions_[v];
    for (int step = 0; step < kMostSteps; ++step) {
      std::array<Vec3d, 3> gradient{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
      Vec3d missing(0.0);
      bool reached = true;
      for (std::size_t s = 0; s < sheets.count; ++s) {
        const TrianglePoint on_sheet = surface_.walk_to_closest(x, sheets.triangle[s]);
        const double distance = std::sqrt(on_sheet.squared_distance);
        if (distance == 0) return std::nullopt;
        gradient[s] = (x - on_sheet.point) / distance;
        missing[static_cast<int>(s)] = level_.distance() - distance;
        reached = reached && level_.is_reached(distance);
      }
      if (!are_apart(gradient, sheets.count)) return std::nullopt;  // the walks have led to one sheet
      if (reached) return accept(v, x, sheets.triangle[0]);
      x += shortest_step(gradient, sheets.count, missing);
      constexpr double kOnTheWay = 0.5;  // voxels that steps may leave the voxel by. Not measured.
      if (!is_near(v, x, kOnTheWay)) return std::nullopt;
    }
    return std::nullopt;
  }

  static bool are_apart(const std::array<Vec3d, 3>& gradient, std::size_t count) {
    if (gradient[0].dot(gradient[1]) > kSharp) return false;
    return count == 2 || std::abs(gradient[0].cross(gradient[1]).dot(gradient[2])) >= kCorner;
  }

  /// The shortest step that changes the distances by what is missing: G^T (G G^T)^-1 missing, with the gradients as
  /// rows of G.
  static Vec3d shortest_step(const std::array<Vec3d, 3>& g, std::size_t count, const Vec3d& missing) {
    if (count == 3) return openvdb::math::Mat3d(g[0], g[1], g[2], true).inverse() * missing;
    const double cosine = g[0].dot(g[1]), determinant = 1 - cosine * cosine;
    return g[0] * ((missing[0] - cosine * missing[1]) / determinant) +
           g[1] * ((missing[1] - cosine * missing[0]) / determinant);
  }

  /// Whether a point is in the vertex's voxel, or beyond it by no more than `slack` voxels.
  bool is_near(std::size_t v, const Vec3d& x, double slack) const {
    const double h = level_.voxel_size();
    if (mesh_.merged) return (x - positions_[v]).length() <= (1 + slack) * h;
    const Vec3d in_lattice = x - mesh_.lattice.corner;
    for (int k = 0; k < 3; ++k) {
      const double cell = std::floor(static_cast<double>(mesh_.points[v][k]));
      if (!(in_lattice[k] >= (cell - slack) * h && in_lattice[k] <= (cell + 1 + slack) * h)) return false;
    }
    return true;
  }

  /// Accepts a point if it is in the voxel, but for rounding (flat parts of models often lie on the boundary of
  /// voxels), and if nothing else is nearer.
  std::optional<std::pair<Vec3d, std::uint32_t>> accept(std::size_t v, const Vec3d& x, std::uint32_t hint) const {
    constexpr double kRounding = 1e-6;  // voxels: above the rounding of single precision, which voxels are in
    if (!is_near(v, x, kRounding)) return std::nullopt;
    const Closest closest = level_.query()(x, hint);
    if (!level_.is_reached(closest.distance) || !level_.is_on_side(x)) return std::nullopt;
    return std::pair(x, closest.triangle);
  }

  const IsoLevel& level_;
  const Surface& surface_;
  const VoxelMesh& mesh_;
  const std::vector<Vec3d>& positions_;
  const std::vector<std::uint32_t>& closest_;
  std::vector<Vec3d> away_;  // of each vertex: the unit vector away from its closest point
  std::vector<std::uint32_t> second_,
      third_;  // of each vertex: neighbours that lie on other sheets; kNone if none does
};

}  // namespace

std::vector<std::uint8_t> put_on_creases(const IsoLevel& level, const VoxelMesh& mesh, std::vector<Vec3d>& positions,
                                         std::vector<std::uint32_t>& closest) {
  VDB_OFFSET_ASSERT(positions.size() == mesh.points.size() && closest.size() == mesh.points.size());
  const CreasePlaces finder(level, mesh, positions, closest);
  std::vector<std::uint8_t> on_crease(positions.size(), 0);
  std::vector<std::optional<std::pair<Vec3d, std::uint32_t>>> found(positions.size());
  for_each_index(positions.size(), [&](std::size_t v) { found[v] = finder.find(v); });
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!found[v]) continue;
    std::tie(positions[v], closest[v]) = *found[v];
    on_crease[v] = 1;
  }
  return on_crease;
}

}  // namespace vdb_offset
