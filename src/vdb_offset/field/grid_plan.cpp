// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/field/grid_plan.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>

#include "vdb_offset/error.h"

namespace vdb_offset {
namespace {

// Voxels that are set beyond the distance: trilinear samples there need nodes up to sqrt(3) voxels farther.
constexpr double kHaloVoxels = 2.0;
// Half width of the band: one voxel holds both ends of every grid edge that the surface crosses, and so all changes of
// sign. A little more holds the neighbours of a voxel that lies on the surface, and so on neither side.
constexpr double kBandVoxels = 1.01;
// Most voxels along an axis: leaf coordinates are packed into 21 bits each, 2^24 voxels, and 2^23 stay well within.
constexpr double kMaxVoxelsAcross = 8388608;

// Bytes for a leaf node: phi, closest triangle and direction of each voxel; the three leaf nodes themselves; and what
// the allocator keeps of the sweep's closest points. Measured in all: 12,400.
constexpr std::size_t kLeafBytes = std::size_t{kLeafVoxels} * (4 + 4 + 12) + 3 * 192 + 1700;
// Bytes for a triangle and a vertex of a surface: adjacency and normals, box tree, the rasteriser's pairs, paths. And
// for a vertex of the input: its positions before and after, and what becomes of it. With kLimitBytes, measured in all:
// 660 to 880 for a vertex and its two triangles; 32 for each further vertex at one position, as in STL.
constexpr std::size_t kTriangleBytes = 170, kVertexBytes = 250, kInputVertexBytes = 60;
// Bytes that a layer takes for a vertex: its position, the position of the cells' point, numbers of points. And for a
// face: what its cells have beside corners.
constexpr std::size_t kLayerVertexBytes = 24 + 24 + 5 * 4 + 24, kLayerFaceBytes = 1 + 8 + 5 * 4;
// Bytes that each further result takes for a vertex: positions, paths, states and what a warm start of a nearer one
// needs; and while it is made valid.
constexpr std::size_t kResultVertexBytes = 105, kJudgedVertexBytes = 95;
// Bytes for the process itself: code, libraries, allocator, and a module for what is written. Measured with two
// threads: 8 to 10 MiB, 22 with the module of VTK or CGNS, 42 with that of OpenVDB. Not measured on other machines.
constexpr double kProcessBytes = 48 << 20;
// Seconds of one thread, measured on scans of 60,000 to 1.4 million triangles. Only the estimate that is shown uses
// them.
constexpr double kLeafSeconds = 8e-5, kTriangleSeconds = 2e-6, kVertexSeconds = 1.8e-5;

/// A set of cells of a regular lattice over a box, one bit each. Any number of threads may add to it.
class CellSet {
 public:
  CellSet(const Vec3d& lower, const Vec3d& upper, double cell) : lower_(lower), cell_(cell) {
    for (std::size_t k = 0; k < 3; ++k)
      size_[k] = static_cast<std::size_t>((upper[static_cast<int>(k)] - lower[static_cast<int>(k)]) / cell) + 1;
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
  void add(const Block& block) {
    for (std::size_t i = block.from[0]; i <= block.to[0]; ++i)
      for (std::size_t j = block.from[1]; j <= block.to[1]; ++j)
        for (std::size_t k = block.from[2]; k <= block.to[2]; ++k) add((i * size_[1] + j) * size_[2] + k);
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
  std::size_t clamp(double x, std::size_t k) const {
    const double index = std::clamp((x - lower_[static_cast<int>(k)]) / cell_, 0.0, static_cast<double>(size_[k] - 1));
    return static_cast<std::size_t>(index);
  }
  Vec3d lower_;
  double cell_;
  std::array<std::size_t, 3> size_;
  std::vector<std::uint64_t> words_;
};

/// Adds the cells within `reach` of a triangle: it is cut into pieces that are hardly longer than a cell, and the box
/// of each is widened by `reach`. `last` is the block that was added last, which the next triangle mostly meets again.
void add_triangle(CellSet& cells, const Vec3d& a, const Vec3d& b, const Vec3d& c, double reach, double cell,
                  CellSet::Block& last) {
  const double ab = (b - a).lengthSqr(), bc = (c - b).lengthSqr(), ca = (a - c).lengthSqr();
  const double longest = std::max({ab, bc, ca});
  if (longest > 4 * cell * cell) {
    if (ab < longest)
      return bc < longest ? add_triangle(cells, c, a, b, reach, cell, last)
                          : add_triangle(cells, b, c, a, reach, cell, last);
    const Vec3d middle = (a + b) * 0.5;
    add_triangle(cells, a, middle, c, reach, cell, last);
    add_triangle(cells, middle, b, c, reach, cell, last);
    return;
  }
  using openvdb::math::maxComponent, openvdb::math::minComponent;
  const CellSet::Block block = cells.block(minComponent(minComponent(a, b), c) - Vec3d(reach),
                                           maxComponent(maxComponent(a, b), c) + Vec3d(reach));
  if (block == last) return;
  cells.add(block);
  last = block;
}

/// Estimates the number of leaf nodes within reach of the surface. If there are not too many, they are counted; else
/// larger cells are, and each is taken to hold a sheet of leaf nodes, or as many as the area of the surface gives.
double count_leaf_nodes(const Surface& surface, const Reach& reach, double leaf, bool slab) {
  // Most cells along the diagonal, and within reach: they limit the time that counting takes. Not measured.
  constexpr double kMostCellsAcross = 192, kMostReachInCells = 4;
  const MeshFacts& facts = surface.facts;
  const double far = std::max(reach.inside, reach.outside), near = std::min(reach.inside, reach.outside);
  const double across = facts.diagonal + 2 * far;
  double cell = leaf;
  while (across / cell > kMostCellsAcross || far / cell > kMostReachInCells) cell *= 2;
  // A slab is one cell thick: cells outside of the set count as its outermost ones.
  const Vec3d wide(far, far, slab ? 0 : far);
  const Vec3d upper = slab ? Vec3d(facts.upper[0], facts.upper[1], facts.lower[2]) : facts.upper;
  CellSet cells(facts.lower - wide, upper + wide, cell);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, surface.triangles.size(), 1024), [&](const auto& range) {
    constexpr std::size_t kNowhere = ~std::size_t{0};
    CellSet::Block last{{kNowhere, kNowhere, kNowhere}, {0, 0, 0}};
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const auto& [a, b, c] = surface.triangles[t];
      add_triangle(cells, surface.vertices[a], surface.vertices[b], surface.vertices[c], far, cell, last);
    }
  });
  const double counted = static_cast<double>(cells.count()), ratio = cell / leaf;
  if (ratio == 1) return counted;
  // A flat piece of a sheet of thickness T meets area * (T + w) / leaf^3 cubes, w = 1.5 leaf the mean width of a
  // cube; curved outwards it has more area farther out.
  const double spread = 1 + 2 * reach.outside / facts.diagonal;
  const double sheet = facts.area * spread * spread * (far + near + 1.5 * leaf) / (leaf * leaf * leaf);
  return std::min(counted * ratio * ratio * (slab ? 1 : ratio), std::max(sheet, counted * ratio));
}

double longer(const Reach& farthest) { return std::max(farthest.inside, farthest.outside); }

GridPlan estimate(const Surface& surface, const Reach& farthest, double h, int threads, const PlanContext& context) {
  GridPlan plan;
  plan.voxel_size = h;
  plan.band = kBandVoxels * h;
  plan.reach = {farthest.inside + kHaloVoxels * h, farthest.outside + kHaloVoxels * h};
  const double leaves = count_leaf_nodes(surface, plan.reach, 8 * h, context.slab);
  const double vertices = static_cast<double>(surface.facts.vertices),
               triangles = static_cast<double>(surface.triangles.size());
  const double bytes = kProcessBytes + leaves * kLeafBytes + static_cast<double>(surface_bytes(surface)) +
                       static_cast<double>(context.bytes_beside);
  if (bytes > 0x1p62) {  // such a plan is refused; the casts below must not overflow
    plan.bytes = plan.leaf_nodes = plan.voxels = std::size_t{1} << 62;
    return plan;
  }
  plan.leaf_nodes = static_cast<std::size_t>(leaves);
  plan.voxels = plan.leaf_nodes * std::size_t{kLeafVoxels};
  plan.bytes = static_cast<std::size_t>(bytes);
  plan.seconds =
      (leaves * kLeafSeconds + triangles * kTriangleSeconds + vertices * kVertexSeconds) / std::max(1, threads);
  return plan;
}

bool fits(const GridPlan& plan, const MeshFacts& facts, std::size_t max_memory) {
  const double across = (facts.diagonal + 2 * std::max(plan.reach.inside, plan.reach.outside)) / plan.voxel_size;
  return across < kMaxVoxelsAcross && (max_memory == 0 || plan.bytes <= max_memory);
}

constexpr double kCoarser = 1.25;  // factor from one voxel size that is tried to the next; not measured

/// The coarsest voxel size that is tried: the grid has a few voxels then.
double coarsest_useful(double diagonal, double distance) { return 4 * (diagonal + distance); }

/// The finest size, in steps from `h`, that fits; 0 if even a grid of a few voxels does not.
double coarsen_until_it_fits(const Surface& surface, const Reach& farthest, double h, std::size_t max_memory,
                             const PlanContext& context) {
  const double coarsest = coarsest_useful(surface.facts.diagonal, longer(farthest));
  for (; h < coarsest; h *= kCoarser)
    if (fits(estimate(surface, farthest, h, 1, context), surface.facts, max_memory)) return h;
  return 0;
}

void refuse(const GridPlan& plan, const Surface& surface, const Reach& farthest, std::size_t max_memory,
            const PlanContext& context) {
  const double fitting = coarsen_until_it_fits(surface, farthest, plan.voxel_size, max_memory, context);
  const auto mib = [](std::size_t bytes) { return static_cast<double>(bytes) / 1048576.0; };
  throw OutOfBudget(fmt::format(
      "plan: expected a grid that fits into {:.0f} MiB (--max-memory) and {:.0f} voxels across, got about {:.0f} MiB "
      "in {} leaf nodes "
      "with voxel size {:.6g} ({})",
      max_memory ? mib(max_memory) : 0x1p42, kMaxVoxelsAcross, mib(plan.bytes), plan.leaf_nodes, plan.voxel_size,
      fitting > 0 ? fmt::format("voxel size {:.6g} would fit", fitting) : "the mesh itself does not fit"));
}

VoxelSize choose(double median_edge, double diagonal, double d) {
  const double edge_floor = median_edge / 2, diagonal_floor = diagonal / 1024;
  const double floor = std::max(edge_floor, diagonal_floor), ceiling = std::max(diagonal / 64, d / 16);
  if (d < floor && floor <= ceiling)
    return {floor, edge_floor >= diagonal_floor ? "half the median edge, as the distance is smaller"
                                                : "diagonal / 1024, as the distance is smaller"};
  if (d > ceiling || floor > ceiling)
    return {ceiling, diagonal / 64 >= d / 16 ? "diagonal / 64, the coarsest useful size"
                                             : "distance / 16, the coarsest useful size"};
  return {d, "the distance: the smoothing length of the directions"};
}

}  // namespace

void require_plannable(double diagonal, double distance, const GridOptions& options) {
  if (!std::isfinite(distance) || distance == 0)
    throw InvalidInput(fmt::format("plan: expected a finite distance other than 0, got {}", distance));
  if (!(diagonal > 0)) throw InvalidInput("plan: expected a mesh with an extent, got a single point, or next to it");
  // phi is stored in single precision, so that lengths must be normal floats.
  for (const double length :
       {diagonal, distance, options.voxel_size.value_or(diagonal), distance / options.voxels_per_distance.value_or(1)})
    if (!(length > 1e-30 && length < 1e30))
      throw InvalidInput(
          fmt::format("plan: expected a diagonal, a distance and a voxel size from 1e-30 to 1e30, got "
                      "{:.3g} (scale the model)",
                      length));
  if (options.voxel_size && options.voxels_per_distance)
    throw InvalidInput("plan: expected a voxel size or voxels per distance, got both");
  for (const auto& given : {options.voxel_size, options.voxels_per_distance})
    if (given && (!std::isfinite(*given) || *given <= 0))
      throw InvalidInput(fmt::format("plan: expected a positive voxel size or voxels per distance, got {}", *given));
  if (!options.voxel_size && !options.voxels_per_distance) return;
  const double size = options.voxel_size ? *options.voxel_size : distance / *options.voxels_per_distance;
  if (const double coarsest = coarsest_useful(diagonal, distance); size > coarsest)
    throw OutOfBudget(fmt::format(
        "plan: expected a voxel size of at most {:.6g}, four times the diagonal and the distance together, got {:.6g}",
        coarsest, size));
}

VoxelSize choose_voxel_size(double median_edge, double diagonal, double distance, const GridOptions& options) {
  require_plannable(diagonal, distance, options);
  if (options.voxel_size) return {*options.voxel_size, "as given"};
  if (options.voxels_per_distance)
    return {distance / *options.voxels_per_distance,
            fmt::format("distance / {:.6g}, as given", *options.voxels_per_distance)};
  return choose(median_edge, diagonal, distance);
}

double farthest_coordinate(const MeshFacts& facts) {
  double farthest = 0;
  for (int k = 0; k < 3; ++k) farthest = std::max({farthest, std::abs(facts.lower[k]), std::abs(facts.upper[k])});
  return farthest;
}

void require_fine_coordinates(double rounding, double length, const char* of_what) {
  if (rounding <= kMostRounding * length) return;
  throw InvalidInput(
      fmt::format("plan: expected coordinates that are rounded by less than {:g} of {}, {:.6g}, got {:.3g} (move the "
                  "model to the origin, or use more digits)",
                  kMostRounding, of_what, length, rounding));
}

GridPlan plan_grid(const Surface& surface, const Reach& farthest, const GridOptions& options, std::size_t max_memory,
                   int threads, const PlanContext& context) {
  const MeshFacts& facts = surface.facts;
  require_fine_coordinates(0x1p-53 * farthest_coordinate(facts), longer(farthest), "the distance");
  VoxelSize choice = choose_voxel_size(facts.median_edge, facts.diagonal, longer(farthest), options);
  if (!options.voxel_size && !options.voxels_per_distance) {
    const double fitting = coarsen_until_it_fits(surface, farthest, choice.size, max_memory, context);
    if (fitting > choice.size) choice = {fitting, "the finest that the memory allows"};
  }
  GridPlan plan = estimate(surface, farthest, choice.size, threads, context);
  plan.reason = choice.reason;
  if (!fits(plan, facts, max_memory)) refuse(plan, surface, farthest, max_memory, context);
  return plan;
}

std::size_t surface_bytes(const Surface& surface) {
  return kTriangleBytes * surface.triangles.size() + kVertexBytes * surface.vertices.size() +
         kInputVertexBytes * surface.facts.vertices;
}

std::size_t layers_bytes(PolygonView mesh, std::size_t layers) {
  std::size_t cells = mesh.face_count() * kLayerFaceBytes;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::size_t corners = mesh.face(f).size();
    // The cell over a polygon of n > 4 corners is a polyhedron: its faces, a base, a top and n quads, list their
    // corners.
    cells += 4 * (corners > 4 ? 3 + 7 * corners : 2 * corners);
  }
  return layers * (cells + mesh.positions.size() * kLayerVertexBytes);
}

std::size_t results_bytes(PolygonView mesh, std::size_t results) {
  return mesh.positions.size() *
         ((results - 1) * kResultVertexBytes + (std::min(results, kResultsTogether) - 1) * kJudgedVertexBytes);
}

GridPlan plan_grid(const Surface& surface, double distance, const GridOptions& options, std::size_t max_memory,
                   int threads) {
  return plan_grid(surface, distance < 0 ? Reach{-distance, 0} : Reach{0, distance}, options, max_memory, threads);
}

}  // namespace vdb_offset
