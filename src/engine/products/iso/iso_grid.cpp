// SPDX-License-Identifier: Apache-2.0
// Fills the leaf nodes that an iso-surface passes through. Cubes over the box of the source, widened by the distance,
// are halved down to leaf nodes; one is dropped as soon as phi at its centre shows that the surface crosses no grid
// edge there, since phi changes by no more than the way. Leaf nodes are halved on in the same manner: phi is exact at
// all corners of grid edges that may be crossed, and extrapolated in cubes that the surface does not reach, where its
// sign stays right. A ball without surface around a known point spares questions about the inside. Cubes that were left
// out get their signs from the leaf nodes beside them. More leaf nodes than are allowed end the run before one is
// filled. Leaf nodes are filled one by one, so that the result does not depend on the number of threads.
#include "products/iso/iso_grid.h"

#include "ground/system/progress_count.h"

#include <fmt/format.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using openvdb::Coord;

// The share by which lengths are enlarged so that the rounding of phi to single precision (6e-8) does not decide.
constexpr double kPhiRounding = 1e-5;
const double kHalfRoot3 = std::sqrt(3.0) / 2;

/// phi at a point, and the vector there from its closest point.
struct Probe {
  Vec3d x, away;
  double distance;  ///< Unsigned.
  std::uint32_t triangle;
  bool inside;

  double phi() const { return inside ? -distance : distance; }
};

/// A cube of voxel corners. Its width is their number along each side.
struct Cube {
  Coord at;
  Probe probe;  ///< At its centre, or at that of the cube that it is part of.
};

class IsoRasteriser {
 public:
  IsoRasteriser(const ClosestQuery& query, const Inside& inside, double level, const Lattice& lattice)
      : query_(query), inside_(inside), level_(level), lattice_(lattice), h_(lattice.voxel_size) {}

  /// Finds the leaf nodes that the surface may reach, by halving cubes.
  std::vector<Cube> find_leaves(std::size_t most) const {
    int width = kLeafWidth;
    std::vector<Cube> cubes = roots(width);
    for (;; width /= 2) {
      keep_reached(cubes, width);
      if (cubes.size() > most)
        throw OutOfBudget(fmt::format(
            "iso-surface: expected a surface in no more than {} leaf nodes, got one that passes through more "
            "than {} cubes of {} voxels (a larger voxel size needs fewer)",
            most, cubes.size(), width));
      if (width == kLeafWidth) return cubes;
      std::vector<Cube> octants;
      octants.reserve(8 * cubes.size());
      for (const Cube& cube : cubes)
        for_each_octant(cube, width, [&](const Cube& octant) { octants.push_back(octant); });
      cubes = std::move(octants);
    }
  }

  /// Fills in phi - level at the voxel corners of a leaf node.
  void fill(const Cube& leaf, float* phi) const {
    for_each_octant(leaf, kLeafWidth, [&](const Cube& octant) { fill(octant, kLeafWidth / 2, leaf.at, phi); });
  }

 private:
  /// Finds phi at a point. If the point is in the ball around a known point that does not reach the source, both are on
  /// one side of it.
  Probe probe(const Vec3d& x, const Probe& known) const {
    const Closest closest = query_(x, known.triangle);
    const bool same_side = (x - known.x).length() < known.distance * (1 - kPhiRounding);
    return {x, x - closest.point, closest.distance, closest.triangle, same_side ? known.inside : inside_(x)};
  }

  Vec3d centre(const Coord& at, int width) const { return lattice_.position(at.asVec3d() + Vec3d((width - 1) / 2.0)); }
  /// The largest distance from a cube's centre at which a grid edge that starts at one of its corners may end.
  double reach(int width) const { return (kHalfRoot3 * (width - 1) + 1) * h_ * (1 + kPhiRounding); }
  /// Whether the surface may cross a grid edge at a cube. In a hole the sign of phi changes at less than the distance,
  /// where there is no surface.
  bool is_reached(const Probe& centre, int width) const {
    const double away =
        inside_.has_holes() ? std::abs(centre.distance - std::abs(level_)) : std::abs(centre.phi() - level_);
    return away <= reach(width);
  }

  std::vector<Cube> roots(int& width) const {
    const MeshFacts& facts = query_.surface().facts;
    const Vec3d pad(std::abs(level_) + 2 * h_), zero = query_.surface().origin + lattice_.corner,
                                                lower = facts.lower - zero - pad, upper = facts.upper - zero + pad;
    // The number of cubes along the longest side to begin with. For speed alone; not measured.
    constexpr int kRootsAcross = 4;
    const double across = std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]}) / h_;
    while (width * kRootsAcross < across) width *= 2;
    const auto first = [&](double x) { return static_cast<int>(std::floor(x / h_ / width)) * width; };
    std::vector<Cube> cubes;
    for (int i = first(lower[0]); i <= upper[0] / h_; i += width)
      for (int j = first(lower[1]); j <= upper[1] / h_; j += width)
        for (int k = first(lower[2]); k <= upper[2] / h_; k += width)
          cubes.push_back({{i, j, k}, {Vec3d(0.0), Vec3d(0.0), 0.0, 0, false}});  // nothing known
    return cubes;
  }

  void keep_reached(std::vector<Cube>& cubes, int width) const {
    constexpr std::size_t kGrain = 32;  // cubes that a thread takes at a time. For speed alone; not measured.
    for_each_index(
        cubes.size(), [&](std::size_t c) { cubes[c].probe = probe(centre(cubes[c].at, width), cubes[c].probe); },
        kGrain);
    std::erase_if(cubes, [&](const Cube& cube) { return !is_reached(cube.probe, width); });
  }

  template <class Visit>
  static void for_each_octant(const Cube& cube, int width, Visit&& visit) {
    const int half = width / 2;
    for (int o = 0; o < 8; ++o)
      visit(Cube{cube.at.offsetBy((o >> 2) * half, (o >> 1 & 1) * half, (o & 1) * half), cube.probe});
  }

  void fill(const Cube& cube, int width, const Coord& leaf, float* phi) const {
    const Cube here{cube.at, probe(centre(cube.at, width), cube.probe)};
    if (width == 1) {
      value_at(here.at - leaf, phi) = static_cast<float>(here.probe.phi() - level_);
    } else if (is_reached(here.probe, width)) {
      for_each_octant(here, width, [&](const Cube& octant) { fill(octant, width / 2, leaf, phi); });
    } else {
      extend(here, width, leaf, phi);
    }
  }

  /// Extrapolates phi in a cube that the surface does not reach, along the gradient at its centre: the sign of phi -
  /// level stays, since phi changes by less than the distance of the surface.
  void extend(const Cube& cube, int width, const Coord& leaf, float* phi) const {
    const auto& [x, away, distance, triangle, inside] = cube.probe;
    const Vec3d gradient = distance > 0 ? away * ((inside ? -1 : 1) / distance) : Vec3d(0.0);
    for (int i = 0; i < width; ++i)
      for (int j = 0; j < width; ++j)
        for (int k = 0; k < width; ++k) {
          const Coord at = cube.at.offsetBy(i, j, k);
          value_at(at - leaf, phi) =
              static_cast<float>(cube.probe.phi() - level_ + gradient.dot(lattice_.position(at.asVec3d()) - x));
        }
  }

  static float& value_at(const Coord& local, float* phi) { return phi[local[0] << 6 | local[1] << 3 | local[2]]; }

  const ClosestQuery& query_;
  const Inside& inside_;
  double level_;
  const Lattice& lattice_;
  double h_;
};

}  // namespace

IsoGrid rasterise_iso(const ClosestQuery& query, const Inside& inside, double level, const Lattice& lattice,
                      std::size_t most_leaf_nodes, const ProgressCallback& callback) {
  VDB_OFFSET_ASSERT(lattice.voxel_size > 0 && level != 0);
  const IsoRasteriser rasteriser(query, inside, level, lattice);
  const std::vector<Cube> leaves = rasteriser.find_leaves(most_leaf_nodes);
  const auto beyond = static_cast<float>(lattice.voxel_size);
  IsoGrid grid;
  grid.phi = openvdb::FloatGrid::create(beyond);
  grid.leaf_nodes = leaves.size();
  std::vector<std::unique_ptr<PhiLeaf>> nodes(leaves.size());
  Progress progress(callback, Stage::Rasterise, leaves.size());
  for_each_index(
      leaves.size(),
      [&](std::size_t l) {
        nodes[l] = std::make_unique<PhiLeaf>(leaves[l].at, 0.0f, true);
        rasteriser.fill(leaves[l], nodes[l]->buffer().data());
        progress.advance(1);
      },
      8);
  for (auto& node : nodes) grid.phi->tree().addLeaf(node.release());
  // No grid edge from a leaf node to the cubes that are left out crosses the surface: these have the signs beside them.
  openvdb::tools::signedFloodFillWithValues(grid.phi->tree(), beyond, -beyond);
  return grid;
}

}  // namespace vdb_offset
