// SPDX-License-Identifier: Apache-2.0
// Makes the triangles of an iso-surface from its voxels. OpenVDB's volumeToMesh, which is dual marching cubes, gives a
// vertex for each voxel that the surface passes through, and faces between them. Each vertex follows the gradient to
// its exact distance as long as it stays in its voxel, and otherwise is found by bisection towards a voxel corner with
// the other sign. Vertices then go onto creases (snap_to_creases.cpp), and quads are split along the shorter diagonal,
// at a crease along the one whose middle is nearer to the surface. Vertices are projected in runs of a fixed length,
// since an answer may depend on its hint: so the result does not depend on the number of threads. Faces that cross are
// not mended here (see mend.cpp).
#include "products/iso/iso_mesh.h"

#include "ground/system/progress_count.h"

#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "ground/system/parallel.h"
#include "products/iso/snap_to_creases.h"

namespace vdb_offset {
namespace {

using openvdb::Coord;

/// Puts the vertices that volumeToMesh makes onto the surface.
class Projection {
 public:
  Projection(const IsoGrid& grid, const IsoLevel& level, const Lattice& lattice, bool merged)
      : tree_(grid.phi->tree()), level_(level), lattice_(lattice), h_(lattice.voxel_size), merged_(merged) {}

  /// Projects a point of index space. Its voxel's corners have both signs, unless it stands for several merged voxels;
  /// then it may go farther.
  Vec3d operator()(const Vec3d& index, std::uint32_t& hint) const {
    const Vec3d x = lattice_.position(index);
    const Coord cell = Coord::floor(index);
    const double most = merged_ ? kLeafWidth * h_ : h_;
    const auto is_near = [&](const Vec3d& y) {
      if (merged_) return (y - x).length() <= most;
      const Vec3d in_lattice = y - lattice_.corner;
      for (int k = 0; k < 3; ++k)
        if (!(in_lattice[k] >= cell[k] * h_ && in_lattice[k] <= (cell[k] + 1) * h_)) return false;
      return true;
    };
    if (const auto position = level_.follow(x, hint, is_near)) return *position;
    const double here = level_(x, hint);
    for (int ring = 0; ring <= (merged_ ? kLeafWidth : 1); ++ring)
      if (const auto corner = nearest_corner(cell, ring, index, here))
        return here < 0 ? level_.between(x, lattice_.position(*corner), hint)
                        : level_.between(lattice_.position(*corner), x, hint);
    return x;
  }

 private:
  /// Of the voxel corners up to `ring` voxels away that have the other sign, the one towards which the surface seems
  /// nearest.
  std::optional<Vec3d> nearest_corner(const Coord& cell, int ring, const Vec3d& index, double here) const {
    openvdb::tree::ValueAccessor<const openvdb::FloatTree> accessor(tree_);
    std::optional<Vec3d> nearest;
    double least = 0;
    for (int i = -ring; i <= 1 + ring; ++i)
      for (int j = -ring; j <= 1 + ring; ++j)
        for (int k = -ring; k <= 1 + ring; ++k) {
          const Coord corner = cell.offsetBy(i, j, k);
          const double there = accessor.getValue(corner);
          if ((there < 0) == (here < 0)) continue;
          const double away = (corner.asVec3d() - index).length() * std::abs(here) / (std::abs(here) + std::abs(there));
          if (nearest && away >= least) continue;
          least = away;
          nearest = corner.asVec3d();
        }
    return nearest;
  }

  const openvdb::FloatTree& tree_;
  const IsoLevel& level_;
  const Lattice& lattice_;
  double h_;
  bool merged_;
};

/// Splits quads along the shorter diagonal; quads at a crease along the diagonal whose middle is nearer to the surface,
/// so that the crease is not cut. If three corners are on one crease, both may be as near: then no triangle is to be
/// flat.
class QuadSplitter {
 public:
  QuadSplitter(const IsoLevel& level, std::span<const Vec3d> positions, std::span<const std::uint32_t> closest,
               std::span<const std::uint8_t> on_crease)
      : level_(level), positions_(positions), closest_(closest), on_crease_(on_crease) {}

  /// The corner at which the diagonal starts, 0 or 1.
  std::uint8_t operator()(const openvdb::Vec4I& q) const {
    const auto length = [&](int i, int j) { return (positions_[q[i]] - positions_[q[j]]).lengthSqr(); };
    if (!on_crease_[q[0]] && !on_crease_[q[1]] && !on_crease_[q[2]] && !on_crease_[q[3]])
      return length(0, 2) > length(1, 3);
    // Errors that differ by less than this share of a voxel count as equal. Not measured.
    constexpr double kAlike = 1e-3;
    const double even = error(q[0], q[2]), odd = error(q[1], q[3]), alike = kAlike * level_.voxel_size();
    if (std::abs(even - odd) > alike) return even > odd;
    return std::min(area(q, 0, 1, 2), area(q, 0, 2, 3)) < std::min(area(q, 1, 2, 3), area(q, 1, 3, 0));
  }

 private:
  double error(std::uint32_t a, std::uint32_t b) const {
    return std::abs(level_.query()((positions_[a] + positions_[b]) / 2.0, closest_[a]).distance - level_.distance());
  }
  double area(const openvdb::Vec4I& q, int i, int j, int k) const {
    return (positions_[q[j]] - positions_[q[i]]).cross(positions_[q[k]] - positions_[q[i]]).lengthSqr();
  }

  const IsoLevel& level_;
  std::span<const Vec3d> positions_;
  std::span<const std::uint32_t> closest_;
  std::span<const std::uint8_t> on_crease_;
};

/// The triangles of a mesh, without positions, turned round if asked for.
Polygons split_polygons(const VoxelMesh& voxels, const QuadSplitter& split, bool turned) {
  std::vector<std::uint8_t> first(voxels.quads.size());  // corner of the diagonal
  for_each_index(first.size(), [&](std::size_t i) { first[i] = split(voxels.quads[i]); });
  Polygons mesh;
  mesh.corners.reserve(3 * (voxels.triangles.size() + 2 * voxels.quads.size()));
  mesh.face_begin.reserve(voxels.triangles.size() + 2 * voxels.quads.size() + 1);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (turned) mesh.add_face({a, c, b});
    else mesh.add_face({a, b, c});
  };
  for (const auto& t : voxels.triangles) add(t[0], t[1], t[2]);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto& q = voxels.quads[i];
    const unsigned k = first[i];
    add(q[k], q[k + 1], q[k + 2]);
    add(q[k], q[k + 2], q[(k + 3) % 4]);
  }
  return mesh;
}

/// Finds the positions of vertices on the surface, and the triangles that they are closest to.
void project(const IsoGrid& grid, const IsoLevel& level, const VoxelMesh& voxels, std::vector<Vec3d>& positions,
             std::vector<std::uint32_t>& closest, const ProgressCallback& callback) {
  const Projection projection(grid, level, voxels.lattice, voxels.merged);
  // The length of runs does not depend on the number of threads, as an answer may depend on its hint. Not measured.
  constexpr std::size_t kRun = 256;
  Progress progress(callback, Stage::Capture, positions.size());
  const auto run = [&](std::size_t r) {
    std::uint32_t hint = 0;
    const std::size_t end = std::min(positions.size(), (r + 1) * kRun);
    for (std::size_t v = r * kRun; v < end; ++v) {
      positions[v] = projection(Vec3d(voxels.points[v]), hint);
      closest[v] = hint;
    }
    progress.advance(kRun);
  };
  for_each_index((positions.size() + kRun - 1) / kRun, run, 1);
}

}  // namespace

Polygons mesh_iso_surface(const IsoGrid& grid, const Lattice& lattice, const IsoLevel& level, double adaptivity,
                          bool turned, const ProgressCallback& progress) {
  VoxelMesh voxels;
  voxels.lattice = lattice;
  voxels.merged = adaptivity > 0;
  openvdb::tools::volumeToMesh(*grid.phi, voxels.points, voxels.triangles, voxels.quads, 0.0, adaptivity);
  std::vector<Vec3d> positions(voxels.points.size());
  std::vector<std::uint32_t> closest(positions.size());
  project(grid, level, voxels, positions, closest, progress);
  const std::vector<std::uint8_t> on_crease = put_on_creases(level, voxels, positions, closest);
  Polygons mesh = split_polygons(voxels, {level, positions, closest, on_crease}, turned);
  mesh.positions = std::move(positions);
  return mesh;
}

}  // namespace vdb_offset
