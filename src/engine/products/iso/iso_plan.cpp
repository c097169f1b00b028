// SPDX-License-Identifier: Apache-2.0
// Chooses the voxel size of an iso-surface, and estimates what the run takes. A size that is given stays. Otherwise it
// is a quarter of the distance or the median edge, between bounds by the diagonal, at most half the distance where no
// face may reach the source, and then coarser step by step until the estimate fits into memory. The leaf nodes are
// estimated as the least of three bounds: the area at the distance times the thickness of a slab, the box around all,
// and those counted within reach. Bytes and triangles follow from measured factors. A run is refused, with both
// figures, if it does not fit, or if coordinates are rounded by more than two voxels. No grid is made here.
#include "products/iso/iso_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ground/numbers/rounding.h"
#include "space/field/count_leaf_nodes.h"
#include "space/field/grid_plan.h"
#include "space/surface/surface.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// Triangles of the iso-surface for each leaf node, for the estimate alone.
constexpr double kTrianglesPerLeaf = 110;
// The most voxels a distance for which no face reaches the source. A triangle has its corners in voxels around an edge
// of the lattice, at most three voxels apart, so that each of its points is within sqrt(3) voxels of a corner, and that
// one is at the distance.
constexpr double kOffSource = 0.5;
// By how much the area's share of leaf nodes is raised, for the estimate alone: measured, up to 1.15 are met.
constexpr double kMoreLeaves = 1.15;

double longest_of(const MeshFacts& facts, double distance) { return facts.diagonal + 2 * std::abs(distance); }

// The thickness, in voxels, of the slab that is made of leaf nodes so near to the surface that it may pass through
// them.
constexpr double kSlabVoxels = 14.2;
// How far beyond the distance leaf nodes may be, in voxels.
constexpr double kReachVoxels = (kSlabVoxels - kLeafWidth) / 2;

IsoPlan estimate_iso(const Surface& surface, const IsoOptions& options, bool is_signed, double h) {
  const MeshFacts& facts = surface.facts;
  const double distance = options.distance, d = std::abs(distance), sides = is_signed ? 1 : 2;
  // A surface that is curved outwards has more area farther out, and each component has at least that of a ball.
  const double spread = distance > 0 || sides == 2 ? 1 + 2 * d / facts.diagonal : 1;
  const double area = sides * facts.area * spread * spread + 4 * M_PI * d * d * static_cast<double>(facts.components);
  const double leaf = kLeafWidth * h, across = longest_of(facts, d) + 2 * leaf;
  const double by_area = kMoreLeaves * area * kSlabVoxels * h / (leaf * leaf * leaf) + 8;
  const double far = d + kReachVoxels * h;
  const Reach reach{distance < 0 || !is_signed ? far : 0, distance > 0 || !is_signed ? far : 0};
  const double leaves = std::min({by_area, std::pow(across / leaf, 3), count_leaf_nodes(surface, reach, leaf, false)});
  const std::size_t others = kProcessBytes + surface_bytes(surface) + options.bytes_held;
  const double bytes = static_cast<double>(others) + leaves * kIsoLeafBytes;
  constexpr double kMost = 0x1p62;  // only to be refused; the casts must not overflow
  IsoPlan plan;
  plan.voxel_size = h;
  plan.leaf_nodes = static_cast<std::size_t>(std::min(leaves, kMost));
  plan.triangles = static_cast<std::size_t>(std::min(leaves * kTrianglesPerLeaf, kMost));
  plan.bytes = static_cast<std::size_t>(std::min(bytes, kMost));
  return plan;
}

bool fits_budget(const IsoPlan& plan, const IsoOptions& options, const MeshFacts& facts) {
  // Voxels across, so that volumeToMesh, which has positions in single precision, resolves them to a small part of a
  // voxel.
  constexpr double kMostVoxelsAcross = 0x1p19;
  return (options.max_memory == 0 || plan.bytes <= options.max_memory) &&
         longest_of(facts, options.distance) / plan.voxel_size < kMostVoxelsAcross;
}

/// Chooses voxels that are fine enough for a chord of the rounding around an edge, of radius d, to be off by less than
/// 1 % of d in its middle, and for the details that the mesh has.
IsoPlan choose_voxels(const Surface& surface, const IsoOptions& options, bool is_signed) {
  // Voxels per distance: the chord of a quarter of d is off by 0.8 % of d.
  constexpr double kPerDistance = 4;
  // The least and the most voxels along the diagonal, whatever distance and edges ask for. Not measured.
  constexpr double kCoarsest = 128, kFinest = 512;
  const MeshFacts& facts = surface.facts;
  const double d = std::abs(options.distance), coarsest = facts.diagonal / kCoarsest, finest = facts.diagonal / kFinest;
  const double wanted = std::min(d / kPerDistance, facts.median_edge);
  const double most = std::min(longest_of(facts, d), options.off_source ? d * kOffSource : HUGE_VAL);
  double h = std::clamp(wanted, finest, coarsest);
  std::string reason = wanted < finest                        ? "diagonal / 512, as the distance or edges are smaller"
                       : wanted > coarsest                    ? "diagonal / 128, the coarsest useful size"
                       : facts.median_edge < d / kPerDistance ? "the median edge"
                                                              : "distance / 4";
  if (h > most) reason = "distance / 2, as no face may reach the source";
  constexpr double kCoarser = 1.25;  // factor from one tried voxel size to the next. Not measured.
  for (;; h *= kCoarser) {
    IsoPlan plan = estimate_iso(surface, options, is_signed, std::min(h, most));
    plan.reason = reason;
    if (h >= most || fits_budget(plan, options, facts)) return plan;
    reason = "the finest that the memory allows";
  }
}

/// Requires coordinates that are rounded by less than kMostVoxels. The corners of the new triangles are a part of a
/// voxel apart: rounded by three voxels (measured: by no less), they fold and cross wherever they are mended, without
/// end.
void require_fine_coordinates(const MeshFacts& facts, const IsoOptions& options, double h) {
  constexpr double kMostVoxels = 2;
  const double rounding =
      Rounding(options.precision).half_unit() * (farthest_coordinate(facts) + std::abs(options.distance));
  if (rounding <= kMostVoxels * h) return;
  throw InvalidInput(fmt::format(
      "iso-surface: expected coordinates that are rounded by less than {:g} voxels of {:.6g}, got {:.3g} (move "
      "the model to the origin, write more digits, or take larger voxels)",
      kMostVoxels, h, rounding));
}

}  // namespace

IsoPlan plan_voxels(const Surface& surface, const IsoOptions& options, bool is_signed) {
  const GridOptions& grid = options.grid;
  require_plannable(surface.facts.diagonal, std::abs(options.distance), grid);
  IsoPlan plan;
  if (grid.voxel_size) {
    plan = estimate_iso(surface, options, is_signed, *grid.voxel_size);
    plan.reason = "as given";
  } else if (grid.voxels_per_distance) {
    plan = estimate_iso(surface, options, is_signed, std::abs(options.distance) / *grid.voxels_per_distance);
    plan.reason = fmt::format("distance / {:.6g}, as given", *grid.voxels_per_distance);
  } else {
    plan = choose_voxels(surface, options, is_signed);
  }
  require_fine_coordinates(surface.facts, options, plan.voxel_size);
  if (fits_budget(plan, options, surface.facts)) return plan;
  const bool is_finest = options.off_source && !grid.voxel_size && !grid.voxels_per_distance;
  throw OutOfBudget(fmt::format(
      "iso-surface: needs about {:.0f} MiB with voxel size {:.6g}, more than --max-memory allows ({:.0f} MiB), or more "
      "than 524288 voxels across ({})",
      static_cast<double>(plan.bytes) / 1048576.0, plan.voxel_size,
      options.max_memory ? static_cast<double>(options.max_memory) / 1048576.0 : 0x1p42,
      is_finest ? "half the distance, so that skins do not meet: thicker walls need less, and so does a "
                  "larger --voxel-size, with which they may meet"
                : "a larger voxel size needs less"));
}

}  // namespace vdb_offset
