// SPDX-License-Identifier: Apache-2.0
#include "motion/parts/border_slide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "ground/mesh/miter_point.h"
#include "ground/mesh/planes_around.h"
#include "ground/mesh/point_triangle.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// Sines: faces whose normals differ by less lie in one plane; faces that turn away from the part's side by more are
// extended. Reasoned: 30 degrees.
constexpr double kOnePlane = 0.5, kTurnsAway = -0.5;
// Longest path, in distances: a longer one gains too little per length. Not measured.
constexpr double kLongestSlide = 4;
// Step on a bent surface, in distances; and the least step, so that a slide ends. Not measured.
constexpr double kSlideStep = 0.125, kLeastStep = 1e-3;
// Step along an extension, by the rest of the distance. Reasoned: past the end, which is then cut.
constexpr double kBeyondEnd = 1.5;
// Share of the distance that the end may be off by. Reasoned: far below the promised 1e-6.
constexpr double kSlideTolerance = 1e-9;

/// The direction in which a border vertex leaves: a unit vector, and whether it leads over the faces that stay.
struct SlideDirection {
  Vec3d direction;
  bool on_surface;
  double longest = kLongestSlide;  ///< The longest path, in distances.
};

/// The faces of a part around a vertex at its border, as if they went on beyond the border's edges there: in the planes
/// of these edges' faces, up to where the two planes meet, or for ever, if that is one plane; where the mesh ends
/// beside the part, straight on along its end.
class FacesBeyond {
 public:
  /// \param goes_on (vertex of the part) whether the mesh goes on beyond the border's edge to that vertex
  template <class GoesOn>
  FacesBeyond(const Surface& part, std::uint32_t vertex, double size, GoesOn&& goes_on)
      : origin_(part.vertices[vertex]) {
    std::vector<Edge> edges;
    for (const auto t : part.triangles_around(vertex))
      for (std::uint32_t edge = 3 * t; edge < 3 * t + 3; ++edge) {
        const std::uint32_t from = part.from(edge), to = part.to(edge), other = from == vertex ? to : from;
        if (part.next_around_edge[edge] != edge || (from != vertex && to != vertex)) continue;
        edges.push_back({(part.vertices[other] - origin_).unit(), part.triangle_normals[t], goes_on(other)});
      }
    const Vec3d over = part.own_conormal(vertex);
    if (edges.size() != 2 || over.lengthSqr() == 0) return;
    const Vec3d middle = middle_of(edges[0], edges[1], over);
    for (const Edge& edge : edges) {
      // Halves of the angle, as a triangle that is wider than a right angle ends too near the vertex.
      const Vec3d half = edge.along + middle;
      if (!edge.goes_on || !(half.lengthSqr() > kOnePlaneSine * kOnePlaneSine)) continue;
      corners_.emplace_back(edge.along * size, half.unit() * size);
      corners_.emplace_back(half.unit() * size, middle * size);
    }
  }

  /// The distance of a point from what is beyond the border; infinite if that is not known.
  double distance_of(const Vec3d& x) const {
    double squared = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : corners_)
      squared = std::min(squared, closest_on_triangle(x, origin_, origin_ + a, origin_ + b).squared_distance);
    return std::sqrt(squared);
  }

 private:
  struct Edge {
    Vec3d along, normal;
    bool goes_on;
  };

  /// Where what is beyond one edge ends, and what is beyond the other one begins.
  static Vec3d middle_of(const Edge& a, const Edge& b, const Vec3d& over) {
    if (!a.goes_on) return -a.along;
    if (!b.goes_on) return -b.along;
    Vec3d middle = a.normal.cross(b.normal);
    if (middle.length() < kOnePlaneSine) middle = over - a.normal * a.normal.dot(over);
    middle.normalize();
    return middle.dot(over) < 0 ? -middle : middle;
  }

  Vec3d origin_;
  std::vector<std::pair<Vec3d, Vec3d>> corners_;  // of triangles with the vertex, relative to it
};

/// The slide of one border vertex.
class BorderVertex {
 public:
  BorderVertex(const MeshParts& parts, const ClosestQuery& moving_part, const ClosestQuery& rest, std::uint32_t vertex,
               double distance)
      : parts_(parts),
        whole_(*parts.whole),
        off_part_(parts.off_part),
        moving_part_(moving_part),
        rest_(rest),
        vertex_(vertex),
        on_part_(parts.part_vertex[vertex]),
        hint_(moving_part.surface().triangles_around(on_part_).front()),
        origin_(whole_.vertices[vertex]),
        target_(std::abs(distance)),
        side_(distance < 0 ? -1 : 1),
        part_normal_(moving_part.surface().vertex_normals[on_part_] * side_) {}

  /// The end of the slide: at the distance, if the vertex gets there.
  Vec3d slide() {
    const std::optional<SlideDirection> start = find_direction();
    return start ? slide(*start).first : origin_;
  }

  /// Where the vertex is at the distance from the part's faces as if these went on beyond the border; nothing if the
  /// moved faces meet those that stay too far away, or in no point.
  std::optional<Vec3d> meet() {
    const std::optional<SlideDirection> start = direction_to_meet();
    if (!start) return std::nullopt;
    beyond_.emplace(moving_part_.surface(), on_part_, 2 * kLongestSlide * target_,
                    [&](std::uint32_t other) { return goes_on_to(other); });
    const auto [end, arrived] = slide(*start);
    beyond_.reset();
    if (!arrived) return std::nullopt;
    return end;
  }

 private:
  /// Whether faces that stay have the edge to a vertex of the part.
  bool goes_on_to(std::uint32_t other_on_part) const {
    const auto around = whole_.triangles_around(vertex_);
    return std::any_of(around.begin(), around.end(), [&](std::uint32_t t) {
      const auto& corners = whole_.triangles[t];
      return off_part_[t] && std::any_of(corners.begin(), corners.end(),
                                         [&](std::uint32_t v) { return parts_.part_vertex[v] == other_on_part; });
    });
  }

  /// The end of a slide, and whether it is at the distance.
  std::pair<Vec3d, bool> slide(const SlideDirection& start) {
    Vec3d here = origin_, direction = start.direction;
    double phi = 0, gone = 0;
    while (gone < start.longest * target_) {
      // The distance rises by no more than the step.
      const double step = start.on_surface
                              ? std::max(std::min(target_ - phi, kSlideStep * target_), kLeastStep * target_)
                              : kBeyondEnd * (target_ - phi) + kLeastStep * target_;
      const Vec3d next = go(here, direction, step, start.on_surface);
      const double next_phi = distance_of(next);
      if (next_phi >= target_ * (1 - kSlideTolerance)) return {cut(here, direction, step, start.on_surface), true};
      if (!(next_phi > phi)) break;
      direction = next - here;
      if (!(direction.lengthSqr() > 0)) break;
      direction.normalize();
      gone += step;
      here = next;
      phi = next_phi;
    }
    return {here, false};
  }

  double distance_of(const Vec3d& x) const {
    const double distance = moving_part_(x, hint_).distance;
    return beyond_ ? std::min(distance, beyond_->distance_of(x)) : distance;
  }

  Vec3d go(const Vec3d& from, const Vec3d& direction, double step, bool on_surface) {
    const Vec3d x = from + direction * step;
    if (!on_surface) return x;
    const Vec3d there = on_rest(x);
    if (!moving_part_.surface().is_held(on_part_)) return there;
    constexpr int kMostTurns = 30;  // between planes and faces; not measured
    Vec3d held = in_planes(there);
    for (int i = 0; i < kMostTurns; ++i) {
      const Vec3d next = in_planes(on_rest(held));
      const bool settled = (next - held).length() <= kSlideTolerance * target_;
      held = next;
      if (settled) break;
    }
    return held;
  }

  Vec3d on_rest(const Vec3d& x) {
    const Closest closest = rest_(x, rest_hint_);
    rest_hint_ = closest.triangle;
    return closest.point;
  }

  /// The closest position to this in the planes that hold the vertex, if any do.
  Vec3d in_planes(const Vec3d& x) const { return origin_ + moving_part_.surface().along_border(on_part_, x - origin_); }

  /// Bisection on the length of the last step.
  Vec3d cut(const Vec3d& here, const Vec3d& direction, double step, bool on_surface) {
    double low = 0, high = step;
    constexpr int kHalvings = 60;  // reasoned: down to rounding
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (low + high) / 2, phi = distance_of(go(here, direction, middle, on_surface));
      if (std::abs(phi - target_) <= kSlideTolerance * target_) return go(here, direction, middle, on_surface);
      (phi < target_ ? low : high) = middle;
    }
    return go(here, direction, low, on_surface);
  }

  /// Away from the part, over the faces that stay around the vertex, at right angles to the border.
  Vec3d away_from_part() const {
    Vec3d sum(0.0);
    for (const auto t : whole_.triangles_around(vertex_)) {
      if (!off_part_[t]) continue;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t edge = 3 * t + k, from = whole_.from(edge), to = whole_.to(edge);
        if ((from != vertex_ && to != vertex_) || off_part_[whole_.next_around_edge[edge] / 3]) continue;
        const Vec3d along = whole_.vertices[to] - whole_.vertices[from];
        const Vec3d third = whole_.vertices[whole_.triangles[t][(k + 2) % 3]] - whole_.vertices[from];
        const Vec3d across = third - along * (third.dot(along) / along.lengthSqr());
        if (across.lengthSqr() > 0) sum += across.unit();
      }
    }
    if (sum.lengthSqr() > 0) return sum;
    for (const auto t : whole_.triangles_around(vertex_))  // the part and the faces that stay only touch here
      if (off_part_[t])
        for (const auto v : whole_.triangles[t]) sum += whole_.vertices[v] - origin_;
    return sum;
  }

  std::optional<SlideDirection> find_direction() const {
    Vec3d mean(0.0), first(0.0), crease(0.0);
    for (const auto t : whole_.triangles_around(vertex_)) {
      const Vec3d& n = whole_.triangle_normals[t];
      if (!off_part_[t] || n.lengthSqr() == 0) continue;
      mean += n;
      if (first.lengthSqr() == 0) first = n;
      const Vec3d across = first.cross(n);
      if (across.lengthSqr() > crease.lengthSqr()) crease = across;
    }
    Vec3d away = away_from_part();
    if (crease.length() > kOnePlane) {
      crease.normalize();
      for (const auto t : whole_.triangles_around(vertex_))
        if (off_part_[t] && std::abs(whole_.triangle_normals[t].dot(crease)) > kOnePlane) return std::nullopt;
      away = crease * (away.dot(crease) < 0 ? -1.0 : 1.0);
    } else {
      if (!(mean.lengthSqr() > 0)) return std::nullopt;
      mean.normalize();
      away -= mean * away.dot(mean);
    }
    if (moving_part_.surface().is_held(on_part_)) away = moving_part_.surface().along_border(on_part_, away);
    if (!(away.lengthSqr() > 0) || !(part_normal_.lengthSqr() > 0)) return std::nullopt;
    away.normalize();
    const bool turns_away = away.dot(part_normal_.unit()) < kTurnsAway;
    return SlideDirection{turns_away ? -away : away, !turns_away};
  }

  /// The direction to where the part's moved faces meet those that stay: along the line where these meet, if they are
  /// two planes, else over one plane, which they bend from by little.
  std::optional<SlideDirection> direction_to_meet() const {
    const std::vector<Vec3d> walls = planes_that_stay(parts_, vertex_);
    if (walls.empty() || !(part_normal_.lengthSqr() > 0)) return std::nullopt;
    if (walls.size() <= 2)
      if (const auto direction = direction_to_meet(walls)) return direction;
    Vec3d mean(0.0);
    for (const Vec3d& wall : walls) mean += wall;
    if (!(mean.lengthSqr() > 0)) return std::nullopt;
    mean.normalize();
    const auto bends = [&](const Vec3d& wall) { return wall.dot(mean) <= 0 || wall.cross(mean).length() > kOnePlane; };
    if (std::any_of(walls.begin(), walls.end(), bends)) return std::nullopt;
    return direction_to_meet({&mean, 1});
  }

  std::optional<SlideDirection> direction_to_meet(std::span<const Vec3d> planes) const {
    const Surface& part = moving_part_.surface();
    std::vector<Vec3d> walls(planes.begin(), planes.end());
    if (part.is_held(on_part_)) {
      const Vec3d& held = part.conormals[on_part_];
      const auto is_same = [&](const Vec3d& wall) { return wall.cross(held).length() < kOnePlaneSine; };
      if (std::none_of(walls.begin(), walls.end(), is_same)) walls.push_back(held);
      if (walls.size() > 2 || part.held[on_part_] > 1) return std::nullopt;
    }
    std::vector<Vec3d> normals = planes_around(part, on_part_, [&](std::uint32_t t) -> const Vec3d& {
                                   return part.triangle_normals[t];
                                 }).normals;
    keep_to_walls(walls, normals);
    const std::optional<MiterPoint> point = miter_point(normals);
    if (!point || point->excess > kMostExcess || point->position.length() > kLongestSlide) return std::nullopt;
    const Vec3d direction = point->position.unit() * side_;
    return SlideDirection{direction, away_from_part().dot(direction) > 0, 2 * kLongestSlide};
  }

  const MeshParts& parts_;
  const Surface& whole_;
  const std::vector<std::uint8_t>& off_part_;
  const ClosestQuery& moving_part_;
  const ClosestQuery& rest_;
  std::uint32_t vertex_, on_part_, hint_, rest_hint_ = 0;
  Vec3d origin_;
  double target_;
  int side_;
  Vec3d part_normal_;                  // to the side asked for
  std::optional<FacesBeyond> beyond_;  // while the end is searched for
};

}  // namespace

BorderSlides::BorderSlides(const MeshParts& parts, const ClosestQuery& moving_part)
    : parts_(parts), moving_part_(moving_part), rest_(*parts.rest) {
  VDB_OFFSET_ASSERT(parts.whole && parts.rest);
}

Vec3d BorderSlides::operator()(std::uint32_t vertex, double distance) const {
  return BorderVertex(parts_, moving_part_, rest_, vertex, distance).slide();
}

std::optional<Vec3d> BorderSlides::meet(std::uint32_t vertex, double distance) const {
  return BorderVertex(parts_, moving_part_, rest_, vertex, distance).meet();
}

bool BorderSlides::lead(std::uint32_t vertex) const {
  constexpr double kInPlane = 1e-6;  // of a normal's cosine
  const Surface& moving_part = moving_part_.surface();
  const std::uint32_t on_part = parts_.part_vertex[vertex];
  if (!moving_part.is_held(on_part)) return true;
  const auto around = parts_.whole->triangles_around(vertex);
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t t) {
    const Vec3d& n = parts_.whole->triangle_normals[t];
    return parts_.off_part[t] && n.lengthSqr() > 0 && std::abs(n.dot(moving_part.conormals[on_part])) < 1 - kInPlane;
  });
}

std::vector<Vec3d> planes_that_stay(const MeshParts& parts, std::uint32_t vertex) {
  const Surface& whole = *parts.whole;
  std::vector<Vec3d> planes;
  for (const auto t : whole.triangles_around(vertex)) {
    const Vec3d& n = whole.triangle_normals[t];
    if (!parts.off_part[t] || n.lengthSqr() == 0) continue;
    const auto is_same = [&](const Vec3d& plane) { return plane.cross(n).length() < kOnePlaneSine; };
    if (std::none_of(planes.begin(), planes.end(), is_same)) planes.push_back(n);
  }
  return planes;
}

void slide_borders(MeshParts& parts, const BorderSlides& slides, const ClosestQuery& moving_part,
                   const Distances& distances, Paths& paths) {
  VDB_OFFSET_ASSERT(paths.displacement.size() == moving_part.surface().vertices.size());
  std::vector<std::uint32_t> border;
  for (std::uint32_t v = 0; v < parts.at_border.size(); ++v)
    if (parts.at_border[v] && distances[parts.part_vertex[v]] != 0 && slides.lead(v)) border.push_back(v);
  parts.bound.assign(parts.at_border.begin(), parts.at_border.end());
  const auto move = [&](std::size_t i) {
    const std::uint32_t v = border[i], f = parts.part_vertex[v];
    const double target = std::abs(distances[f]);
    paths.displacement[f] = round_displacement(slides(v, distances[f]) - parts.whole->vertices[v], target);
    const Vec3d position = (moving_part.surface().vertices[f] + moving_part.surface().origin) + paths.displacement[f];
    const Closest closest =
        moving_part(position - moving_part.surface().origin, moving_part.surface().triangles_around(f).front());
    if (!paths.trace.empty()) paths.trace[f].clear();
    paths.achieved[f] = closest.distance;
    paths.closest[f] = closest.triangle;
    const double tolerance = kReachedTolerance * target + position.length() * std::numeric_limits<double>::epsilon();
    paths.state[f] = std::abs(paths.achieved[f] - target) <= tolerance ? VertexState::Reached : VertexState::Collision;
  };
  for_each_index(border.size(), move, 16);
}

}  // namespace vdb_offset
