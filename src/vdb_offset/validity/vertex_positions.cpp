#include "vdb_offset/validity/vertex_positions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/paths/propagate.h"

namespace vdb_offset {
namespace {

constexpr std::size_t kBlock = 64;  // vertices that are looked at together

/// Calls work(some) for runs of vertices, in parallel.
template <class Work>
void for_each_block(std::span<const std::uint32_t> vertices, Work&& work) {
  for_each_index((vertices.size() + kBlock - 1) / kBlock,
                 [&](std::size_t block) {
                   work(vertices.subspan(block * kBlock, std::min(kBlock, vertices.size() - block * kBlock)));
                 },
                 1);
}

/// By more than rounding: what stands at a right angle to the way does not.
bool turns_from(const Vec3d& outward, const Vec3d& away) {
  constexpr double kRightAngle = 1e-9;
  const double along = outward.dot(away);
  return along < 0 && along * along > kRightAngle * kRightAngle * outward.lengthSqr() * away.lengthSqr();
}

}  // namespace

VertexPositions::VertexPositions(const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                                 const Distances& distances, Rounding precision)
    : constrained_(constrained),
      surface_(constrained.surface),
      source_(source),
      distances_(distances),
      near_(1e-3 * distances.scale()),
      precision_(precision),
      place_(source.begin(), source.end()),
      away_(source.size()),
      distance_(source.size()),
      closest_(source.size(), kNone),
      right_side_(source.size(), 1),
      nearness_(source.size(), Sole) {
  if (constrained.file) written_.assign(constrained.file->source.begin(), constrained.file->source.end());
}

void VertexPositions::move(const Indices& vertices, const std::function<Vec3d(std::uint32_t)>& place_of,
                           const Paths* ends) {
  for_each_block(vertices, [&](std::span<const std::uint32_t> some) {
    for (const auto v : some) put(v, place_of(v));
    measure(some, ends);
  });
}

void VertexPositions::put(std::uint32_t v, const Vec3d& place) {
  if (constrained_.is_of_obstacle(v)) return;
  if (constrained_.file) {
    written_[v] = constrained_.file->of(v, source_[v], place, precision_);
    place_[v] =
        written_[v] == constrained_.file->source[v] ? source_[v] : constrained_.file->space.metric().to(written_[v]);
  } else {
    place_[v] = precision_(source_[v], place);
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

/// Whether a vertex stands where its path ended, rounded: then the closest point is no nearer, to as much, than the one
/// around what was closest there, phi being 1-Lipschitz.
bool VertexPositions::is_known(std::uint32_t v, const Vec3d& x, const Paths& ends) const {
  constexpr double kSamePlace = 1e-11, kLittle = 1e-2, kFar = 2;
  const double same = kSamePlace * ends.achieved[v] + std::min(2 * rounding(v), kLittle * ends.achieved[v]);
  return ends.closest[v] != kNone && ends.achieved[v] > kFar * near_ &&
         (x - surface_.vertices[v] - ends.displacement[v]).length() <= same;
}

void VertexPositions::measure(std::span<const std::uint32_t> vertices, const Paths* ends) {
  const Surface& front = constrained_.front.surface();
  Indices unknown;
  for (const auto v : vertices) {
    // What stands where it was is on the front, or no part of it.
    if (!has_moved(v) || !constrained_.on_front(v)) {
      away_[v] = Vec3d(0.0);
      distance_[v] = 0;
      closest_[v] = kNone;
      right_side_[v] = 1;
      nearness_[v] = Sole;
      continue;
    }
    const Vec3d x = in_frame(v);
    if (ends && is_known(v, x, *ends)) {
      std::uint32_t triangle = ends->closest[v];
      const TrianglePoint nearest = front.walk_to_closest(x, triangle);
      take(v, x, {std::sqrt(nearest.squared_distance), triangle, nearest.feature, false, nearest.point}, Found);
    } else {
      unknown.push_back(v);
    }
  }
  look_closely(unknown);
}

/// At all of the front.
void VertexPositions::look_closely(std::span<const std::uint32_t> vertices) {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> hints;
  for (const auto v : vertices) {
    points.push_back(in_frame(v));
    hints.push_back(closest_[v] != kNone ? closest_[v] : constrained_.hint(v));
  }
  std::vector<Closest> answers(points.size());
  constrained_.front.answer_together(points, hints, answers);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    take(vertices[i], points[i], answers[i], answers[i].tied ? Tied : Sole);
}

void VertexPositions::take(std::uint32_t v, const Vec3d& x, const Closest& closest, Nearness nearness) {
  const Surface& front = constrained_.front.surface();
  distance_[v] = closest.distance;
  closest_[v] = closest.triangle;
  away_[v] = x - closest.point;
  nearness_[v] = nearness;
  right_side_[v] = 1;
  const int side = distances_[v] < 0 ? -1 : 1;
  if (front.facts.closed() && front.facts.oriented() && closest.distance > near_)
    right_side_[v] = side * front.pseudonormal(closest.triangle, closest.feature).dot(away_[v]) > 0;
}

void VertexPositions::look_around(const Indices& triangles) {
  std::vector<std::uint8_t> chosen(place_.size(), 0);
  Indices vertices;
  for (const auto t : triangles) {
    const auto& corners = surface_.triangles[t];
    if (!constrained_.is_front(t) || std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
          return chosen[v] || (nearness_[v] != Found && distance_[v] >= near_);
        }))
      continue;
    // The one that most clearly is the right way round, as far as is known.
    const Vec3d outward = twice_area(t, place_) * side(t);
    std::uint32_t best = kNone;
    double most = 0;
    for (const auto v : corners) {
      if (nearness_[v] != Found) continue;
      const double along = outward.dot(away_[v]) / distance_[v];
      if (best == kNone || along > most) best = v, most = along;
    }
    if (best == kNone) continue;
    chosen[best] = 1;
    vertices.push_back(best);
  }
  std::sort(vertices.begin(), vertices.end());
  for_each_block(vertices, [&](std::span<const std::uint32_t> some) { look_closely(some); });
}

VertexPositions::VertexPosition VertexPositions::operator[](std::uint32_t v) const {
  return {place_[v], in_file()[v], away_[v], distance_[v], closest_[v], right_side_[v], nearness_[v]};
}

void VertexPositions::put_back(std::uint32_t v, const VertexPosition& stand) {
  place_[v] = stand.place;
  if (constrained_.file) written_[v] = stand.written;
  away_[v] = stand.away;
  distance_[v] = stand.distance;
  closest_[v] = stand.closest;
  right_side_[v] = stand.right_side;
  nearness_[v] = stand.nearness;
}

double VertexPositions::rounding(std::uint32_t v) const {
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, std::abs(place_[v][k]));
  return size * precision_.epsilon();
}

bool VertexPositions::is_misplaced(std::uint32_t v) const {
  return !right_side_[v] || distance_[v] > std::abs(distances_[v]) * (1 + kReachedTolerance) + rounding(v);
}

Vec3d VertexPositions::twice_area(std::uint32_t t, std::span<const Vec3d> at) const {
  const auto& [a, b, c] = surface_.triangles[t];
  return (at[b] - at[a]).cross(at[c] - at[a]);
}

int VertexPositions::side(std::uint32_t t) const {
  const auto& [a, b, c] = surface_.triangles[t];
  return distances_[a] + distances_[b] + distances_[c] < 0 ? -1 : 1;
}

/// Whether what is turned outward turns from no point of the front that is as near to x as the closest.
bool VertexPositions::looks_away(const Vec3d& outward, const Vec3d& x, const Vec3d& away, double distance,
                                 bool tied) const {
  if (turns_from(outward, away)) return false;
  bool from_all = true;
  if (tied)
    constrained_.front.visit_as_near(
        x, distance, [&](const Vec3d& point) { from_all = from_all && !turns_from(outward, x - point); });
  return from_all;
}

bool VertexPositions::looks_away(const Vec3d& outward, std::uint32_t v) const {
  const Vec3d x = in_frame(v);
  if (nearness_[v] != Found) return looks_away(outward, x, away_[v], distance_[v], nearness_[v] == Tied);
  const Closest closest = constrained_.front(x, closest_[v]);
  return looks_away(outward, x, x - closest.point, closest.distance, closest.tied);
}

bool VertexPositions::faces_against_front(std::uint32_t t) const {
  const auto& [a, b, c] = surface_.triangles[t];
  const Vec3d now = twice_area(t, place_), outward = now * side(t);
  bool any = false;
  // What is known costs next to nothing.
  for (const bool known : {true, false})
    for (const auto v : {a, b, c}) {
      if (distance_[v] < near_ || (nearness_[v] != Found) != known) continue;
      any = true;
      if (looks_away(outward, v)) return false;
    }
  const Vec3d centre = (place_[a] + place_[b] + place_[c]) / 3.0 - constrained_.front.surface().origin;
  const Closest closest = constrained_.front(centre, constrained_.hint(a));
  if (closest.distance >= near_)
    return !looks_away(outward, centre, centre - closest.point, closest.distance, closest.tied);
  return any || now.dot(twice_area(t, source_)) < 0;
}

}  // namespace vdb_offset
