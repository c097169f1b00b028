// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/offset.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "ground/mesh/count_states.h"
#include "ground/system/call_progress.h"
#include "products/offset/field_stage.h"
#include "products/offset/make_results.h"
#include "products/offset/moved_input.h"
#include "products/offset/prepared_mesh.h"
#include "space/field/direction_field.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// Clearances and thicknesses are lengths in the file, and so are not measured in another space.
void require_metric(const OffsetOptions& options) {
  if (!options.metric.even() && (options.obstacles.face_count() > 0 || options.off_source))
    throw InvalidInput("metric: expected neither obstacles nor a shell where axes count differently");
}

/// The results where no vertex moves.
std::vector<OffsetResult> results_at_source(const PreparedMesh& mesh, const AskedDistances& distances) {
  std::vector<OffsetResult> results;
  for (std::size_t i = 0; i < distances.moved.size(); ++i) {
    OffsetStatistics statistics = mesh.statistics();
    statistics.disagreeing_distances = distances.disagreeing[i];
    if (mesh.surroundings()) statistics.obstacles = mesh.surroundings()->facts(mesh.source());
    results.push_back(result_at_source(MeshVertices{mesh.mesh(), mesh.surface()},
                                       distances_of_input(mesh.surface(), distances.moved[i]),
                                       mesh.options().keep_paths, std::move(statistics)));
    results.back().has_turned_faces = mesh.has_turned_faces();
  }
  return results;
}

std::vector<OffsetResult> offset_prepared(PreparedMesh& mesh, std::span<const Distances> wanted) {
  const AskedDistances distances = ask(mesh, wanted);
  if (!goes_anywhere(farthest_of(wanted))) return results_at_source(mesh, distances);
  std::vector<PreparedMesh::Marched> marched = mesh.march(distances.moved, ridges_of(mesh.options()));
  std::vector<OffsetResult> results = make_results(mesh, distances, std::move(marched));
  if (mesh.options().keep_field)
    results.front().field = hand_out(std::move(mesh.field()), results.front().statistics.facts.closed());
  return results;
}

Yield yield_of(std::span<const Distances> distances, std::size_t layers) {
  const bool by_corner =
      std::any_of(distances.begin(), distances.end(), [](const Distances& each) { return !each.at_corner().empty(); });
  return {.results = distances.size(), .layers = layers, .by_corner = by_corner};
}

}  // namespace

std::vector<OffsetResult> offset_several(PolygonView mesh, std::span<const Distances> distances,
                                         const OffsetOptions& options) {
  if (distances.empty()) throw InvalidInput("offset: expected a distance, got none");
  require_usable(mesh, distances, options);
  require_metric(options);
  const OffsetOptions of_stages = with_call_progress(options);
  std::vector<OffsetResult> results = in_arena(options.threads, [&](int threads) {
    const InMetric space(mesh, options.metric);
    PreparedMesh prepared(space, of_stages, threads, farthest_of(distances), yield_of(distances, 0));
    return offset_prepared(prepared, distances);
  });
  for (OffsetResult& result : results) count_states(result.states, result.statistics);
  report_share(of_stages.progress, Stage::Measure, 1);
  return results;
}

OffsetResult offset(PolygonView mesh, const OffsetOptions& options) {
  return std::move(offset_several(mesh, {&options.distance, 1}, options).front());
}

OffsetStatistics plan_offset(PolygonView mesh, const OffsetOptions& options) {
  return plan_several(mesh, {&options.distance, 1}, options);
}

OffsetStatistics plan_several(PolygonView mesh, std::span<const Distances> distances, const OffsetOptions& options,
                              std::size_t layers) {
  OffsetStatistics statistics;
  statistics.threads = thread_count(options.threads);
  const InMetric space(mesh, options.metric);
  const Yield yield = yield_of(distances, layers);
  const MeshParts parts =
      build_mesh_parts(space.view(), {options.only, options.obstacles, weld_for(options, yield), options.orient});
  statistics.facts = parts.surface().facts;
  const Reach farthest = farthest_of(distances);
  if (goes_anywhere(farthest))
    statistics.plan = plan_run(parts, space.view(), farthest, options, statistics.threads, yield);
  return statistics;
}

}  // namespace vdb_offset
