// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/vertex_positions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "motion/paths/propagate.h"
#include "space/surface/border_planes.h"

namespace vdb_offset {
namespace {

// Vertices that are measured together, as the exact query answers neighbours together. Not measured.
constexpr std::size_t kVerticesTogether = 64;

// Share of the largest distance: a position that is nearer to the moving part says nothing about sides. Reasoned: its
// direction away is mostly rounding.
constexpr double kNear = 1e-3;

/// Calls work(some) for runs of vertices, in parallel.
template <class Work>
void for_each_block(std::span<const std::uint32_t> vertices, Work&& work) {
  for_each_index((vertices.size() + kVerticesTogether - 1) / kVerticesTogether,
                 [&](std::size_t block) {
                   work(vertices.subspan(block * kVerticesTogether,
                                         std::min(kVerticesTogether, vertices.size() - block * kVerticesTogether)));
                 },
                 1);
}

/// The side that a triangle goes to: 1 outward, -1 inward.
int side_of(const Distances& distances, const std::array<std::uint32_t, 3>& corners) {
  const auto& [a, b, c] = corners;
  return distances[a] + distances[b] + distances[c] < 0 ? -1 : 1;
}

/// Whether a direction turns from another by more than a right angle, and more than rounding.
bool turns_from(const Vec3d& outward, const Vec3d& away) {
  constexpr double kRightAngle = 1e-9;  // cosine; reasoned: far above rounding
  const double along = outward.dot(away);
  return along < 0 && along * along > kRightAngle * kRightAngle * outward.lengthSqr() * away.lengthSqr();
}

/// Calls visit(feature) for the features of a triangle on whose normals x lies, but for rounding, if `closest` is the
/// triangle's closest point. At the end of an edge these are the edge and the corner.
template <class Visit>
void for_each_feature_before(const Surface& surface, std::uint32_t triangle, const Vec3d& x,
                             const TrianglePoint& closest, Visit&& visit) {
  constexpr double kSame = 1e-6;  // share of the distance; reasoned: far above rounding, far below what faces differ by
  const auto& corners = surface.triangles[triangle];
  const Vec3d away = x - closest.point;
  const double slack = kSame * away.length();
  visit(closest.feature);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const Vec3d& start = surface.vertices[corners[k]];
    const Vec3d edge = surface.vertices[corners[(k + 1) % 3]] - start, from_start = closest.point - start;
    if (from_start.length() <= slack) visit(static_cast<Feature>(k));
    const double length = edge.length();
    if (!(length > 0) || std::abs(away.dot(edge)) > slack * length) continue;
    if (from_start.cross(edge).length() <= slack * length) visit(static_cast<Feature>(3 + k));
  }
  const Vec3d& normal = surface.triangle_normals[triangle];
  if ((away - normal * normal.dot(away)).length() <= slack) visit(Feature::Face);
}

}  // namespace

VertexPositions::VertexPositions(const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                                 const Distances& distances, Rounding precision)
    : constrained_(constrained),
      surface_(constrained.surface),
      source_(source),
      distances_(distances),
      near_(kNear * distances.scale()),
      precision_(std::move(precision)),
      position_(source.begin(), source.end()),
      away_(source.size()),
      distance_(source.size()),
      closest_(source.size(), kNone),
      right_side_(source.size(), 1),
      nearness_(source.size(), Nearness::Sole) {
  VDB_OFFSET_ASSERT(source.size() == surface_.vertices.size());
  VDB_OFFSET_ASSERT(distances.uniform() || distances.count() == source.size());
  VDB_OFFSET_ASSERT(!constrained.file || constrained.file->source.size() == source.size());
  if (constrained.file) written_.assign(constrained.file->source.begin(), constrained.file->source.end());
}

void VertexPositions::move(const Indices& vertices, const std::function<Vec3d(std::uint32_t)>& position_of,
                           const Paths* ends) {
  VDB_OFFSET_ASSERT(is_index_set(vertices, position_.size()));
  for_each_block(vertices, [&](std::span<const std::uint32_t> some) {
    for (const auto v : some) put(v, position_of(v));
    measure(some, ends);
  });
}

void VertexPositions::put(std::uint32_t v, const Vec3d& position) {
  if (constrained_.is_of_obstacle(v)) return;
  if (constrained_.file) {
    written_[v] = constrained_.file->of(v, source_[v], position, precision_);
    position_[v] =
        written_[v] == constrained_.file->source[v] ? source_[v] : constrained_.file->space.metric().to(written_[v]);
  } else {
    position_[v] = precision_(source_[v], position);
  }
}

bool VertexPositions::has_moved(std::uint32_t v) const {
  if (constrained_.is_of_obstacle(v)) return false;
  const Vec3d &before = constrained_.file ? constrained_.file->source[v] : source_[v], &now = in_file()[v];
  return now != before && !precision_.stays(before, now);
}

bool VertexPositions::has_moved_corner(std::uint32_t t) const {
  const auto& corners = surface_.triangles[t];
  return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return has_moved(v); });
}

/// Whether a vertex stands where its path ended, but for rounding: then the closest point is no nearer, but for as
/// much, than the closest one of the triangles around the closest triangle there, phi being 1-Lipschitz.
bool VertexPositions::is_known(std::uint32_t v, const Vec3d& x, const Paths& ends) const {
  // Shares of the distance: what displacements are rounded to, and the most that rounding may be; and how many times
  // near_ the distance has to be. Reasoned.
  constexpr double kSamePosition = 1e-11, kLittle = 1e-2, kFar = 2;
  const double same = kSamePosition * ends.achieved[v] + std::min(2 * rounding(v), kLittle * ends.achieved[v]);
  return ends.closest[v] != kNone && ends.achieved[v] > kFar * near_ &&
         (x - surface_.vertices[v] - ends.displacement[v]).length() <= same;
}

void VertexPositions::measure(std::span<const std::uint32_t> vertices, const Paths* ends) {
  const Surface& moving_part = constrained_.moving_part.surface();
  Indices unknown;
  for (const auto v : vertices) {
    // A vertex that has not moved is on the moving part, unless it is no vertex of that.
    if (!has_moved(v) || !constrained_.vertex_on_part(v)) {
      away_[v] = Vec3d(0.0);
      distance_[v] = 0;
      closest_[v] = kNone;
      right_side_[v] = 1;
      nearness_[v] = Nearness::Sole;
      continue;
    }
    const Vec3d x = in_frame(v);
    if (ends && is_known(v, x, *ends)) {
      std::uint32_t triangle = ends->closest[v];
      const TrianglePoint nearest = moving_part.walk_to_closest(x, triangle);
      take(v, x, {std::sqrt(nearest.squared_distance), triangle, nearest.feature, false, nearest.point},
           Nearness::Found);
    } else {
      unknown.push_back(v);
    }
  }
  measure_exactly(unknown);
}

/// Measures vertices by the exact query.
void VertexPositions::measure_exactly(std::span<const std::uint32_t> vertices) {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> hints;
  for (const auto v : vertices) {
    points.push_back(in_frame(v));
    hints.push_back(closest_[v] != kNone ? closest_[v] : constrained_.hint(v));
  }
  std::vector<Closest> answers(points.size());
  constrained_.moving_part.answer_together(points, hints, answers);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    take(vertices[i], points[i], answers[i], answers[i].tied ? Nearness::Tied : Nearness::Sole);
}

void VertexPositions::take(std::uint32_t v, const Vec3d& x, const Closest& closest, Nearness nearness) {
  const Surface& moving_part = constrained_.moving_part.surface();
  distance_[v] = closest.distance;
  closest_[v] = closest.triangle;
  away_[v] = x - closest.point;
  nearness_[v] = nearness;
  right_side_[v] = 1;
  const int side = distances_[v] < 0 ? -1 : 1;
  if (moving_part.facts.closed() && moving_part.facts.oriented() && closest.distance > near_)
    right_side_[v] = is_on_side(side, x, closest);
}

/// Whether a position is on a side, by any point that is as near as the closest point. Where the moving part
/// crosses itself, an edge and its end may disagree, and rounding chooses between them.
bool VertexPositions::is_on_side(int side, const Vec3d& x, const Closest& closest) const {
  const Surface& moving_part = constrained_.moving_part.surface();
  const auto tells_so = [&](std::uint32_t t, Feature feature, const Vec3d& point) {
    return side * moving_part.pseudonormal(t, feature).dot(x - point) > 0;
  };
  if (tells_so(closest.triangle, closest.feature, closest.point)) return true;
  bool any = false;
  constrained_.moving_part.visit_as_near(x, closest.distance, [&](std::uint32_t t, const TrianglePoint& at) {
    for_each_feature_before(moving_part, t, x, at,
                            [&](Feature feature) { any = any || tells_so(t, feature, at.point); });
  });
  return any;
}

void VertexPositions::find_ties_around(const Indices& triangles) {
  std::vector<std::uint8_t> chosen(position_.size(), 0);
  Indices vertices;
  for (const auto t : triangles) {
    const auto& corners = surface_.triangles[t];
    if (!constrained_.triangle_on_part(t) || std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
          return chosen[v] || (nearness_[v] != Nearness::Found && distance_[v] >= near_);
        }))
      continue;
    // The corner where the triangle most clearly is the right way round, as far as is known.
    const Vec3d outward = twice_area(surface_.triangles[t], position_) * side_of(distances_, surface_.triangles[t]);
    std::uint32_t best = kNone;
    double most = 0;
    for (const auto v : corners) {
      if (nearness_[v] != Nearness::Found) continue;
      const double along = outward.dot(away_[v]) / distance_[v];
      if (best == kNone || along > most) best = v, most = along;
    }
    if (best == kNone) continue;
    chosen[best] = 1;
    vertices.push_back(best);
  }
  std::sort(vertices.begin(), vertices.end());
  for_each_block(vertices, [&](std::span<const std::uint32_t> some) { measure_exactly(some); });
}

VertexPositions::Standing VertexPositions::operator[](std::uint32_t v) const {
  return {position_[v], in_file()[v], away_[v], distance_[v], closest_[v], right_side_[v], nearness_[v]};
}

void VertexPositions::put_back(std::uint32_t v, const Standing& standing) {
  position_[v] = standing.position;
  if (constrained_.file) written_[v] = standing.written;
  away_[v] = standing.away;
  distance_[v] = standing.distance;
  closest_[v] = standing.closest;
  right_side_[v] = standing.right_side;
  nearness_[v] = standing.nearness;
}

double VertexPositions::rounding(std::uint32_t v) const {
  return precision_.most_off(position_[v]) + vertex_error_at(constrained_.vertex_error, distances_[v]);
}

bool VertexPositions::is_misplaced(std::uint32_t v) const {
  const double farther = constrained_.farther.empty() ? 0 : constrained_.farther[v];
  return !on_right_side(v) ||
         distance_[v] > std::max(farther, std::abs(distances_[v])) * (1 + kReachedTolerance) + rounding(v);
}

bool VertexPositions::is_beyond_wall(std::uint32_t v) const {
  const Surface& moving_part = constrained_.moving_part.surface();
  if (moving_part.walls.empty() || !constrained_.vertex_on_part(v) || !has_moved(v)) return false;
  return vdb_offset::is_beyond_wall(moving_part, constrained_.part_vertex_of(v), position_[v] - moving_part.origin,
                                    rounding(v));
}

/// Whether a direction turns from no point of the moving part that is as near to x as the closest.
bool VertexPositions::looks_away(const Vec3d& outward, const Vec3d& x, const Vec3d& away, double distance,
                                 bool tied) const {
  if (turns_from(outward, away)) return false;
  bool from_all = true;
  if (tied)
    constrained_.moving_part.visit_as_near(x, distance, [&](std::uint32_t, const TrianglePoint& at) {
      from_all = from_all && !turns_from(outward, x - at.point);
    });
  return from_all;
}

bool VertexPositions::looks_away(const Vec3d& outward, std::uint32_t v) const {
  const Vec3d x = in_frame(v);
  if (nearness_[v] != Nearness::Found)
    return looks_away(outward, x, away_[v], distance_[v], nearness_[v] == Nearness::Tied);
  const Closest closest = constrained_.moving_part(x, closest_[v]);
  return looks_away(outward, x, x - closest.point, closest.distance, closest.tied);
}

bool VertexPositions::faces_against_part(const std::array<std::uint32_t, 3>& triangle) const {
  const auto& [a, b, c] = triangle;
  const Vec3d now = twice_area(triangle, position_), outward = now * side_of(distances_, triangle);
  bool any = false;
  // Corners of which ties are known cost next to nothing, and go first.
  for (const bool known : {true, false})
    for (const auto v : {a, b, c}) {
      if (distance_[v] < near_ || (nearness_[v] != Nearness::Found) != known) continue;
      any = true;
      if (looks_away(outward, v)) return false;
    }
  const Vec3d centre = (position_[a] + position_[b] + position_[c]) / 3.0 - constrained_.moving_part.surface().origin;
  const Closest closest = constrained_.moving_part(centre, constrained_.hint(a));
  if (closest.distance >= near_)
    return !looks_away(outward, centre, centre - closest.point, closest.distance, closest.tied);
  return any || now.dot(twice_area(triangle, source_)) < 0;
}

}  // namespace vdb_offset
