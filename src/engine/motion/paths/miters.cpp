// SPDX-License-Identifier: Apache-2.0
#include "motion/paths/miters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "ground/mesh/miter_point.h"
#include "ground/mesh/prevailing_point.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "motion/paths/obstacle_guard.h"
#include "space/curve/curve_corners.h"
#include "space/surface/creases.h"

namespace vdb_offset {
namespace {

// Miters that are proven together, as the exact query answers neighbours together. Not measured.
constexpr std::size_t kMitersTogether = 64;
// How far from a vertex, in distances, what is nearer to the end of its miter than its own faces still belongs to its
// corner. See docs/dev/tuning.md.
constexpr double kDetail = 1;
// Most steps back from the end of a miter. Reasoned: of one of four distances, the longest by default, each step takes
// a fifth of what is left or more.
constexpr int kMostStepsBack = 64;
// Planes that are closer to each other, as the length between their normals, and have different distances of their own
// meet nowhere near the vertex. Reasoned: the miter would be ten times as long as the distances differ.
constexpr double kTooAlike = 0.1;
// Share of a miter's length by which exact distances may differ that ought to be the same. Reasoned: far below the
// promised 1e-6, far above rounding.
constexpr double kSameMiterDistance = 1e-9;

/// The planes around a vertex, of the exact surface where that is known.
template <class Shape>
PlanesAround planes_around(const Shape& shape, std::uint32_t vertex, const ExactCorners* exact) {
  return planes_around(shape, vertex, [&](std::uint32_t t) -> const Vec3d& {
    return exact ? exact->normal(t, vertex) : shape.triangle_normals[t];
  });
}

/// Planes around a vertex that move by distances of their own.
struct OwnPlanes {
  std::vector<Vec3d> staying, moving;  ///< Normals.
  double least = std::numeric_limits<double>::infinity();
};

/// The planes around a vertex that have distances of their own: normals of those that stay, and of others, shortened so
/// that their sum of products with the miter is the least distance. Nothing if they have no common miter.
template <class Shape>
std::optional<OwnPlanes> own_planes_around(const Shape& shape, std::uint32_t vertex, int side,
                                           const ExactCorners* exact, const OwnDistances& own) {
  std::vector<std::pair<Vec3d, double>> planes;
  OwnPlanes result;
  for (const auto t : shape.triangles_around(vertex)) {
    if (shape.triangle_normals[t].lengthSqr() == 0) continue;
    const Vec3d& normal = exact ? exact->normal(t, vertex) : shape.triangle_normals[t];
    const double distance = side * own.at(t, vertex);
    if (distance < 0) return std::nullopt;
    const auto alike = std::find_if(planes.begin(), planes.end(), [&](const auto& plane) {
      return (plane.first - normal).lengthSqr() <
             (plane.second == distance ? kOnePlaneSine * kOnePlaneSine : kTooAlike * kTooAlike);
    });
    if (alike == planes.end()) planes.emplace_back(normal, distance);
    else if (alike->second != distance) return std::nullopt;
    if (distance > 0) result.least = std::min(result.least, distance);
  }
  for (const auto& [normal, distance] : planes)
    if (distance == 0) result.staying.push_back(normal);
    else result.moving.push_back(normal * (result.least / distance));
  if (result.moving.empty() || result.staying.size() > 2) return std::nullopt;
  return result;
}

/// Distance of a point from the faces around a vertex alone.
template <class Shape>
double distance_from_fan(const Shape& shape, std::uint32_t vertex, const Vec3d& x) {
  double squared = (x - shape.vertices[vertex]).lengthSqr();
  for (const auto t : shape.triangles_around(vertex))
    squared = std::min(squared, shape.closest_on(t, x).squared_distance);
  return std::sqrt(squared);
}

/// Whether the foot of a point on the plane of a face, as seen from one of its corners, lies on the face if that went
/// on beyond its other corners.
bool holds_foot(const Surface& surface, std::uint32_t triangle, std::uint32_t vertex, const Vec3d& foot) {
  const auto& corners = surface.triangles[triangle];
  const int k = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
  const Vec3d &start = surface.vertices[vertex], &normal = surface.triangle_normals[triangle];
  const Vec3d a = surface.vertices[corners[(k + 1) % 3]] - start, b = surface.vertices[corners[(k + 2) % 3]] - start;
  return normal.dot(a.cross(foot)) >= -kOnePlaneSine * a.length() &&
         normal.dot(foot.cross(b)) >= -kOnePlaneSine * b.length();
}
bool holds_foot(const Polyline& line, std::uint32_t segment, std::uint32_t vertex, const Vec3d& foot) {
  const auto& [a, b] = line.segments[segment];
  const Vec3d side = line.vertices[a == vertex ? b : a] - line.vertices[vertex];
  return side.dot(foot) >= -kOnePlaneSine * side.length();
}

/// Whether the end of a miter on one side is at a distance of 1 from the faces around the vertex, if these went on for
/// ever: as it is on all of their planes that are moved by 1, or beyond, whether it is above a face that it is on.
template <class Shape>
bool is_above_face(const Shape& shape, std::uint32_t vertex, const Vec3d& end, int side, const ExactCorners* exact) {
  const auto around = shape.triangles_around(vertex);
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t t) {
    const Vec3d& normal = exact ? exact->normal(t, vertex) : shape.triangle_normals[t];
    const double height = normal.dot(end);
    return std::abs(height - 1) <= kReachedTolerance && holds_foot(shape, t, vertex, (end - normal * height) * side);
  });
}

std::uint32_t corner_of(const Surface& surface, std::uint32_t triangle) { return surface.triangles[triangle][0]; }
std::uint32_t corner_of(const Polyline& line, std::uint32_t segment) { return line.segments[segment][0]; }

/// Whether what is closest is a detail of a vertex's corner, for a distance.
template <class Shape>
bool is_detail(const Shape& shape, std::uint32_t vertex, const Closest& closest, double distance) {
  return shape.component[corner_of(shape, closest.triangle)] == shape.component[vertex] &&
         (closest.point - shape.vertices[vertex]).length() <= kDetail * distance;
}

/// Whether a triangle of the vertex's component goes on in the plane of one of those around the vertex.
template <class Shape>
bool goes_on(const Shape& shape, std::uint32_t vertex, const Closest& closest) {
  if (shape.component[corner_of(shape, closest.triangle)] != shape.component[vertex]) return false;
  const Vec3d &normal = shape.triangle_normals[closest.triangle], away = closest.point - shape.vertices[vertex];
  const auto around = shape.triangles_around(vertex);
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t t) {
    const Vec3d& own = shape.triangle_normals[t];
    return own.lengthSqr() > 0 && (own - normal).lengthSqr() < kOnePlaneSine * kOnePlaneSine &&
           std::abs(own.dot(away)) <= kOnePlaneSine * away.length();
  });
}

/// Whether nothing is in the way of a miter, nor nearer to its end than the distance. If the vertex's own faces are
/// nearest to the end, nothing is in the way. Else it is gone back towards the vertex until they are, in steps that
/// cross nothing, as each is shorter than the distance before it; where one ends, nothing may be nearer than the
/// smaller distance whose miter ends there.
template <class Query>
bool is_way_free(const Query& query, std::uint32_t vertex, const Vec3d& end, Closest closest, double distance) {
  const auto& shape = query.surface();
  const Vec3d& start = shape.vertices[vertex];
  const double length = (end - start).length();
  double share = 1;  // of the way to the end
  for (int step = 0; step < kMostStepsBack; ++step) {
    const Vec3d x = start + (end - start) * share;
    if (step > 0) closest = query(x, closest.triangle);
    if (closest.distance < share * distance * (1 - kReachedTolerance)) return false;
    if (closest.distance >= distance_from_fan(shape, vertex, x) * (1 - kSameMiterDistance)) return true;
    share -= kFreeShare * closest.distance / length;
  }
  return false;
}

}  // namespace

template <class Query>
MiterFinder<Query>::MiterFinder(const Query& query, Corners corners, double longest, const Obstacles* obstacles,
                                std::span<const MiterWalls> walls, const ExactCorners* exact)
    : query_(query),
      corners_(corners),
      longest_(longest),
      obstacles_(obstacles),
      walls_(walls),
      exact_(exact),
      on_crease_(vertices_on_creases(query.surface())) {
  VDB_OFFSET_ASSERT(longest >= 1);
  for (std::uint32_t v = 0; v < on_crease_.size(); ++v)
    if (on_crease_[v] || (exact && exact->knows(v)))
      miters_.push_back({v, Vec3d(0.0), 0, {}, on_crease_[v] != 0, false});
  for_each_index(
      miters_.size(), [&](std::size_t i) { miters_[i] = unit_miter(miters_[i].vertex, miters_[i].on_crease); },
      kMitersTogether);
}

template <class Query>
const MiterWalls* MiterFinder<Query>::walls_of(std::uint32_t vertex) const {
  const auto own = std::lower_bound(walls_.begin(), walls_.end(), vertex,
                                    [](const MiterWalls& each, std::uint32_t other) { return each.vertex < other; });
  return own != walls_.end() && own->vertex == vertex ? &*own : nullptr;
}

/// The planes that the miter of a vertex has to be on, which keep to a border, or to walls.
template <class Query>
PlanesAround MiterFinder<Query>::planes_to_meet(std::uint32_t vertex, const ExactCorners* exact) const {
  const auto& shape = query_.surface();
  PlanesAround planes = planes_around(shape, vertex, exact);
  if (const MiterWalls* const own_walls = walls_of(vertex)) keep_to_walls(own_walls->normals, planes.normals);
  else
    for (Vec3d& plane : planes.normals) plane = shape.along_border(vertex, plane);
  return planes;
}

/// The miter of a vertex for a distance of 1.
template <class Query>
typename MiterFinder<Query>::UnitMiter MiterFinder<Query>::unit_miter(std::uint32_t vertex, bool on_crease) const {
  const auto& shape = query_.surface();
  const MiterWalls* const own_walls = walls_of(vertex);
  UnitMiter miter{
      vertex, Vec3d(0.0), 0, {}, on_crease, exact_ && exact_->knows(vertex) && !own_walls, own_walls != nullptr};
  const ExactCorners* const exact = miter.is_exact ? exact_ : nullptr;
  const auto point = miter_point(planes_to_meet(vertex, exact).normals);
  if (!point || point->excess > kMostExcess) return miter;
  miter.end = point->position;
  miter.excess = point->excess;
  for (const int side : {-1, 1})
    miter.is_above_face[side > 0] = is_above_face(shape, vertex, point->position, side, exact);
  return miter;
}

/// The miter of a vertex whose faces have distances of their own, as a multiple of the vertex's.
template <class Query>
typename MiterFinder<Query>::UnitMiter MiterFinder<Query>::own_miter(const UnitMiter& even, double distance,
                                                                     const OwnDistances& own) const {
  UnitMiter miter = even;
  miter.is_own = true;
  miter.end = Vec3d(0.0);
  miter.is_above_face = {};
  if (corners_ == Corners::Round) return miter;
  const auto& shape = query_.surface();
  const int side = distance < 0 ? -1 : 1;
  auto planes = own_planes_around(shape, even.vertex, side, even.is_exact ? exact_ : nullptr, own);
  if (!planes) return miter;
  if (!planes->staying.empty()) keep_to_walls(planes->staying, planes->moving);
  for (Vec3d& plane : planes->moving) plane = shape.along_border(even.vertex, plane);
  const auto point = miter_point(planes->moving);
  if (!point || point->excess > kMostExcess) return miter;
  miter.end = point->position * (planes->least / std::abs(distance));
  miter.excess = point->excess;
  return miter;
}

/// The unit miters, of which those of vertices with faces that have distances of their own are of these.
template <class Query>
std::vector<typename MiterFinder<Query>::UnitMiter> MiterFinder<Query>::unit_miters_of(const Asked& asked) const {
  std::vector<UnitMiter> units = miters_;
  if (!asked.own) return units;
  for_each_index(
      units.size(),
      [&](std::size_t i) {
        const double distance = asked.distances[units[i].vertex];
        if (asked.own->differ(units[i].vertex) && !units[i].at_walls && distance != 0)
          units[i] = own_miter(units[i], distance, *asked.own);
      },
      kMitersTogether);
  return units;
}

template <class Query>
std::pair<Vec3d, bool> MiterFinder<Query>::end_of(const UnitMiter& miter, double distance) const {
  if (miter.is_above_face[distance > 0]) return {miter.end, false};
  if (corners_ == Corners::Round) return {Vec3d(0.0), false};
  const double length = miter.end.length();
  if (length > longest_) return {miter.end * (longest_ / length), true};
  return {miter.end, false};
}

template <class Query>
bool MiterFinder<Query>::is_proven(Miter& miter, const UnitMiter& unit, const Vec3d& end, const Closest& closest,
                                   const Asked& from) const {
  const auto& shape = query_.surface();
  const Vec3d& start = shape.vertices[miter.vertex];
  const double distance = from.distances[miter.vertex];
  const double asked = unit.is_own ? from.own->least(miter.vertex) : std::abs(distance);
  // Nearer as triangles are flat, where the surface is not.
  if (unit.is_exact && closest.distance < asked * (1 - kReachedTolerance))
    return closest.distance >= asked - exact_->deflection() &&
           exact_->is_own(miter.vertex, end, distance < 0 ? -asked : asked, closest.triangle, closest.point) &&
           (!obstacles_ || ObstacleGuard(*obstacles_, start, distance < 0 ? -1 : 1).stop(start, end) == end);
  // On the plane of a face that stays, both distances are 0 but for rounding.
  const double rounding = kSameMiterDistance * miter.displacement.length();
  const bool is_own = closest.distance >= distance_from_fan(shape, miter.vertex, end) - rounding ||
                      is_detail(shape, miter.vertex, closest, asked) || goes_on(shape, miter.vertex, closest);
  miter.gives_way = !is_own;
  return (is_own || is_way_free(query_, miter.vertex, end, closest, asked)) &&
         closest.distance >= asked * (1 - kReachedTolerance) &&
         (!obstacles_ || ObstacleGuard(*obstacles_, start, distance < 0 ? -1 : 1).stop(start, end) == end);
}

/// Moves the ends of those miters of which the exact surface is known to where they are at the distance from it.
template <class Query>
void MiterFinder<Query>::bring_to_exact(std::span<const UnitMiter> units, const Asked& asked,
                                        std::span<Miter> miters) const {
  if (!exact_) return;
  const auto& shape = query_.surface();
  for (const bool of_own : {false, true}) {
    if (of_own && !asked.own) continue;
    std::vector<std::size_t> some;
    std::vector<std::uint32_t> vertices;
    std::vector<double> distances;
    std::vector<Vec3d> points;
    for (std::size_t i = 0; i < miters.size(); ++i) {
      if (!units[i].is_exact || units[i].is_own != of_own || miters[i].displacement == Vec3d(0.0) ||
          miters[i].state == VertexState::Cut)
        continue;
      some.push_back(i);
      vertices.push_back(miters[i].vertex);
      distances.push_back(asked.distances[miters[i].vertex]);
      points.push_back(shape.vertices[miters[i].vertex] + miters[i].displacement);
    }
    exact_->bring_to_distances(vertices, distances, of_own ? asked.own->at_corner() : std::span<const double>(),
                               points);
    for (std::size_t i = 0; i < some.size(); ++i)
      miters[some[i]].displacement =
          round_displacement(points[i] - shape.vertices[vertices[i]], std::abs(distances[i]));
  }
}

template <class Query>
void MiterFinder<Query>::prove(std::span<const UnitMiter> some, const Asked& from, std::span<Miter> miters,
                               std::span<std::uint8_t> proven) const {
  const auto& shape = query_.surface();
  std::vector<Vec3d> ends;
  std::vector<std::uint32_t> hints;
  for (std::size_t i = 0; i < some.size(); ++i) {
    ends.push_back((shape.vertices[some[i].vertex] + shape.origin) + miters[i].displacement - shape.origin);
    hints.push_back(shape.triangles_around(some[i].vertex).front());
  }
  std::vector<Closest> closest(ends.size());
  query_.answer_together(ends, hints, closest);
  for (std::size_t i = 0; i < some.size(); ++i) {
    const double asked = std::abs(from.distances[some[i].vertex]);
    Miter& miter = miters[i];
    miter.distance = closest[i].distance;
    miter.closest = closest[i].triangle;
    const bool is_proven_now = miter.displacement != Vec3d(0.0) && is_proven(miter, some[i], ends[i], closest[i], from);
    if ((some[i].is_exact || some[i].is_own) && is_proven_now && miter.distance < asked) {
      // On the plane of a face that stays it is 0, which would say that nothing is nearer.
      if (miter.distance < asked * (1 - kReachedTolerance))
        miter.nearer = std::max(miter.distance, std::numeric_limits<double>::min());
      miter.distance = asked;
    }
    if (miter.state != VertexState::Cut && std::abs(miter.distance - asked) <= kReachedTolerance * asked)
      miter.state = VertexState::Reached;
    proven[i] = is_proven_now && (corners_ == Corners::Miter || miter.state == VertexState::Reached);
  }
}

template <class Query>
std::pair<std::vector<Miter>, std::vector<std::uint8_t>> MiterFinder<Query>::prove(std::span<const UnitMiter> units,
                                                                                   const Asked& asked) const {
  std::vector<Miter> miters(units.size());
  std::vector<std::uint8_t> proven(units.size(), 0);
  for (std::size_t i = 0; i < miters.size(); ++i) {
    const double distance = asked.distances[units[i].vertex];
    const auto [end, is_cut] = end_of(units[i], distance);
    const Vec3d displacement = distance == 0 ? Vec3d(0.0) : round_displacement(end * distance, std::abs(distance));
    miters[i] = {units[i].vertex, displacement, 0, 0, 0, is_cut ? VertexState::Cut : VertexState::Mitered,
                 units[i].excess};
  }
  bring_to_exact(units, asked, miters);
  for_each_index((units.size() + kMitersTogether - 1) / kMitersTogether,
                 [&](std::size_t block) {
                   const std::size_t begin = block * kMitersTogether,
                                     count = std::min(kMitersTogether, units.size() - begin);
                   prove(units.subspan(begin, count), asked, std::span(miters).subspan(begin, count),
                         std::span(proven).subspan(begin, count));
                 },
                 1);
  return {std::move(miters), std::move(proven)};
}

/// The miter, for a distance of 1, on the planes of most of the area around a vertex.
template <class Query>
typename MiterFinder<Query>::UnitMiter MiterFinder<Query>::prevailing_miter(const UnitMiter& even) const {
  UnitMiter miter = even;
  miter.end = Vec3d(0.0);
  miter.is_above_face = {};
  const PlanesAround planes = planes_to_meet(even.vertex, even.is_exact ? exact_ : nullptr);
  const auto point = prevailing_point(planes.normals, planes.areas, longest_);
  if (!point) return miter;
  miter.end = *point;
  miter.excess = excess_of(planes.normals, *point);
  return miter;
}

template <class Query>
std::pair<std::vector<Miter>, std::vector<std::uint8_t>> MiterFinder<Query>::prove(const Asked& asked) const {
  auto [miters, proven] = prove(unit_miters_of(asked), asked);
  if (corners_ == Corners::Round) return {std::move(miters), std::move(proven)};
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < miters.size(); ++i)
    if (!proven[i] && miters_[i].on_crease && !(asked.own && asked.own->differ(miters_[i].vertex))) left.push_back(i);
  std::vector<UnitMiter> others(left.size());
  for_each_index(
      left.size(), [&](std::size_t k) { others[k] = prevailing_miter(miters_[left[k]]); }, kMitersTogether);
  const auto [other_miters, other_proven] = prove(others, asked);
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (!other_proven[k]) continue;
    miters[left[k]] = other_miters[k];
    proven[left[k]] = 1;
  }
  return {std::move(miters), std::move(proven)};
}

template <class Query>
std::vector<Miter> MiterFinder<Query>::all(const Distances& distances, const OwnDistances* own) const {
  std::vector<Miter> miters = prove({distances, own}).first;
  std::erase_if(miters, [&](const Miter& miter) {
    const bool is_own = own && own->differ(miter.vertex);
    return miter.displacement == Vec3d(0.0) ||
           (!is_own && miter.distance < std::abs(distances[miter.vertex]) * (1 - kReachedTolerance));
  });
  return miters;
}

template <class Query>
std::vector<Miter> MiterFinder<Query>::operator()(const Distances& distances, MiterFacts& facts,
                                                  const OwnDistances* own) const {
  const auto [miters, proven] = prove({distances, own});
  std::vector<Miter> kept;
  for (std::size_t i = 0; i < miters.size(); ++i) {
    if (distances[miters[i].vertex] == 0) continue;
    facts.on_creases += miters_[i].on_crease;
    if (!proven[i]) {
      facts.unproven += miters_[i].on_crease;
      continue;
    }
    kept.push_back(miters[i]);
  }
  return kept;
}

template class MiterFinder<ClosestQuery>;
template class MiterFinder<CurveQuery>;

}  // namespace vdb_offset
