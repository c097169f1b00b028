#include "vdb_offset/offset.h"

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "vdb_offset/closest.h"
#include "vdb_offset/directions.h"
#include "vdb_offset/error.h"
#include "vdb_offset/rasterise.h"

namespace vdb_offset {
namespace {

// Triangles that the error between vertices is measured on.
constexpr std::size_t kInteriorTriangles = 10000;

/// Adds the time that it lives to one stage's seconds.
class StageTimer {
 public:
  StageTimer(OffsetStatistics& statistics, Stage stage)
      : seconds_(statistics.seconds[static_cast<std::size_t>(stage)]), start_(Clock::now()) {}
  ~StageTimer() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_;
};

int thread_count(const OffsetOptions& options) {
  if (options.threads < 0)
    throw InvalidInput("offset: expected 0 threads or more, got " + std::to_string(options.threads));
  // More than the machine has would only be asked for in vain.
  const int most = tbb::info::default_concurrency();
  return options.threads > 0 ? std::min(options.threads, most) : most;
}

void require_finite_distance(const OffsetOptions& options) {
  if (!std::isfinite(options.distance)) throw InvalidInput("offset: expected a finite distance");
}

OffsetResult unmoved(PolygonView mesh) {
  OffsetResult result;
  result.positions.assign(mesh.positions.begin(), mesh.positions.end());
  result.states.assign(mesh.positions.size(), VertexState::Unused);
  result.achieved.assign(mesh.positions.size(), 0.0);
  return result;
}

/// Hands the surface vertices' paths to the input's vertices.
void move_vertices(PolygonView mesh, const Surface& surface, const Paths& paths, OffsetResult& result) {
  for (std::size_t v = 0; v < result.positions.size(); ++v) {
    const auto w = surface.welded[v];
    if (w == kNone) continue;
    result.positions[v] = mesh.positions[surface.representative[w]] + paths.displacement[w];
    result.states[v] = paths.state[w];
    result.achieved[v] = paths.achieved[w];
  }
  result.statistics.straight_vertices = paths.straight;
}

/// Where the surface's vertices stand in the input, to the last bit.
std::vector<Vec3d> source_positions(PolygonView mesh, const Surface& surface) {
  std::vector<Vec3d> positions;
  positions.reserve(surface.representative.size());
  for (const auto v : surface.representative) positions.push_back(mesh.positions[v]);
  return positions;
}

std::vector<Vec3d> moved_places(PolygonView mesh, const Surface& surface, const OffsetResult& result) {
  return source_positions({result.positions, mesh.corners, mesh.face_begin}, surface);
}

void describe_field(const DistanceField& field, const DirectionField& directions, OffsetStatistics& statistics) {
  statistics.active_voxels = field.phi->activeVoxelCount();
  statistics.leaf_nodes = field.phi->tree().leafCount();
  statistics.phi_bytes = field.phi->memUsage();
  statistics.closest_bytes = field.closest->memUsage();
  statistics.gradient_bytes = directions.gradient->memUsage();
}

/// The pipeline: surface, front, field, directions, paths, and what of them is valid.
void run(PolygonView mesh, const OffsetOptions& options, OffsetResult& result) {
  OffsetStatistics& statistics = result.statistics;
  Front front;
  Surface surface;
  {
    const StageTimer timer(statistics, Stage::Rasterise);
    surface = build_surface(mesh, options.weld, options.orient);
    statistics.facts = surface.facts;
    statistics.plan = plan_grid(surface, options.distance, options.grid, options.max_memory, statistics.threads);
    place(surface, statistics.plan.voxel_size);
    front = rasterise(surface, {statistics.plan.voxel_size, statistics.plan.band}, options.progress);
  }
  DistanceField field;
  {
    const StageTimer timer(statistics, Stage::Sweep);
    field = sweep(std::move(front), surface, {options.solver, statistics.plan.reach}, options.progress);
  }
  std::optional<ClosestQuery> query;
  Paths paths;
  {
    const StageTimer timer(statistics, Stage::Propagate);
    const DirectionField directions = make_directions(field, !surface.facts.closed() || !surface.facts.oriented());
    describe_field(field, directions, statistics);
    query.emplace(surface);
    paths = propagate(*query, directions, {options.distance}, options.progress);
  }
  if (options.collision == Collision::Limit) {
    const StageTimer timer(statistics, Stage::Limit);
    statistics.limit =
        limit(*query, source_positions(mesh, surface), {options.distance, options.precision}, paths, options.progress);
  }
  move_vertices(mesh, surface, paths, result);
  statistics.interior =
      measure_interior(*query, moved_places(mesh, surface, result), std::abs(options.distance), kInteriorTriangles);
  if (options.keep_field) result.field = std::make_shared<DistanceField>(std::move(field));
}

/// A distance of 0 needs no field: every vertex in use is where it should be.
void run_nothing(PolygonView mesh, const OffsetOptions& options, OffsetResult& result) {
  const Surface surface = build_surface(mesh, options.weld, options.orient);
  result.statistics.facts = surface.facts;
  for (std::size_t v = 0; v < result.states.size(); ++v)
    if (surface.welded[v] != kNone) result.states[v] = VertexState::Reached;
}

}  // namespace

OffsetResult offset(PolygonView mesh, const OffsetOptions& options) {
  require_finite_distance(options);
  OffsetResult result = unmoved(mesh);
  result.statistics.threads = thread_count(options);
  // An arena of its own keeps the number of threads a matter of this call alone.
  tbb::task_arena arena(result.statistics.threads);
  arena.execute([&] { options.distance == 0 ? run_nothing(mesh, options, result) : run(mesh, options, result); });
  for (const VertexState state : result.states) ++result.statistics.vertices_by_state[static_cast<std::size_t>(state)];
  return result;
}

OffsetResult offset(Mesh& mesh, const OffsetOptions& options) {
  const Polygons polygons = to_polygons(mesh);
  OffsetResult result = offset(polygons.view(), options);
  for (const auto vertex : mesh.all_vertices()) {
    const Vec3d& p = result.positions[static_cast<std::size_t>(vertex.idx())];
    mesh.set_point(vertex, {p[0], p[1], p[2]});
  }
  return result;
}

double used_diagonal(PolygonView mesh) {
  if (mesh.corners.empty()) return 0;
  Vec3d lower = mesh.positions[mesh.corners[0]], upper = lower;
  for (const auto v : mesh.corners) {
    lower = openvdb::math::minComponent(lower, mesh.positions[v]);
    upper = openvdb::math::maxComponent(upper, mesh.positions[v]);
  }
  return (upper - lower).length();
}

OffsetStatistics plan_offset(PolygonView mesh, const OffsetOptions& options) {
  require_finite_distance(options);
  OffsetStatistics statistics;
  statistics.threads = thread_count(options);
  const Surface surface = build_surface(mesh, options.weld, options.orient);
  statistics.facts = surface.facts;
  if (options.distance != 0)
    statistics.plan = plan_grid(surface, options.distance, options.grid, options.max_memory, statistics.threads);
  return statistics;
}

}  // namespace vdb_offset
