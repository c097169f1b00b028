// SPDX-License-Identifier: Apache-2.0
#include "space/field/grid_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "space/field/count_leaf_nodes.h"
#include "vdb_offset/run.h"

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
// the allocator keeps of the sweep's closest points. Measured in all: 12,400 to 13,300.
constexpr std::size_t kLeafBytes = std::size_t{kLeafVoxels} * (4 + 4 + 12) + 3 * 192 + 2500;
// For what the allocator leaves unused. Measured: without, 6 of 396 runs take up to 1.07 times the estimate.
constexpr double kSlack = 1.08;
// Seconds of one thread that each leaf node, triangle and vertex takes in a stage, measured on scans of 60,000 to 1.4
// million triangles. Only what is shown uses them: the estimate and the progress.
constexpr double kRasteriseTriangle = 2e-6, kRasteriseLeaf = 3.5e-5, kSweepLeaf = 3.8e-5, kGradientLeaf = 7e-6,
                 kPropagateVertex = 8e-6, kLimitVertex = 7e-6, kMeasureVertex = 3e-6;

double longer(const Reach& farthest) { return std::max(farthest.inside, farthest.outside); }

GridPlan estimate(const Surface& surface, const Reach& farthest, double h, int threads, const PlanContext& context) {
  GridPlan plan;
  plan.voxel_size = h;
  plan.band = kBandVoxels * h;
  plan.reach = {farthest.inside + kHaloVoxels * h, farthest.outside + kHaloVoxels * h};
  const double leaves = context.has_grid ? count_leaf_nodes(surface, plan.reach, 8 * h, context.slab) : 0;
  const double vertices = static_cast<double>(surface.facts.vertices),
               triangles = static_cast<double>(surface.triangles.size());
  const double always = static_cast<double>(kProcessBytes + surface_bytes(surface) + context.bytes.always),
               after_grid = static_cast<double>(context.bytes.after_grid);
  const double bytes = kSlack * (always + std::max(leaves * kLeafBytes, after_grid));
  if (bytes > 0x1p62) {  // such a plan is refused; the casts below must not overflow
    plan.bytes = plan.leaf_nodes = plan.voxels = std::size_t{1} << 62;
    return plan;
  }
  plan.leaf_nodes = static_cast<std::size_t>(leaves);
  plan.voxels = plan.leaf_nodes * std::size_t{kLeafVoxels};
  plan.bytes = static_cast<std::size_t>(bytes);
  const StageSeconds seconds = expected_seconds(leaves, triangles, vertices);
  plan.seconds = std::accumulate(seconds.begin(), seconds.end(), 0.0) / std::max(1, threads);
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
  const std::string why = max_memory > 0 && plan.bytes > max_memory
                              ? fmt::format("more than the {:.0f} MiB that --max-memory allows", mib(max_memory))
                              : fmt::format("and is more than {:.0f} voxels across", kMaxVoxelsAcross);
  throw OutOfBudget(fmt::format(
      "plan: the run needs about {:.0f} MiB with voxels of {:.6g}, {}: {}", mib(plan.bytes), plan.voxel_size, why,
      fitting > 0 ? fmt::format("--voxel-size {:.6g} would fit", fitting) : "the mesh itself does not fit"));
}

VoxelSize choose(double median_edge, double diagonal, double d) {
  const double edge_floor = median_edge / 2, diagonal_floor = diagonal / 1024;
  const double floor = std::max(edge_floor, diagonal_floor), ceiling = std::max(diagonal / 64, d / 16);
  if (d < floor && floor <= ceiling)
    return {floor, edge_floor >= diagonal_floor ? "automatic: half the median edge, as the distance is smaller"
                                                : "automatic: diagonal / 1024, as the distance is smaller"};
  if (d > ceiling || floor > ceiling)
    return {ceiling, diagonal / 64 >= d / 16 ? "automatic: diagonal / 64, the coarsest useful size"
                                             : "automatic: distance / 16, the coarsest useful size"};
  return {d, "automatic: equals the distance"};
}

}  // namespace

StageSeconds expected_seconds(double leaves, double triangles, double vertices) {
  StageSeconds seconds{};
  const auto of = [&](Stage stage) -> double& { return seconds[static_cast<std::size_t>(stage)]; };
  of(Stage::Rasterise) = triangles * kRasteriseTriangle + leaves * kRasteriseLeaf;
  of(Stage::Sweep) = leaves * kSweepLeaf;
  of(Stage::Gradient) = leaves * kGradientLeaf;
  of(Stage::Propagate) = vertices * kPropagateVertex;
  of(Stage::Limit) = vertices * kLimitVertex;
  of(Stage::Measure) = vertices * kMeasureVertex;
  return seconds;
}

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

GridPlan plan_grid(const Surface& surface, double distance, const GridOptions& options, std::size_t max_memory,
                   int threads) {
  return plan_grid(surface, distance < 0 ? Reach{-distance, 0} : Reach{0, distance}, options, max_memory, threads);
}

}  // namespace vdb_offset
