// SPDX-License-Identifier: Apache-2.0
#include "products/curves/prepared_curves.h"
#include "ground/system/call_progress.h"

#include <algorithm>
#include <string>
#include <utility>

#include "ground/system/assert.h"
#include "ground/system/memory.h"
#include "ground/system/stage_timer.h"
#include "products/offset/moved_input.h"
#include "space/field/direction_field.h"
#include "space/field/grid_plan.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// Height of the ribbon, in voxels: it goes from the lowest voxel centres of a leaf node to the highest, so that one
// layer of leaf nodes holds it, and the field is the same at all heights. Follows from kLeafWidth.
constexpr double kRibbonVoxels = kLeafWidth - 1;
// Bytes that a point takes in each layer: its positions, and what is made of them for cells. For the plan's estimate
// alone; not measured.
constexpr std::size_t kLayerPointBytes = 180;
// Bytes that a point takes beside the ribbon; measured: 120.
constexpr std::size_t kPointBytes = 150;

RunBytes bytes_of_run(CurvesView curves, const OffsetOptions& options, const Yield& yield) {
  const std::size_t points = curves.positions.size();
  RunBytes bytes{options.bytes_held + points * kPointBytes,
                 points * yield.layers * kLayerPointBytes + further_bytes(points, yield.results)};
  if (options.keep_paths) bytes.after_grid += paths_bytes(points, yield.results);
  return bytes;
}

}  // namespace

void require_one_for_each_point(CurvesView curves, std::span<const Distances> distances) {
  for (const Distances& each : distances)
    if (!each.uniform() && each.count() != curves.positions.size())
      throw InvalidInput("offset: expected a distance for each of " + std::to_string(curves.positions.size()) +
                         " points, got " + std::to_string(each.count()));
}

CurvePlan plan_ribbon(CurvesView curves, const OffsetOptions& options, int threads, const Reach& farthest,
                      const Yield& yield) {
  if (options.corners == Corners::Arc) throw InvalidInput("corners: expected miter or round for curves, got arc");
  CurvePlan planned{chains_in_plane(curves), {}, {}, {}};
  OffsetStatistics& statistics = planned.statistics;
  statistics.threads = threads;
  const MeshFacts facts = statistics.facts = facts_of(curves, planned.plane);
  if (!goes_anywhere(farthest)) return planned;
  const StageTimer timer(statistics.seconds, Stage::Rasterise);
  const VoxelSize chosen =
      choose_voxel_size(facts.median_edge, facts.diagonal, std::max(farthest.inside, farthest.outside), options.grid);
  const PlaneChains& plane = planned.plane;
  planned.ribbon =
      build_surface(make_ribbon(plane.chains.segments, plane.points, kRibbonVoxels * chosen.size).view(), {});
  GridOptions grid;
  grid.voxel_size = chosen.size;
  planned.grid = plan_grid(planned.ribbon, farthest, grid, options.max_memory, threads,
                           {.bytes = bytes_of_run(curves, options, yield), .slab = true});
  planned.grid.reason = chosen.reason;
  const auto points = static_cast<double>(curves.positions.size() * yield.results);
  expect_stages(options.progress, expected_seconds(static_cast<double>(planned.grid.leaf_nodes), 0, points));
  statistics.plan = planned.grid;
  return planned;
}

PreparedCurves::PreparedCurves(CurvesView curves, const OffsetOptions& options, CurvePlan plan)
    : curves_(curves),
      options_(options),
      plane_(std::move(plan.plane)),
      statistics_(std::move(plan.statistics)),
      ribbon_(std::move(plan.ribbon)) {
  const double voxel_size = plan.grid.voxel_size;
  VDB_OFFSET_ASSERT(voxel_size > 0);
  reserve_memory(options.reserve, plan.grid.bytes);
  {
    const StageTimer timer(statistics_.seconds, Stage::Rasterise);
    to_local_frame(ribbon_, voxel_size);
  }
  field_ = make_field(ribbon_, plan.grid, true, options, statistics_);
  drawn_ = draw_line(plane_, ribbon_.origin, kRibbonVoxels / 2 * voxel_size - ribbon_.origin[2]);
  first_point_.assign(drawn_.source.size(), kNone);
  for (std::uint32_t p = 0; p < plane_.points.size(); ++p)
    if (drawn_.vertex[p] != kNone && plane_.chains.welded_to[p] == p) first_point_[drawn_.vertex[p]] = p;
  query_.emplace(drawn_.line);
}

Distances PreparedCurves::distances_of_line(const Distances& of_points, std::size_t& disagreeing) const {
  disagreeing = 0;
  if (of_points.uniform()) return of_points;
  MeanDistances mean = mean_distances(of_points, drawn_.vertex, first_point_);
  disagreeing = mean.disagreeing;
  return Distances(std::move(mean.each));
}

/// Whether phi changes its sign away from the curves, too. The ribbon's own borders do not count, as above and below
/// them it stands for curves that go on for ever; its ends at the ends of curves do.
bool PreparedCurves::is_open() const {
  return plane_.chains.ends > 0 || ribbon_.facts.non_manifold_left > 0 || !ribbon_.facts.oriented();
}

std::vector<Paths> PreparedCurves::march(std::span<const Distances> distances, Ridges ridges) {
  const DirectionField directions = find_directions(field_, is_open(), statistics_);
  const StageTimer timer(statistics_.seconds, Stage::Propagate);
  std::vector<Paths> paths =
      propagate(*query_, directions, distances, options_.progress, march_options(options_, ridges));
  VDB_OFFSET_ASSERT(paths.size() == distances.size());
  for (Paths& each : paths) end_traces(each);
  return paths;
}

SideRoom PreparedCurves::room(const Paths& paths, const Distances& distances) const {
  return room_beside(*query_, plane_.chains.ends == 0, paths.state, [&] { return distances; });
}

}  // namespace vdb_offset
