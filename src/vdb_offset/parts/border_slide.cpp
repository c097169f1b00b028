// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/parts/border_slide.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "vdb_offset/base/assert.h"
#include "vdb_offset/base/parallel.h"

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
};

/// The slide of one border vertex.
class BorderVertex {
 public:
  BorderVertex(const MeshParts& parts, const ClosestQuery& moving_part, const ClosestQuery& rest, std::uint32_t vertex,
               double distance)
      : whole_(*parts.whole),
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
    if (!start) return origin_;
    Vec3d here = origin_, direction = start->direction;
    double phi = 0, gone = 0;
    while (gone < kLongestSlide * target_) {
      // The distance rises by no more than the step.
      const double step = start->on_surface
                              ? std::max(std::min(target_ - phi, kSlideStep * target_), kLeastStep * target_)
                              : kBeyondEnd * (target_ - phi) + kLeastStep * target_;
      const Vec3d next = go(here, direction, step, start->on_surface);
      const double next_phi = distance_of(next);
      if (next_phi >= target_ * (1 - kSlideTolerance)) return cut(here, direction, step, start->on_surface);
      if (!(next_phi > phi)) break;
      direction = next - here;
      if (!(direction.lengthSqr() > 0)) break;
      direction.normalize();
      gone += step;
      here = next;
      phi = next_phi;
    }
    return here;
  }

 private:
  double distance_of(const Vec3d& x) const { return moving_part_(x, hint_).distance; }

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

  const Surface& whole_;
  const std::vector<std::uint8_t>& off_part_;
  const ClosestQuery& moving_part_;
  const ClosestQuery& rest_;
  std::uint32_t vertex_, on_part_, hint_, rest_hint_ = 0;
  Vec3d origin_;
  double target_;
  int side_;
  Vec3d part_normal_;  // to the side asked for
};

}  // namespace

BorderSlides::BorderSlides(const MeshParts& parts, const ClosestQuery& moving_part)
    : parts_(parts), moving_part_(moving_part), rest_(*parts.rest) {
  VDB_OFFSET_ASSERT(parts.whole && parts.rest);
}

Vec3d BorderSlides::operator()(std::uint32_t vertex, double distance) const {
  return BorderVertex(parts_, moving_part_, rest_, vertex, distance).slide();
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
    paths.state[f] = std::abs(paths.achieved[f] - target) <= kReachedTolerance * target ? VertexState::Reached
                                                                                        : VertexState::Collision;
  };
  for_each_index(border.size(), move, 16);
}

}  // namespace vdb_offset
