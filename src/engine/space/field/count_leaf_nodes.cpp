// SPDX-License-Identifier: Apache-2.0
#include "space/field/count_leaf_nodes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <vector>

#include "space/field/leaf_graph.h"

namespace vdb_offset {
namespace {

/// A set of cells, one bit each, that cover a box: leaf nodes of the grid (see to_local_frame()), or blocks of them.
/// What counts are the centres of their voxels. Any number of threads may add to it.
class CellSet {
 public:
  CellSet(const Vec3d& lower, const Vec3d& upper, double cell, double voxel) : cell_(cell), centres_(cell - voxel) {
    for (int k = 0; k < 3; ++k) {
      lower_[k] = cell * std::floor(lower[k] / cell) - voxel / 2;
      size_[static_cast<std::size_t>(k)] = static_cast<std::size_t>((upper[k] - lower_[k]) / cell) + 1;
    }
    words_.resize((size_[0] * size_[1] * size_[2] + 63) / 64, 0);
  }
  /// A block of cells: from one cell to another along each axis, both included.
  struct Block {
    std::array<std::size_t, 3> from, to;
    bool operator==(const Block&) const = default;
  };
  Block block(const Vec3d& lower, const Vec3d& upper) const {
    Block block{};
    for (std::size_t k = 0; k < 3; ++k) {
      block.from[k] = clamp(lower[static_cast<int>(k)], k);
      block.to[k] = clamp(upper[static_cast<int>(k)], k);
    }
    return block;
  }
  /// Adds those cells of a block that a slab reaches: the points p with lower <= p . normal <= upper.
  struct Slab {
    Vec3d normal;
    double lower, upper;
  };
  void add(const Block& block, const Slab& slab) {
    const Vec3d& n = slab.normal;
    const double half = centres_ / 2 * (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]));
    for (std::size_t i = block.from[0]; i <= block.to[0]; ++i)
      for (std::size_t j = block.from[1]; j <= block.to[1]; ++j)
        for (std::size_t k = block.from[2]; k <= block.to[2]; ++k) {
          const double at = n.dot(middle(i, j, k));
          if (at + half >= slab.lower && at - half <= slab.upper) add((i * size_[1] + j) * size_[2] + k);
        }
  }
  std::size_t count() const {
    std::size_t sum = 0;
    for (const std::uint64_t word : words_) sum += static_cast<std::size_t>(std::popcount(word));
    return sum;
  }

 private:
  void add(std::size_t cell) {
    const std::atomic_ref word(words_[cell / 64]);
    const std::uint64_t bit = std::uint64_t{1} << cell % 64;
    if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
  }
  Vec3d middle(std::size_t i, std::size_t j, std::size_t k) const {
    const Vec3d cells(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5, static_cast<double>(k) + 0.5);
    return lower_ + cells * cell_;
  }
  std::size_t clamp(double x, std::size_t k) const {
    const double index = std::clamp((x - lower_[static_cast<int>(k)]) / cell_, 0.0, static_cast<double>(size_[k] - 1));
    return static_cast<std::size_t>(index);
  }
  Vec3d lower_;
  double cell_, centres_;
  std::array<std::size_t, 3> size_;
  std::vector<std::uint64_t> words_;
};

/// Adds the cells near a triangle, by its own box and by the slab that the reach on both sides makes of its plane.
class TriangleCells {
 public:
  TriangleCells(CellSet& cells, const Reach& reach, double cell, double voxel)
      : cells_(cells), reach_(reach), far_(std::max(reach.inside, reach.outside) - voxel / 2), cell_(cell) {}

  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    Vec3d normal = (b - a).cross(c - a);
    if (const double length = normal.length(); length > 0) normal /= length;
    const double at = normal.dot(a);
    slab_ = {normal, at - reach_.inside, at + reach_.outside};
    add_pieces(a, b, c);
  }

 private:
  /// The triangle is cut into pieces that are hardly longer than a cell.
  void add_pieces(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const double ab = (b - a).lengthSqr(), bc = (c - b).lengthSqr(), ca = (a - c).lengthSqr();
    const double longest = std::max({ab, bc, ca});
    if (longest <= 4 * cell_ * cell_) return add_piece(a, b, c);
    if (ab < longest) return bc < longest ? add_pieces(c, a, b) : add_pieces(b, c, a);
    const Vec3d middle = (a + b) * 0.5;
    add_pieces(a, middle, c);
    add_pieces(middle, b, c);
  }

  void add_piece(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    using openvdb::math::maxComponent, openvdb::math::minComponent;
    const CellSet::Block block = cells_.block(minComponent(minComponent(a, b), c) - Vec3d(far_),
                                              maxComponent(maxComponent(a, b), c) + Vec3d(far_));
    // Triangles of a fine mesh mostly meet the cells of the one before.
    const bool is_known = block == last_block_ && slab_.normal.dot(last_slab_.normal) > kSameNormal &&
                          std::abs(slab_.lower - last_slab_.lower) < kSameHeight * cell_;
    if (is_known) return;
    cells_.add(block, slab_);
    last_block_ = block;
    last_slab_ = slab_;
  }

  // By how little a slab differs from one whose cells count for its own, in the cosine of the normals' angle and in
  // cells. Reasoned: less than what the boxes add.
  static constexpr double kSameNormal = 0.99, kSameHeight = 0.125;

  CellSet& cells_;
  Reach reach_;
  double far_, cell_;
  CellSet::Slab slab_{}, last_slab_{};
  CellSet::Block last_block_{};
};

/// The number of cells within reach of the surface.
double count_cells(const Surface& surface, const Reach& reach, double cell, double voxel, bool slab) {
  const MeshFacts& facts = surface.facts;
  const double far = std::max(reach.inside, reach.outside);
  // A slab is one cell thick: cells outside of the set count as its outermost ones.
  const Vec3d wide(far, far, slab ? 0 : far);
  const Vec3d upper = slab ? Vec3d(facts.upper[0], facts.upper[1], facts.lower[2]) : facts.upper;
  CellSet cells(facts.lower - wide, upper + wide, cell, voxel);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, surface.triangles.size(), 1024), [&](const auto& range) {
    TriangleCells around(cells, reach, cell, voxel);
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const auto& [i, j, k] = surface.triangles[t];
      around.add(surface.vertices[i], surface.vertices[j], surface.vertices[k]);
    }
  });
  return static_cast<double>(cells.count());
}

}  // namespace

double count_leaf_nodes(const Surface& surface, const Reach& reach, double leaf, bool slab) {
  // Most cells along the diagonal, and within reach: they limit the time that counting takes. Not measured.
  constexpr double kMostCellsAcross = 192, kMostReachInCells = 4;
  const MeshFacts& facts = surface.facts;
  const double far = std::max(reach.inside, reach.outside), near = std::min(reach.inside, reach.outside);
  const double across = facts.diagonal + 2 * far, voxel = leaf / kLeafWidth;
  double cell = leaf;
  while (across / cell > kMostCellsAcross || far / cell > kMostReachInCells) cell *= 2;
  const double counted = count_cells(surface, reach, cell, voxel, slab), ratio = cell / leaf;
  if (ratio == 1) return counted;
  const double in_cell = ratio * ratio * (slab ? 1 : ratio);
  if (far >= cell) {
    // Cells all of whose leaf nodes are within reach are full, others on average half.
    const double width = cell - leaf;
    const Reach sure{std::max(0.0, reach.inside - width), std::max(0.0, reach.outside - width)};
    return (counted + count_cells(surface, sure, cell, voxel, slab)) / 2 * in_cell;
  }
  // A flat piece of a sheet of thickness T meets area * (T + w) / leaf^3 cubes, w = 1.5 leaf the mean width of a
  // cube; curved outwards it has more area farther out.
  const double spread = 1 + 2 * reach.outside / facts.diagonal;
  const double sheet = facts.area * spread * spread * (far + near + 1.5 * leaf) / (leaf * leaf * leaf);
  return std::min(counted * in_cell, std::max(sheet, counted * ratio));
}

}  // namespace vdb_offset
