#include "vdb_offset/check.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "vdb_offset/closest.h"
#include "vdb_offset/error.h"

namespace vdb_offset {
namespace {

void require_usable(PolygonView source, std::span<const Vec3d> positions) {
  if (source.face_count() == 0) throw InvalidInput("check: expected a source with faces, found none");
  if (positions.size() != source.positions.size())
    throw InvalidInput("check: expected as many vertices as the source's " + std::to_string(source.positions.size()) +
                       ", found " + std::to_string(positions.size()));
  for (std::size_t v = 0; v < positions.size(); ++v)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(positions[v][k]))
        throw InvalidInput("check: vertex " + std::to_string(v) + ": expected finite coordinates");
}

/// The offset's places and the source's, vertex by vertex of the surface.
struct Places {
  std::vector<Vec3d> source, offset;
  std::size_t torn = 0;

  Places(const Surface& surface, PolygonView mesh, std::span<const Vec3d> positions) {
    source.reserve(surface.representative.size());
    offset.reserve(surface.representative.size());
    for (const auto v : surface.representative) {
      source.push_back(mesh.positions[v]);
      offset.push_back(positions[v]);
    }
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const std::uint32_t w = surface.welded[v];
      if (w == kNone || positions[v] == offset[w]) continue;
      torn += offset[w] != source[w] || positions[v] != mesh.positions[v];  // what stays may stay beside it
    }
  }
};

/// The median distance, with the sign of the side that most vertices lie on.
double find_distance(const ClosestQuery& query, std::span<const Vec3d> places) {
  const Surface& surface = query.surface();
  std::vector<Vec3d> points;
  points.reserve(places.size());
  for (const Vec3d& p : places) points.push_back(p - surface.origin);
  const std::vector<Closest> closest = closest_points(query, points);
  std::vector<double> distance;
  distance.reserve(closest.size());
  std::ptrdiff_t outside = 0;
  for (std::size_t v = 0; v < closest.size(); ++v) {
    const auto& [d, triangle, feature, point] = closest[v];
    distance.push_back(d);
    outside += surface.pseudonormal(triangle, feature).dot(points[v] - point) < 0 ? -1 : 1;
  }
  const auto middle = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2);
  std::nth_element(distance.begin(), middle, distance.end());
  return outside < 0 ? -*middle : *middle;
}

/// States and distances of the input's vertices.
void judge_vertices(const Surface& surface, const FaultFinder& finder, const Precision& precision,
                    CheckResult& result) {
  const double target = std::abs(result.distance), epsilon = precision.epsilon();
  for (std::size_t v = 0; v < result.states.size(); ++v) {
    const std::uint32_t w = surface.welded[v];
    if (w == kNone) continue;
    const double error = finder.distance_of(w) - target,
                 tolerance = 1e-6 * target + epsilon * finder.places()[w].length();
    result.achieved[v] = finder.distance_of(w);
    result.states[v] = std::abs(error) <= tolerance ? VertexState::Reached : VertexState::Limited;
    result.beyond += error > tolerance;
    result.wrong_side += !finder.on_right_side(w);
  }
}

void measure(PolygonView source, std::span<const Vec3d> positions, const CheckOptions& options, CheckResult& result) {
  const InMetric space(source, options.metric), moved({positions, source.corners, source.face_begin}, options.metric);
  Surface surface = build_surface(space.view(), options.weld, options.orient);
  result.facts = options.metric.even() ? surface.facts : build_surface(source, options.weld, options.orient).facts;
  place(surface, surface.facts.diagonal / 256);
  const ClosestQuery query(surface);
  const Places places(surface, space.view(), moved.view().positions), in_file(surface, source, positions);
  const FileFrame file{space, in_file.source, in_file.offset};
  result.torn = places.torn;
  result.distance = options.distance ? *options.distance : find_distance(query, places.offset);
  if (result.distance == 0) {
    for (std::size_t v = 0; v < result.states.size(); ++v)
      if (surface.welded[v] != kNone) result.states[v] = VertexState::Reached;
    return;
  }
  Body body{query, surface, {}, {}, {}, nullptr, false};
  if (!options.metric.even()) body.file = &file;
  const Distances distances(result.distance);
  FaultFinder finder(body, places.source, distances, {});
  finder.look_everywhere([&](std::uint32_t v) { return places.offset[v]; });
  result.faults = finder.count();
  result.source_crossings = finder.source_crossings().size();
  result.crossings_near_source = finder.crossings_near_source();
  judge_vertices(surface, finder, options.precision, result);
  result.interior = measure_interior(body, places.offset, distances);
}

}  // namespace

CheckResult check_offset(PolygonView source, std::span<const Vec3d> positions, const CheckOptions& options) {
  require_usable(source, positions);
  CheckResult result;
  result.states.assign(positions.size(), VertexState::Unused);
  result.achieved.assign(positions.size(), 0.0);
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  arena.execute([&] { measure(source, positions, options, result); });
  return result;
}

}  // namespace vdb_offset
