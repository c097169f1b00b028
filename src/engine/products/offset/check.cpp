// SPDX-License-Identifier: Apache-2.0
// Measures given positions as an offset of a mesh, wherever they come from. The mesh is sorted into parts as for an
// offset; without a given distance, the median of those found is taken, on the side that most vertices lie on. Miters
// and the ends of sliding borders are found anew. Each vertex is judged by its exact distance: reached, at the end of a
// miter, on the moved planes beside one, or limited. Faults are those that offset() looks for, by the class that finds
// them there. Faces are measured between their vertices, and with a tolerance proofs are made of all of their points.
// No field is made and nothing is moved, so that the verdict rests on the source, the positions and the options alone.
// The result does not depend on the number of threads.
#include "vdb_offset/offset.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "ground/mesh/miter_point.h"
#include "ground/mesh/planes_around.h"
#include "ground/numbers/median.h"
#include "ground/numbers/rounding.h"
#include "ground/system/progress_count.h"
#include "motion/parts/mesh_parts.h"
#include "motion/parts/part_miters.h"
#include "products/offset/field_stage.h"
#include "products/offset/prepared_mesh.h"
#include "products/offset/stand_off.h"
#include "space/query/closest_query.h"
#include "space/surface/border_planes.h"
#include "valid/faults/face_error.h"
#include "valid/faults/fault_finder.h"
#include "valid/faults/obstacle_facts.h"
#include "valid/faults/triangle_crossings.h"
#include "valid/proof/certified_faces.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// Vertices between two times that progress is reported: milliseconds. Not measured.
constexpr std::size_t kVerticesTold = 1024;

/// Vertices that arcs leave out may be mitered.
Corners corners_of(const CheckOptions& of) { return of.corners == Corners::Round ? Corners::Round : Corners::Miter; }

void require_usable(PolygonView source, std::span<const Vec3d> positions, const CheckOptions& options) {
  if (source.face_count() == 0) throw InvalidInput("check: expected a source with faces, found none");
  if (positions.size() != source.positions.size())
    throw InvalidInput("check: expected as many vertices as the source's " + std::to_string(source.positions.size()) +
                       ", found " + std::to_string(positions.size()));
  for (std::size_t v = 0; v < positions.size(); ++v)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(positions[v][k]))
        throw InvalidInput("check: vertex " + std::to_string(v) + ": expected finite coordinates");
  if (!options.metric.even() && options.obstacles.face_count() > 0)
    throw InvalidInput("check: expected no obstacles where distances differ by axis");
  if (options.tolerance_share < 0 || options.tolerance_length < 0 ||
      (options.tolerance_share > 0 && options.tolerance_length > 0))
    throw InvalidInput("check: expected one tolerance, 0 or more");
  if (!options.metric.even() && options.tolerance_share + options.tolerance_length > 0)
    throw InvalidInput("check: expected no tolerance where distances differ by axis");
  if (options.distance && !options.distance->uniform() && options.distance->count() != positions.size())
    throw InvalidInput("check: expected a distance for each of " + std::to_string(positions.size()) +
                       " vertices, got " + std::to_string(options.distance->count()));
}

/// The positions of all vertices in the offset; obstacles stay where they are.
std::vector<Vec3d> positions_in_offset(const Surface& surface, std::span<const Vec3d> source,
                                       std::span<const Vec3d> positions) {
  std::vector<Vec3d> moved(source.begin(), source.end());
  for (std::size_t w = 0; w < moved.size(); ++w)
    if (surface.representative[w] != kNone) moved[w] = positions[surface.representative[w]];
  return moved;
}

/// Counts the vertices that have another position than the one that they are welded to. Where both stay, vertices that
/// are welded with a tolerance keep positions of their own.
std::size_t count_torn(const Surface& surface, PolygonView source, std::span<const Vec3d> positions,
                       const Rounding& precision) {
  std::size_t torn = 0;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (surface.welded[v] == kNone) continue;
    const auto first = surface.representative[surface.welded[v]];
    const auto stays = [&](std::uint32_t w) {
      return positions[w] == source.positions[w] || precision.stays(source.positions[w], positions[w]);
    };
    torn += positions[v] != positions[first] && !(stays(static_cast<std::uint32_t>(v)) && stays(first));
  }
  return torn;
}

/// Distances of points from the moving part, positive outside.
std::vector<double> signed_distances(const ConstrainedSurface& constrained, const std::vector<Vec3d>& points) {
  const std::vector<Closest> closest = closest_points(constrained.moving_part, points);
  std::vector<double> distances;
  distances.reserve(closest.size());
  for (std::size_t i = 0; i < closest.size(); ++i) {
    const auto& [d, triangle, feature, tied, point] = closest[i];
    const Vec3d out = constrained.moving_part.surface().pseudonormal(triangle, feature);
    distances.push_back(out.dot(points[i] - point) < 0 ? -d : d);
  }
  return distances;
}

/// The distance that half of the moved faces' area is below, each face at its middle.
double median_of_faces(const ConstrainedSurface& constrained, std::span<const Vec3d> positions) {
  const Surface& surface = constrained.surface;
  std::vector<Vec3d> middles;
  std::vector<double> area;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    if (!constrained.triangle_on_part(t) || constrained.is_obstacle(t)) continue;
    const auto& [a, b, c] = surface.triangles[t];
    middles.push_back((positions[a] + positions[b] + positions[c]) / 3 - surface.origin);
    area.push_back((positions[b] - positions[a]).cross(positions[c] - positions[a]).length());
  }
  const std::vector<double> distances = signed_distances(constrained, middles);
  std::vector<std::uint32_t> order(distances.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](auto s, auto t) { return std::pair(distances[s], s) < std::pair(distances[t], t); });
  double left = std::accumulate(area.begin(), area.end(), 0.0) / 2;
  for (const auto t : order)
    if ((left -= area[t]) <= 0) return distances[t];
  return 0;
}

/// The distance of an offset that does not say it: the median of the moving part's vertices, with the sign of the side
/// that most of them lie on. With miters, of those alone that are about where most of the faces' area is; where hardly
/// any vertex is, as on a box, that of the faces.
double find_distance(const ConstrainedSurface& constrained, std::span<const Vec3d> positions, Corners corners) {
  constexpr double kAlike = 0.02, kHardlyAny = 0.1;  // of the distance, and of the vertices; not measured
  std::vector<Vec3d> points;
  for (std::uint32_t v = 0; v < positions.size(); ++v)
    if (constrained.vertex_on_part(v)) points.push_back(positions[v] - constrained.moving_part.surface().origin);
  std::vector<double> distances = signed_distances(constrained, points);
  const auto all = static_cast<double>(distances.size());
  if (corners == Corners::Miter) {
    const double by_faces = median_of_faces(constrained, positions);
    std::erase_if(distances, [&](double d) { return !(std::abs(d - by_faces) <= kAlike * std::abs(by_faces)); });
    if (static_cast<double>(distances.size()) < std::max(1.0, kHardlyAny * all)) return by_faces;
  }
  const bool is_inward = 2 * std::count_if(distances.begin(), distances.end(), [](double d) { return d < 0; }) >
                         static_cast<std::ptrdiff_t>(distances.size());
  for (double& d : distances) d = std::abs(d);
  return is_inward ? -median(distances) : median(distances);
}

/// The miters of the vertices of all parts, the ends of borders that slide, and how far from the moving part each
/// vertex may be therefore.
struct WantedMiters {
  std::vector<Miter> of_vertex, at_edge;  // sorted by vertex
  std::vector<double> farther, nearer;    // as of ConstrainedSurface

  /// The miter of a vertex, or that at the edge of a part, that a displacement leads to; nullptr if it leads to
  /// neither.
  const Miter* at(std::uint32_t vertex, const Vec3d& displacement, double tolerance) const {
    for (const auto& some : {std::span(of_vertex), std::span(at_edge)})
      if (const Miter* const miter = find_miter(some, vertex);
          miter && (displacement - miter->displacement).length() <= tolerance)
        return miter;
    return nullptr;
  }
};

WantedMiters find_miters(const MeshParts& parts, const ClosestQuery& query, const Obstacles* obstacles,
                         const ExactCorners* exact, const Distances& distances, PolygonView mesh,
                         const CheckOptions& options) {
  const bool slides = options.border == Border::Slide && parts.rest;
  const bool on_creases = corners_of(options) == Corners::Miter || exact;
  if (!on_creases && !slides) return {};
  const std::size_t count = parts.surface().vertices.size();
  const Distances on_part = distances_of_part(parts, distances);
  const auto own = OwnDistances::of(on_part, mesh, options.only, parts.moving_part);
  const OwnDistances* const own_distances = own ? &*own : nullptr;
  WantedMiters miters{{}, {}, std::vector<double>(count, 0.0), std::vector<double>(count, 0.0)};
  if (on_creases) {
    const auto walls =
        corners_of(options) == Corners::Miter ? walls_at_edge(parts, options.border) : std::vector<MiterWalls>();
    const MiterFinder finder(query, corners_of(options), options.miter_limit, obstacles, walls, exact);
    miters.of_vertex = miters_of_all(parts, finder.all(on_part, own_distances));
  }
  if (slides) miters.at_edge = edge_miters_of(parts, BorderSlides(parts, query), query, on_part, own_distances);
  for (const auto* const some : {&miters.of_vertex, &miters.at_edge})
    for (const Miter& miter : *some) {
      miters.farther[miter.vertex] = std::max(miters.farther[miter.vertex], miter.distance);
      miters.nearer[miter.vertex] = std::max(miters.nearer[miter.vertex], miter.nearer);
    }
  return miters;
}

/// What is left of a vector across all of some normals.
Vec3d across_all(const Vec3d& v, std::span<const Vec3d> normals) {
  constexpr double kLeast = 1e-6;  // sine; reasoned: far above rounding
  PlaneNormals planes;
  for (const Vec3d& normal : normals) {
    const Vec3d left = planes.within(normal);
    if (planes.count < 3 && left.length() > kLeast) planes.normal[planes.count++] = left.unit();
  }
  return planes.within(v);
}

/// The planes around a vertex of the moving part, moved by a distance, as far as the digits of a file show where they
/// are: edges that were split for a tolerance have small faces beside them, which rounding tilts.
struct MovedPlanes {
  std::vector<Vec3d> normals;  ///< May be shorter than 1.
  std::vector<double> tilts;
  double asked, tolerance;

  bool is_on(const Vec3d& normal, double tilt, const Vec3d& displacement) const {
    const double height = normal.dot(displacement), squared = displacement.lengthSqr() - height * height;
    return std::abs(height - asked) <= tolerance + tilt * std::sqrt(std::max(squared, 0.0));
  }
  bool is_on(std::size_t plane, const Vec3d& displacement) const {
    return is_on(normals[plane], tilts[plane], displacement);
  }
  bool is_on_all(const Vec3d& displacement) const {
    for (std::size_t i = 0; i < normals.size(); ++i)
      if (!is_on(i, displacement)) return false;
    return true;
  }
};

bool has_tolerance(const CheckOptions& options) { return options.tolerance_share + options.tolerance_length > 0; }

/// Of each plane that of its faces takes the place which a displacement is nearest to: where faces were split, the
/// largest one before that gave the plane.
void take_nearest(const Surface& part, std::uint32_t vertex, const Vec3d& displacement, double asked,
                  PlanesAround& planes) {
  const std::vector<Vec3d> of_largest = planes.normals;
  const auto off = [&](const Vec3d& normal) { return std::abs(normal.dot(displacement) - asked); };
  for (const auto t : part.triangles_around(vertex)) {
    const Vec3d& normal = part.triangle_normals[t];
    const double tilt = part.tilt(t);
    if (normal.lengthSqr() == 0 || tilt > kMostTilt) continue;
    for (std::size_t i = 0; i < of_largest.size(); ++i)
      if ((of_largest[i] - normal).length() < kOnePlaneSine + tilt && off(normal) < off(planes.normals[i])) {
        planes.normals[i] = normal;
        planes.tilts[i] = tilt;
      }
  }
}

/// Whether a displacement leads to the nearest point of some of the planes of a vertex, if these do not all meet in
/// one, or the vertex's miter is not there.
/// \param miter of the vertex, or null
bool is_nearest_of_some(const MovedPlanes& planes, const Vec3d& displacement, const Miter* miter) {
  const std::optional<MiterPoint> on_all = miter_point(planes.normals);
  const bool is_miter_on_all = !miter || planes.is_on_all(miter->displacement);
  if (on_all && on_all->excess <= kReachedTolerance && is_miter_on_all) return false;
  std::vector<Vec3d> on;
  double tilt = 0;
  for (std::size_t i = 0; i < planes.normals.size(); ++i)
    if (planes.is_on(i, displacement)) {
      on.push_back(planes.normals[i]);
      tilt = std::max(tilt, planes.tilts[i]);
    }
  return !on.empty() && across_all(displacement, on).length() <= planes.tolerance + tilt * displacement.length();
}

/// Whether a vertex is anywhere on the planes of all of its faces that move, moved by the distance, and no farther away
/// than miters are: so may those be that offset_to_tolerance() adds beside a miter. Or, at a corner with more planes
/// than meet in a point, or one whose miter is not where they do, at the nearest point of some: it is the areas of
/// faces before they were split that have chosen between these. A border whose edges were split for a tolerance may
/// seem to be held in planes, and has not been.
/// \param miter of the vertex, or null
bool is_on_planes(const MeshParts& parts, std::uint32_t vertex, const Vec3d& displacement, double asked,
                  const CheckOptions& options, double tolerance, const Miter* miter) {
  if (displacement.length() > options.miter_limit * std::abs(asked) + tolerance) return false;
  const Surface& part = parts.moving_part;
  const std::uint32_t on_part = parts.part_vertex.empty() ? vertex : parts.part_vertex[vertex];
  if (on_part == kNone) return false;
  const auto normal_of = [&](std::uint32_t t) -> const Vec3d& { return part.triangle_normals[t]; };
  const auto tilt_of = [&](std::uint32_t t) { return has_tolerance(options) ? part.tilt(t) : 0; };
  PlanesAround around = planes_around(part, on_part, normal_of, tilt_of);
  if (has_tolerance(options)) take_nearest(part, on_part, displacement, asked, around);
  MovedPlanes planes{around.normals, around.tilts, asked, tolerance};
  const auto triangles = part.triangles_around(on_part);
  // Faces that rounding has tilted against each other count as one plane, and what was added may lie on any of them.
  if (has_tolerance(options) ? planes.is_on_all(displacement)
                             : std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
                                 return normal_of(t).lengthSqr() == 0 || planes.is_on(normal_of(t), 0, displacement);
                               }))
    return true;
  for (Vec3d& normal : planes.normals) normal = part.along_border(on_part, normal);
  if (is_nearest_of_some(planes, displacement, miter)) return true;
  if (!part.is_held(on_part) || !has_tolerance(options)) return false;
  const Vec3d over = part.own_conormal(on_part);
  for (std::size_t i = 0; i < planes.normals.size(); ++i)
    planes.normals[i] = around.normals[i] - over * over.dot(around.normals[i]);
  return is_nearest_of_some(planes, displacement, nullptr);
}

/// Judges the states and distances of the input's vertices.
void judge_vertices(const MeshParts& parts, std::span<const Vec3d> source, const FaultFinder& finder,
                    const Distances& distances, const WantedMiters& miters, const CheckOptions& options,
                    CheckResult& result) {
  const Surface& surface = parts.surface();
  const double epsilon = Rounding(options.precision).epsilon();
  for (std::size_t v = 0; v < result.states.size(); ++v) {
    const std::uint32_t w = surface.welded[v];
    if (w == kNone) continue;
    const double target = std::abs(distances[w]), error = finder.distance_of(w) - target,
                 tolerance = kReachedTolerance * target +
                             std::max(epsilon * finder.positions()[w].length(), finder.rounding(w));
    result.achieved[v] = finder.distance_of(w);
    const Vec3d displacement = finder.positions()[w] - source[w];
    const Miter* const miter = miters.at(w, displacement, tolerance);
    const bool is_at_miter = miter != nullptr,
               is_beside_miter = !is_at_miter && error > tolerance && corners_of(options) == Corners::Miter &&
                                 is_on_planes(parts, w, displacement, distances[w], options, tolerance,
                                              find_miter(miters.of_vertex, w));
    const bool is_on_right_side = finder.on_right_side(w);
    result.states[v] = !is_on_right_side              ? VertexState::Limited
                       : is_at_miter                  ? miter->state
                       : is_beside_miter              ? VertexState::Mitered
                       : std::abs(error) <= tolerance ? VertexState::Reached
                                                      : VertexState::Limited;
    if (is_at_miter && miter->nearer > 0) result.achieved[v] = miter->distance;
    result.beyond += error > tolerance && !is_at_miter && !is_beside_miter;
    result.wrong_side += !is_on_right_side;
  }
}

/// Proves what can be proven of the faces that move. `states` and distances are of the surface's vertices.
std::optional<CertifiedFaces> prove_faces(const MeshParts& parts, const ClosestQuery& query,
                                          std::span<const Vec3d> source, std::span<const Vec3d> in_offset,
                                          const Distances& distances, std::span<const VertexState> states,
                                          const CheckOptions& options, Progress& progress) {
  const double share = options.tolerance_share, length = options.tolerance_length;
  if (share + length == 0) return {};
  const Surface& surface = parts.surface();
  std::vector<OffsetFace> faces;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
    if (parts.off_part.empty() || !parts.off_part[t]) faces.push_back({surface.triangles[t], t});
  std::vector<double> asked(source.size()), tolerance(source.size());
  for (std::size_t w = 0; w < asked.size(); ++w) {
    asked[w] = distances[w];
    tolerance[w] = share > 0 ? share * std::abs(asked[w]) : length;
  }
  const bool has_arcs = options.corners == Corners::Arc;  // of which all is to be at the distance
  const Corners corners = has_arcs ? Corners::Round : corners_of(options);
  CertifiedFaces certified =
      certify({query, surface, faces, source, in_offset, asked, tolerance, states, corners, has_arcs}, &progress);
  certified.share = share;
  certified.length = length;
  return certified;
}

/// Units of progress: the source's crossings, the faults and the errors of faces take about as long; proofs, which go
/// on face by face, far longer.
std::size_t units_of(const Surface& surface, const CheckOptions& options) {
  const bool proves = options.tolerance_share + options.tolerance_length > 0;
  return 3 * surface.vertices.size() + (proves ? surface.triangles.size() : 0);
}

/// Moves all vertices to where they are in the offset, and finds the faults there. \param crossing pairs of the
/// source's triangles that go through an obstacle
void find_faults(FaultFinder& finder, std::span<const Vec3d> in_offset, std::size_t crossing, Progress& progress,
                 CheckResult& result) {
  finder.move_all([&](std::uint32_t v) {
    if (v % kVerticesTold == 0) progress.advance(std::min(kVerticesTold, in_offset.size() - v));
    return in_offset[v];
  });
  result.faults = finder.count();
  result.source_crossings = finder.source_crossings().count() - crossing;
  result.crossings_near_source = finder.crossings_near_source().size();
  result.more_source_crossings = finder.source_crossings().has_more();
}

void measure(PolygonView mesh, std::span<const Vec3d> positions, const CheckOptions& options, CheckResult& result) {
  const InMetric space(mesh, options.metric),
      moved({positions, mesh.corners, mesh.face_begin, mesh.triangles}, options.metric);
  const bool by_corner = options.distance && !options.distance->at_corner().empty();
  const WeldOptions weld = weld_for({.only = options.only, .weld = options.weld}, {.by_corner = by_corner});
  MeshParts parts = build_mesh_parts(space.view(), {options.only, options.obstacles, weld, options.orient});
  result.facts = options.metric.even() ? parts.surface().facts : build_surface(mesh, weld, options.orient).facts;
  // Planes that are found show where miters are. No walls: whoever made the offset may have left these planes.
  to_local_frame(parts, frame_voxel_size(parts.surface().facts), options.symmetry, 0);
  const Surface& surface = parts.surface();
  Progress progress(options.progress, Stage::Measure, units_of(surface, options));
  const ClosestQuery query(parts.moving_part);
  const std::vector<Vec3d> source = parts.source(space.view()),
                           in_offset = positions_in_offset(surface, source, moved.view().positions),
                           in_file = parts.source(mesh),
                           moved_in_file = positions_in_offset(surface, in_file, positions);
  std::optional<Surroundings> surroundings;
  if (parts.obstacles) {
    surroundings.emplace(parts, source, options.clearance);
    result.obstacles = surroundings->facts(in_offset);
  }
  ConstrainedSurface constrained = parts.constrained(query, surroundings ? &surroundings->obstacles() : nullptr, false);
  const FileFrame file{space, in_file, moved_in_file};
  if (!options.metric.even()) constrained.file = &file;
  if (has_tolerance(options)) constrained.vertex_error = surface.vertex_error;
  if (options.corners != Corners::Arc) result.torn = count_torn(surface, mesh, positions, options.precision);
  result.distances =
      options.distance ? *options.distance : Distances(find_distance(constrained, in_offset, corners_of(options)));
  std::size_t disagreeing = 0;
  const Distances distances = distances_on_parts(parts, options.border, result.distances, disagreeing);
  result.distances = distances_of_input(surface, distances);
  result.distance = result.distances.farthest();
  if (result.distance == 0) {
    for (std::size_t v = 0; v < result.states.size(); ++v)
      if (surface.welded[v] != kNone) result.states[v] = VertexState::Reached;
    return;
  }
  std::optional<ExactCorners> exact;
  if (options.exact && options.metric.even() && options.corners != Corners::Arc)
    exact.emplace(*options.exact, space.view(), options.only, parts.moving_part);
  const WantedMiters miters =
      find_miters(parts, query, constrained.obstacles, exact ? &*exact : nullptr, distances, mesh, options);
  constrained.farther = miters.farther;
  constrained.nearer = miters.nearer;
  std::optional<SelfCrossings> source_crossings;
  if (surroundings) source_crossings = SelfCrossings{surroundings->source_crossings(), false, {}};
  FaultFinder finder(constrained, source, distances, options.precision, std::move(source_crossings));
  progress.advance(in_offset.size());
  find_faults(finder, in_offset, surroundings ? surroundings->crossing() : 0, progress, result);
  judge_vertices(parts, source, finder, distances, miters, options, result);
  std::vector<VertexState> states(source.size(), VertexState::Reached);
  for (std::size_t w = 0; w < states.size(); ++w)
    if (surface.representative[w] != kNone) states[w] = result.states[surface.representative[w]];
  const auto own = OwnDistances::of(distances, mesh, {}, surface);
  const MeasuredFaces faces{constrained, in_offset, distances, source, states, own ? &*own : nullptr};
  result.faces = measure_faces(faces);
  if (options.keep_face_errors) {
    result.face_errors = measure_each_face(faces, mesh.face_count());
    result.face_faults = finder.of_faces(mesh.face_count());
  }
  progress.advance(in_offset.size());
  result.certified = prove_faces(parts, query, source, in_offset, distances, states, options, progress);
}

}  // namespace

CheckResult check_offset(PolygonView source, std::span<const Vec3d> positions, const CheckOptions& options) {
  require_usable(source, positions, options);
  CheckResult result;
  result.states.assign(positions.size(), VertexState::Unused);
  result.achieved.assign(positions.size(), 0.0);
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  CheckOptions own = options;
  std::vector<Vec3d> off;
  if (own.corners == Corners::Arc)
    source.positions = off = positions_off_source(source, positions, std::exchange(own.weld, {}));
  arena.execute([&] { measure(source, positions, own, result); });
  return result;
}

}  // namespace vdb_offset
