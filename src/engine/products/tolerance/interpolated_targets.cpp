// SPDX-License-Identifier: Apache-2.0
// Finds where vertices go that were added to a mesh for a tolerance; so the parameterization of the source is
// transported to its offset (Wang et al., AIAA 2005). beside() starts between two vertices of the offset: near a miter
// at the point on the moved planes of the place's faces, elsewhere by pushing the point out of all that is too near, in
// a valley beyond the planes that were met last. A vertex that is held in planes moves within these. along() follows
// the interpolated displacement of the surface's vertices to the first point at the distance, by steps that are exact
// for what is closest. A target counts only if it lies before its own faces, is the first point at the distance on its
// way, and keeps the clearance; otherwise the vertex is not there. No face is judged here.
#include "products/tolerance/interpolated_targets.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "motion/paths/straight_path.h"
#include "space/query/cut_at_distance.h"

namespace vdb_offset {
namespace {

// Least cosine between a direction and the normals of the faces that a vertex lies on. Not measured: at a blade's edge
// of one degree the cosine is 0.009.
constexpr double kLeastTargetSlope = 0.005;
// Steps to the distance along a ray. Not measured: each is exact for the feature that is closest, and few are.
constexpr int kMostTargetSteps = 40;
// How much longer a ray may be than the faces at its origin ask for, as a share. Not measured.
constexpr double kMostDetour = 0.5;
// Cosines from which two planes count as one: of what is closest on the way out of a valley, where those of a round
// surface follow each other; and of faces, where their common point would be a matter of rounding. Not measured.
constexpr double kAlikeOnTheWay = 0.999, kParallelPlanes = 1 - 1e-10;
// How far a point between vertices of the offset may be pushed out, in distances. Not measured.
constexpr double kFarthestPush = 2;
// Share of the way to a target up to which the first point at the distance may be before it. Not measured: where fronts
// meet it is half the way or so.
constexpr double kFirstOnTheWay = 1e-3;

/// The last few planes that a point is to be on, or beyond.
class NearPlanes {
 public:
  /// \param alike cosine from which a plane replaces another one
  explicit NearPlanes(double alike) : alike_(alike) {}

  /// The point x is to have normal.dot(x) >= height.
  void add(const Vec3d& normal, double height) {
    const auto alike =
        std::find_if(planes_.begin(), planes_.end(), [&](const auto& one) { return one.first.dot(normal) > alike_; });
    if (alike != planes_.end()) planes_.erase(alike);
    else if (planes_.size() == 3) planes_.erase(planes_.begin());
    planes_.emplace_back(normal, height);
  }

  /// The point nearest to 0 that is on all planes, if there is one.
  std::optional<Vec3d> nearest_on_all() const { return nearest_on((1U << planes_.size()) - 1); }
  /// The point nearest to 0 that is beyond all planes, if there is one.
  std::optional<Vec3d> nearest_beyond() const {
    std::optional<Vec3d> best;
    for (unsigned some = 1; some < 1U << planes_.size(); ++some) {
      const std::optional<Vec3d> x = nearest_on(some);
      if (!x || (best && best->lengthSqr() <= x->lengthSqr())) continue;
      if (std::all_of(planes_.begin(), planes_.end(), [&](const auto& plane) {
            return plane.first.dot(*x) >= plane.second - 1e-12 * std::abs(plane.second);
          }))
        best = x;
    }
    return best;
  }

 private:
  /// The point nearest to 0 on some of the planes, which the bits are.
  std::optional<Vec3d> nearest_on(unsigned some) const {
    // Built up plane by plane, each made orthogonal to those before.
    Vec3d x(0.0);
    std::vector<Vec3d> across;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      if (!(some >> i & 1U)) continue;
      Vec3d normal = planes_[i].first;
      for (const Vec3d& other : across) normal -= other * other.dot(normal);
      const double length = normal.length();
      if (!(length > 1e-6)) return std::nullopt;
      normal /= length;
      x += normal * ((planes_[i].second - planes_[i].first.dot(x)) / length);
      across.push_back(normal);
    }
    return x;
  }

  double alike_;
  std::vector<std::pair<Vec3d, double>> planes_;  // unit normals and heights
};

}  // namespace

/// The line along which a vertex goes.
struct InterpolatedTargets::Ray {
  Vec3d origin;     // in the frame of the surface
  Vec3d direction;  // of unit length
  double slope;     // its least cosine with the normals of the faces at its origin
  double asked;     // above 0
  std::uint32_t hint;

  Vec3d operator()(double t) const { return origin + direction * t; }
};

InterpolatedTargets::InterpolatedTargets(const MeshParts& parts, const ClosestQuery& query, const Obstacles* obstacles,
                                         Corners corners, double miter_limit, std::vector<Vec3d> displacement)
    : parts_(parts),
      query_(query),
      obstacles_(obstacles),
      corners_(corners),
      miter_limit_(miter_limit),
      displacement_(std::move(displacement)) {}

/// The planes that hold what is added at a place.
PlaneNormals InterpolatedTargets::planes_at(const SurfacePlace& place) const {
  const Surface& part = parts_.moving_part;
  if (part.planes.empty()) return {};
  std::vector<std::uint32_t> vertices;
  for (const auto v : place.vertex)
    if (v != kNone) vertices.push_back(parts_.part_vertex.empty() ? v : parts_.part_vertex[v]);
  if (std::find(vertices.begin(), vertices.end(), kNone) != vertices.end()) return {};
  return planes_along(part, vertices, place.on_edge() && triangles_at(place).size() == 1);
}

/// From a place in the direction of a displacement, which is not 0. In the frame of the surface.
InterpolatedTargets::Ray InterpolatedTargets::ray_along(const SurfacePlace& place, const Vec3d& origin,
                                                        const Vec3d& displacement, double asked) const {
  Ray ray{origin, displacement.unit(), 1, std::abs(asked), hint_at(place)};
  for (const auto t : triangles_at(place)) {
    const Vec3d& normal = parts_.surface().triangle_normals[t];
    if (normal.lengthSqr() > 0) ray.slope = std::min(ray.slope, normal.dot(ray.direction) * (asked < 0 ? -1 : 1));
  }
  return ray;
}

/// The triangles of the moving part that a place lies on.
std::vector<std::uint32_t> InterpolatedTargets::triangles_at(const SurfacePlace& place) const {
  if (!place.on_edge()) return {place.triangle};
  const Surface& surface = parts_.surface();
  std::vector<std::uint32_t> triangles;
  for (const auto t : surface.triangles_around(place.vertex[0])) {
    const auto& corners = surface.triangles[t];
    if (std::find(corners.begin(), corners.end(), place.vertex[1]) == corners.end()) continue;
    if (parts_.off_part.empty() || !parts_.off_part[t]) triangles.push_back(t);
  }
  return triangles;
}

VertexTarget InterpolatedTargets::along(const SurfacePlace& place, const Vec3d& position, double asked) const {
  const Surface& surface = parts_.surface();
  Vec3d displacement(0.0);
  for (std::size_t k = 0; k < 3; ++k)
    if (place.vertex[k] != kNone) displacement += displacement_[place.vertex[k]] * place.share[k];
  const PlaneNormals held = planes_at(place);
  displacement = held.within(displacement);
  const std::vector<std::uint32_t> triangles = triangles_at(place);
  if (!(displacement.length() > 0) || triangles.empty()) return {};
  Ray ray = ray_along(place, position - surface.origin, displacement, asked);
  double steepest = -1;
  const Vec3d* plane = nullptr;
  bool is_one_plane = true;
  for (const auto t : triangles) {
    const Vec3d& normal = surface.triangle_normals[t];
    if (normal.lengthSqr() == 0) continue;
    steepest = std::max(steepest, normal.dot(ray.direction) * (asked < 0 ? -1 : 1));
    is_one_plane &= !plane || plane->dot(normal) > kParallelPlanes;
    plane = &normal;
  }
  const bool is_flat = steepest - ray.slope <= kReachedTolerance * ray.slope;
  if (!(ray.slope >= kLeastTargetSlope)) return {};
  if (corners_ == Corners::Miter && is_flat) {
    if (miter_limit_ * ray.slope < 1) {
      // Beside a miter that is cut. Its edge stays whole: nothing round may stand between such miters.
      const Vec3d across = plane ? held.within(*plane) : Vec3d(0.0);
      if (!is_one_plane || !(across.lengthSqr() > 0)) return {};
      ray = within_limit(ray, displacement, across * (asked / across.lengthSqr()));
    }
    if (const VertexTarget target = in_plane(ray); target.is_there) return target;
  }
  return at_distance(ray);
}

/// A ray to where a plane is once it has moved by a displacement across it, shifted along the plane by the part that
/// another one has along it, as far as the miter limit allows.
InterpolatedTargets::Ray InterpolatedTargets::within_limit(const Ray& ray, const Vec3d& displacement,
                                                           const Vec3d& across) const {
  Vec3d along = displacement - across * (across.dot(displacement) / across.lengthSqr());
  const double limit = miter_limit_ * ray.asked, most = std::sqrt(std::max(0.0, limit * limit - across.lengthSqr())),
               length = along.length();
  if (length > most) along *= most / length;
  const Vec3d end = across + along;
  return {ray.origin, end.unit(), ray.asked / end.length(), ray.asked, ray.hint};
}

std::uint32_t InterpolatedTargets::hint_at(const SurfacePlace& place) const {
  const std::uint32_t v = parts_.part_vertex.empty() ? place.vertex[0] : parts_.part_vertex[place.vertex[0]];
  return query_.surface().triangles_around(v).front();
}

VertexTarget InterpolatedTargets::beside(const SurfacePlace& place, const Vec3d& position, double asked,
                                         const Vec3d& between, bool is_by_miter) const {
  const Vec3d& frame = parts_.surface().origin;
  const VertexTarget target = from_between(place, position - frame, asked, between - frame, is_by_miter);
  const bool is_own =
      is_before_faces(place, target.displacement, asked) && is_first_on_the_way(place, position - frame, asked, target);
  return is_own ? target : VertexTarget{};
}

/// Whether a vertex that goes straight to its target is at its distance there for the first time. Where it is not, it
/// has gone past where fronts meet, and is at the distance from the other side.
bool InterpolatedTargets::is_first_on_the_way(const SurfacePlace& place, const Vec3d& origin, double asked,
                                              const VertexTarget& target) const {
  if (!target.is_there || target.is_mitered) return true;
  const double near = std::abs(asked) * (1 + kReachedTolerance);
  const std::vector<std::uint32_t> triangles = triangles_at(place);
  if (std::any_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
        return parts_.surface().closest_on(t, origin + target.displacement).squared_distance <= near * near;
      }))
    return true;
  const Ray ray = ray_along(place, origin, target.displacement, asked);
  const VertexTarget first = ray.slope >= kLeastTargetSlope ? at_distance(ray) : VertexTarget{};
  return first.is_there && first.displacement.length() >= (1 - kFirstOnTheWay) * target.displacement.length();
}

VertexTarget InterpolatedTargets::from_between(const SurfacePlace& place, const Vec3d& origin, double asked,
                                               const Vec3d& between, bool is_by_miter) const {
  const double wanted = std::abs(asked);
  const PlaneNormals held = planes_at(place);
  Vec3d x = held.count > 0 ? origin + held.within(between - origin) : between;
  const std::optional<Vec3d> in_all_planes = is_by_miter ? in_planes(place, origin, asked, x, held) : std::nullopt;
  if (in_all_planes) x = *in_all_planes;
  const Closest closest = query_(x, hint_at(place));
  if (!(closest.distance > 0)) return {};
  if (in_all_planes && closest.distance >= wanted * (1 - kStopTolerance) && is_before_faces(place, x - origin, asked))
    return {held.within(x - origin), (x - closest.point) / closest.distance, true,
            closest.distance > wanted * (1 + kReachedTolerance)};
  if (held.count == 0) return pushed_out(x, origin, wanted, closest);
  const Vec3d displacement = held.within(x - origin);
  if (!(displacement.length() > 0)) return {};
  const Ray ray = ray_along(place, origin, displacement, asked);
  return ray.slope >= kLeastTargetSlope ? at_distance(ray) : VertexTarget{};
}

/// Whether a displacement leads to the side of all faces at a place that is asked for.
bool InterpolatedTargets::is_before_faces(const SurfacePlace& place, const Vec3d& displacement, double asked) const {
  const std::vector<std::uint32_t> triangles = triangles_at(place);
  return std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
    return parts_.surface().triangle_normals[t].dot(displacement) * asked >= 0;
  });
}

/// Goes out from a point that is too near to where it is at its distance: away from what is closest, and in a valley
/// from all that is closest in turn, to the nearest point that is on the far side of the planes that these have there.
VertexTarget InterpolatedTargets::pushed_out(const Vec3d& from, const Vec3d& origin, double asked,
                                             Closest closest) const {
  NearPlanes planes(kAlikeOnTheWay);
  Vec3d x = from;
  for (int i = 0; i < kMostTargetSteps; ++i) {
    const double off = closest.distance - asked;
    const Vec3d away = (x - closest.point) / closest.distance;
    if (std::abs(off) <= kStopTolerance * asked) {
      const bool is_off_obstacles = !obstacles_ || obstacles_->query(x, 0).distance >= obstacles_->clearance;
      return {x - origin, away, is_off_obstacles, false};
    }
    if (off > 0) x = closest.point + away * asked;
    else {
      planes.add(away, away.dot(closest.point - from) + asked);
      const std::optional<Vec3d> step = planes.nearest_beyond();
      if (!step || step->length() > kFarthestPush * asked) return {};
      x = from + *step;
    }
    closest = query_(x, closest.triangle);
    if (!(closest.distance > 0)) return {};
  }
  return {};
}

/// The point nearest to `between` that is as far from the planes of all faces at a place as is asked for, and in those
/// that hold it, if there is one within the miter limit: planes that are folded onto each other meet anywhere. In the
/// frame of the surface.
std::optional<Vec3d> InterpolatedTargets::in_planes(const SurfacePlace& place, const Vec3d& origin, double asked,
                                                    const Vec3d& between, const PlaneNormals& held) const {
  NearPlanes planes(kParallelPlanes);
  for (std::size_t i = 0; i < held.count; ++i) planes.add(held.normal[i], held.normal[i].dot(origin - between));
  for (const auto t : triangles_at(place)) {
    const Vec3d& normal = parts_.surface().triangle_normals[t];
    if (normal.lengthSqr() > 0) planes.add(normal, asked - normal.dot(between - origin));
  }
  const std::optional<Vec3d> step = planes.nearest_on_all();
  if (!step || (between + *step - origin).length() > miter_limit_ * std::abs(asked)) return std::nullopt;
  return between + *step;
}

/// Where the planes of the faces are at the distance, all of which are equally far there.
VertexTarget InterpolatedTargets::in_plane(const Ray& ray) const {
  const double length = ray.asked / ray.slope;
  const Closest closest = query_(ray(length), ray.hint);
  if (closest.distance < ray.asked * (1 - kStopTolerance) || !is_free(ray, length, closest.distance)) return {};
  return end_of(ray, length, closest, closest.distance > ray.asked * (1 + kReachedTolerance));
}

/// The first point at the distance. Each step goes to where the feature that is closest now, as if it went on, is at
/// the distance; where that is too far, as beyond the edge of a face, the point is in between.
VertexTarget InterpolatedTargets::at_distance(const Ray& ray) const {
  const Surface& surface = query_.surface();
  const double longest = ray.asked / ray.slope * (1 + kMostDetour);
  std::uint32_t hint = ray.hint;
  Closest closest{};
  const auto measure = [&](const Vec3d& x) {
    closest = query_(x, hint);
    hint = closest.triangle;
    return sample_at(x, closest);
  };
  const auto is_settled = [&](const Sample& at) { return std::abs(at.phi - ray.asked) <= kStopTolerance * ray.asked; };
  double t = ray.asked;
  Sample before{ray.origin, 0, Vec3d(0.0), hint, Feature::Face};
  for (int i = 0; i < kMostTargetSteps && t <= longest; ++i) {
    Sample at = measure(ray(t));
    if (at.phi > ray.asked && !is_settled(at)) {
      at = cut_at_distance(surface, before, at, ray.asked, measure, is_settled);
      t = (at.x - ray.origin).dot(ray.direction);
    }
    if (is_settled(at)) return is_free(ray, t, at.phi) ? end_of(ray, t, closest, false) : VertexTarget{};
    if (at.phi <= before.phi) return {};
    const double step = ray.asked - at.phi;
    t += std::max(step, share_to_distance(surface, at, ray.direction, ray.asked).value_or(step));
    before = at;
  }
  return {};
}

/// Whether nothing lies on a ray up to its end, which is so far from the surface: covers it, back to its origin, with
/// balls that hold no surface (see StraightPaths).
bool InterpolatedTargets::is_free(const Ray& ray, double length, double distance) const {
  std::uint32_t hint = ray.hint;
  for (double t = length - distance; t > kStopTolerance * ray.asked;) {
    const Closest closest = query_(ray(t), hint);
    hint = closest.triangle;
    if (closest.distance < kFreeShare * ray.slope * t) return false;
    t -= closest.distance * (1 - 1e-12);
  }
  if (!obstacles_) return true;
  return obstacles_->query(ray(length), 0).distance >= obstacles_->clearance;
}

VertexTarget InterpolatedTargets::end_of(const Ray& ray, double length, const Closest& closest, bool is_mitered) const {
  Vec3d away = ray(length) - closest.point;
  away.normalize();
  return {ray.direction * length, away, true, is_mitered};
}

}  // namespace vdb_offset
