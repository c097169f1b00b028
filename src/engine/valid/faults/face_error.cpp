// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/face_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "ground/mesh/miter_point.h"
#include "ground/mesh/planes_around.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "space/surface/creases.h"

namespace vdb_offset {
namespace {

// Points that are measured: their 99 % quantile is made of four hundred of them. More would take longer than the march
// on small meshes. Told in FaceError.
constexpr std::size_t kMostSamples = 40000;
// Points of a triangle on average, where there are few of them. Not measured.
constexpr std::size_t kMostOfTriangle = 256;
// Where each triangle is measured if each face has an error of its own: its middle, and towards its corners. The same
// on all, so that like faces have like colours.
constexpr double kMost = 2.0 / 3, kLeast = 1.0 / 6, kThird = 1.0 / 3;
constexpr std::array<std::array<double, 3>, 4> kOnEachTriangle = {
    {{kThird, kThird, kThird}, {kMost, kLeast, kLeast}, {kLeast, kMost, kLeast}, {kLeast, kLeast, kMost}}};
constexpr std::size_t kOfEachTriangle = kOnEachTriangle.size();
// Of the points that are measured, one in so many is asked for the cause of its error: ten thousand give shares to 1 %.
constexpr std::size_t kOneInCauses = 4;
// Points that are measured together, as the exact query answers neighbours together. Not measured.
constexpr std::size_t kPointsTogether = 16;
// Share of the largest distance below which a point counts as asked to stay. Reasoned: errors are relative.
constexpr double kLeastAsked = 1e-3;
constexpr double kNoPlane = std::numeric_limits<double>::infinity();  // how far off the plane of a face without one is

/// Where on a triangle the sample of a number is: by shares of its corners. The fractional parts of the multiples of
/// two numbers cover a square evenly (Roberts, The unreasonable effectiveness of quasirandom sequences, 2018), and one
/// half of it folded onto the other is a triangle.
std::array<double, 3> shares_of(std::size_t sample) {
  constexpr double kFirst = 0.7548776662466927, kSecond = 0.5698402909980532;
  const auto fraction = [&](double step) {
    const double x = 0.5 + step * static_cast<double>(sample);
    return x - std::floor(x);
  };
  double u = fraction(kFirst), v = fraction(kSecond);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return {1 - u - v, u, v};
}

/// Marks the vertices of the moving part at which a corner may be sharp: those on creases, and on edges of more than
/// two faces.
std::vector<std::uint8_t> vertices_at_corners(const ConstrainedSurface& constrained) {
  const Surface& surface = constrained.moving_part.surface();
  const auto& known = constrained.on_crease;
  std::vector<std::uint8_t> sharp =
      known.empty() ? vertices_on_creases(surface) : std::vector<std::uint8_t>(known.begin(), known.end());
  for (std::uint32_t h = 0; h < surface.next_around_edge.size(); ++h)
    if (surface.next_around_edge[surface.next_around_edge[h]] != h) sharp[surface.from(h)] = sharp[surface.to(h)] = 1;
  return sharp;
}

class FaceMeter {
 public:
  explicit FaceMeter(const MeasuredFaces& faces)
      : faces_(faces), constrained_(faces.constrained), surface_(faces.constrained.surface) {
    VDB_OFFSET_ASSERT(faces.positions.size() == surface_.vertices.size());
    VDB_OFFSET_ASSERT(faces.source.empty() || faces.source.size() == surface_.vertices.size());
    sum_up_areas();
    least_asked_ = kLeastAsked * faces.distances.scale();
  }

  FaceError operator()() {
    if (triangles_.empty() || !(area_up_to_.back() > 0)) return {};
    measure_all(std::min(kMostSamples, kMostOfTriangle * triangles_.size()));
    FaceError result = sum_up_errors(error_);
    if (!faces_.source.empty() && (result.mean > kWorthTelling || share_too_far() > kWorthTelling))
      report_causes(result);
    return result;
  }

  /// The mean error of each of so many faces of the input, as measure_each_face().
  std::vector<float> of_each(std::size_t faces) {
    of_each_triangle_ = true;
    measure_all(kOfEachTriangle * triangles_.size());
    std::vector<double> sum(faces, 0), area(faces, 0);
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t at = i / kOfEachTriangle;
      const std::uint32_t face = surface_.face[triangles_[at]];
      if (!error_[i] || face >= faces) continue;
      const double share = area_up_to_[at] - (at > 0 ? area_up_to_[at - 1] : 0);
      sum[face] += size_of_error(i) * share;
      area[face] += share;
    }
    std::vector<float> errors(faces, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t f = 0; f < faces; ++f)
      if (area[f] > 0) errors[f] = static_cast<float>(sum[f] / area[f]);
    return errors;
  }

 private:
  void measure_all(std::size_t count) {
    count_ = count;
    error_.assign(count_, std::nullopt);
    of_.assign(count_, 0);
    for_each_index((count_ + kPointsTogether - 1) / kPointsTogether, [&](std::size_t block) { measure(block); }, 4);
  }

  /// Lists the triangles of the moving part, with the areas of all up to each of them.
  void sum_up_areas() {
    double sum = 0;
    for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t) {
      if (!constrained_.triangle_on_part(t)) continue;
      const auto& [a, b, c] = surface_.triangles[t];
      const auto& at = faces_.positions;
      const double area = (at[b] - at[a]).cross(at[c] - at[a]).length();
      if (!(area > 0)) continue;
      triangles_.push_back(t);
      area_up_to_.push_back(sum += area);
    }
  }

  void measure(std::size_t block) {
    std::array<Vec3d, kPointsTogether> points;
    std::array<std::uint32_t, kPointsTogether> hints{};
    std::array<double, kPointsTogether> asked{}, off_plane{};
    std::array<Closest, kPointsTogether> closest;
    const std::size_t begin = block * kPointsTogether, size = std::min(kPointsTogether, count_ - begin);
    const Vec3d& origin = constrained_.moving_part.surface().origin;
    for (std::size_t i = 0; i < size; ++i) {
      const std::uint32_t t = of_[begin + i] = triangle_of(begin + i);
      Vec3d point;
      std::tie(point, asked[i]) = sample(begin + i);
      off_plane[i] = kNoPlane;
      if (!faces_.source.empty() && surface_.triangle_normals[t].lengthSqr() > 0)
        off_plane[i] = std::copysign(1, asked[i]) * (over_plane(t, point) - asked[i]);
      points[i] = point - origin;
      hints[i] = constrained_.hint_of_triangle(t);
    }
    constrained_.moving_part.answer_together(std::span(points).first(size), std::span(hints).first(size),
                                             std::span(closest).first(size));
    for (std::size_t i = 0; i < size; ++i) {
      const double wanted = std::abs(asked[i]);
      if (!(wanted > least_asked_)) continue;
      const double off = closest[i].distance - wanted;
      const bool by_plane = off_plane[i] != kNoPlane && differs(of_[begin + i]);
      error_[begin + i] = by_plane ? PointError{off_plane[i] / wanted, std::max(0.0, (off - off_plane[i]) / wanted)}
                                   : point_error(off, off_plane[i], wanted);
    }
  }

  static bool is_too_far(const std::optional<PointError>& error) { return error && error->off > kAtDistance; }
  double share_too_far() const {
    return static_cast<double>(std::count_if(error_.begin(), error_.end(), is_too_far)) / static_cast<double>(count_);
  }
  double size_of_error(std::size_t i) const { return std::abs(error_[i]->off); }

  /// A sample of the triangle that is noted for it, and what is asked there.
  std::pair<Vec3d, double> sample(std::size_t i) const {
    const auto& corners = surface_.triangles[of_[i]];
    const std::array<double, 3> shares = of_each_triangle_ ? kOnEachTriangle[i % kOfEachTriangle] : shares_of(i);
    Vec3d point(0.0);
    double asked = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      point += faces_.positions[corners[k]] * shares[k];
      asked += asked_at(of_[i], k) * shares[k];
    }
    return {point, asked};
  }

  /// How far a point is over the plane that a triangle is in in the source.
  double over_plane(std::uint32_t t, const Vec3d& point) const {
    return surface_.triangle_normals[t].dot(point - faces_.source[surface_.triangles[t][0]]);
  }

  double asked_at(std::uint32_t t, std::size_t k) const {
    return faces_.own ? faces_.own->at_corner_of(t, k) : faces_.distances[surface_.triangles[t][k]];
  }
  /// Whether faces have distances of their own at a corner of a triangle.
  bool differs(std::uint32_t t) const {
    const auto& corners = surface_.triangles[t];
    return faces_.own && std::any_of(corners.begin(), corners.end(), [&](auto v) { return faces_.own->differ(v); });
  }

  /// The triangle at the middle of a sample's share of the area, or each for as many samples as the others.
  std::uint32_t triangle_of(std::size_t sample) const {
    if (of_each_triangle_) return triangles_[sample / kOfEachTriangle];
    const double area = area_up_to_.back() * (static_cast<double>(sample) + 0.5) / static_cast<double>(count_);
    const auto at = std::upper_bound(area_up_to_.begin(), area_up_to_.end() - 1, area);
    return triangles_[static_cast<std::size_t>(at - area_up_to_.begin())];
  }

  /// Whether a corner of a triangle is not where the triangle's own plane is at the distance: at a sharp corner that is
  /// not mitered, or a miter with which the plane goes too far, as more planes meet there than one point can be on. By
  /// less than area may be off that counts as at the distance, no corner makes a mean worth telling.
  bool is_off_plane(std::uint32_t t, std::uint32_t v) const {
    const double asked = faces_.own ? faces_.own->at(t, v) : faces_.distances[v],
                 moved = surface_.triangle_normals[t].dot(faces_.positions[v] - faces_.source[v]);
    return std::abs(moved - asked) > kAtDistance * std::abs(asked);
  }

  void report_causes(FaceError& result) const {
    const std::vector<Corner> corner = corners_off_planes();
    const bool is_worth_telling = result.mean > kWorthTelling;
    const std::vector<double> no_room = is_worth_telling ? lacks_of_room() : std::vector<double>(count_, 0);
    double sum = 0, beyond = 0, asked = 0;
    for (std::size_t i = 0; i < count_; i += kOneInCauses) {
      if (!error_[i]) continue;
      ++asked;
      const double error = size_of_error(i);
      const Corners3 corners = corners_of(i, corner);
      sum += error;
      if (corners.is_short) {
        (corners.is_stuck ? result.stuck : result.held_back) += error;
        continue;
      }
      result.no_room += no_room[i];
      (!corners.is_sharp ? result.coarse : corners.has_room ? result.corners : result.no_room) += error - no_room[i];
      if (!corners.is_of_many || !corners.has_room || !is_too_far(error_[i])) continue;
      ++beyond;
      result.most_beyond = std::max(result.most_beyond, error);
    }
    result.beyond = asked > 0 ? beyond / asked : 0;
    for (double* const cause : {&result.held_back, &result.stuck, &result.no_room, &result.corners, &result.coarse})
      *cause = is_worth_telling && sum > 0 ? *cause / sum : 0;
  }

  /// What a vertex is that is off the plane of a face which is measured off its distance.
  enum class Corner : std::uint8_t {
    None,        ///< Not at a sharp corner, or on all these planes.
    OnePoint,    ///< One point is on all planes around it, moved by the distance.
    NoRoom,      ///< Likewise, and that point has none: just a smaller distance helps.
    ManyPlanes,  ///< More planes meet there than one point can be on.
  };
  /// What the corners of a triangle are.
  struct Corners3 {
    bool is_short = false, is_stuck = true;  ///< One of them at least falls short; all that do have not moved.
    /// One at least is sharp and off the triangle's plane; none of these lacks room; one is of many planes.
    bool is_sharp = false, has_room = true, is_of_many = false;
  };
  Corners3 corners_of(std::size_t sample, const std::vector<Corner>& corner) const {
    Corners3 corners;
    for (const auto v : surface_.triangles[of_[sample]]) {
      if (corner[v] != Corner::None && is_off_plane(of_[sample], v)) {
        corners.is_sharp = true;
        corners.has_room &= corner[v] != Corner::NoRoom;
        corners.is_of_many |= corner[v] == Corner::ManyPlanes;
      }
      if (faces_.states.empty() || !falls_short(faces_.states[v])) continue;
      corners.is_short = true;
      corners.is_stuck &= (faces_.positions[v] - faces_.source[v]).length() <= kStuck * std::abs(faces_.distances[v]);
    }
    return corners;
  }

  std::vector<Corner> corners_off_planes() const {
    const std::vector<std::uint8_t> sharp = vertices_at_corners(constrained_);
    std::vector<Corner> corner(surface_.vertices.size(), Corner::None);
    std::vector<std::uint32_t> some;
    for (std::size_t i = 0; i < count_; i += kOneInCauses) {
      if (!error_[i] || !(size_of_error(i) > kAtDistance)) continue;
      for (const auto v : surface_.triangles[of_[i]]) {
        const std::uint32_t on_part = constrained_.part_vertex_of(v);
        if (corner[v] != Corner::None || on_part == kNone || !sharp[on_part] || !is_off_plane(of_[i], v)) continue;
        corner[v] = Corner::OnePoint;
        some.push_back(v);
      }
    }
    for_each_index(
        some.size(), [&](std::size_t i) { corner[some[i]] = corner_at(some[i]); }, 16);
    return corner;
  }

  Corner corner_at(std::uint32_t v) const {
    const double asked = faces_.distances[v];
    if (asked == 0 || (faces_.own && faces_.own->differ(v))) return Corner::OnePoint;
    const PlanesAround planes =
        planes_around(surface_, v, [&](std::uint32_t t) -> const Vec3d& { return surface_.triangle_normals[t]; });
    const auto miter = miter_point(planes.normals);
    if (!miter || miter->excess > kAtDistance) return Corner::ManyPlanes;
    const Surface& part = constrained_.moving_part.surface();
    const Vec3d end = faces_.source[v] + miter->position * asked - part.origin;
    const Closest closest =
        constrained_.moving_part(end, constrained_.hint_of_triangle(surface_.triangles_around(v)[0]));
    // Faces that meet at the vertex are no wall.
    const auto& corners = part.triangles[closest.triangle];
    if (std::find(corners.begin(), corners.end(), constrained_.part_vertex_of(v)) != corners.end())
      return Corner::OnePoint;
    const Vec3d opposite = part.pseudonormal(closest.triangle, closest.feature);
    const bool has_room = std::none_of(planes.normals.begin(), planes.normals.end(), [&](const Vec3d& normal) {
      return lack_of_room(end, normal, asked, closest, opposite, 1) > kAtDistance;
    });
    return has_room ? Corner::OnePoint : Corner::NoRoom;
  }

  /// For each sample the part of its error that comes of a lack of room.
  std::vector<double> lacks_of_room() const {
    std::vector<double> lacks(count_, 0);
    const Surface& part = constrained_.moving_part.surface();
    for_each_index((count_ + kOneInCauses - 1) / kOneInCauses,
                   [&](std::size_t among_those) {
                     const std::size_t i = among_those * kOneInCauses;
                     const std::uint32_t t = of_[i];
                     const Vec3d& normal = surface_.triangle_normals[t];
                     if (!error_[i] || !(size_of_error(i) > kAtDistance) || normal.lengthSqr() == 0) return;
                     const auto [point, asked] = sample(i);
                     const Vec3d in_plane = point + normal * (asked - over_plane(t, point)) - part.origin;
                     const Closest closest = constrained_.moving_part(in_plane, constrained_.hint_of_triangle(t));
                     lacks[i] = lack_of_room(in_plane, normal, asked, closest,
                                             part.pseudonormal(closest.triangle, closest.feature), size_of_error(i));
                   },
                   16);
    return lacks;
  }

  const MeasuredFaces& faces_;
  const ConstrainedSurface& constrained_;
  const Surface& surface_;
  double least_asked_ = 0;
  std::vector<std::uint32_t> triangles_;
  std::vector<double> area_up_to_;  // twice the areas
  std::size_t count_ = 0;
  bool of_each_triangle_ = false;
  std::vector<std::optional<PointError>> error_;  // of each sample that is measured
  std::vector<std::uint32_t> of_;                 // of each, the triangle that it is on
};

}  // namespace

FaceError measure_faces(const MeasuredFaces& faces) { return FaceMeter(faces)(); }

std::vector<float> measure_each_face(const MeasuredFaces& faces, std::size_t count) {
  return FaceMeter(faces).of_each(count);
}

double lack_of_room(const Vec3d& in_plane, const Vec3d& normal, double asked, const Closest& closest,
                    const Vec3d& opposite, double error) {
  constexpr double kOpposite = -0.5;  // cosine: two faces at 60 degrees or less are a wall or a gap; not measured
  if (normal.dot(opposite) > kOpposite * opposite.length()) return 0;
  // Beyond the other face there is no room at all.
  if (opposite.dot(in_plane - closest.point) * asked < 0) return error;
  return std::clamp(1 - closest.distance / std::abs(asked), 0.0, error);
}

PointError point_error(double off, double off_plane, double wanted) {
  const double left = off > 0 ? std::min(off, std::abs(off_plane)) : off;
  return {left / wanted, (off - left) / wanted};
}

FaceError sum_up_errors(std::span<const std::optional<PointError>> errors) {
  std::vector<double> sizes;
  FaceError result;
  std::size_t there = 0;
  for (const std::optional<PointError>& each : errors) {
    if (!each) continue;
    const double size = std::abs(each->off);
    sizes.push_back(size);
    result.mean += size;
    result.farther += each->farther;
    result.worst = std::max(result.worst, size);
    there += size <= kAtDistance;
  }
  if (sizes.empty()) return result;
  result.samples = sizes.size();
  const auto count = static_cast<double>(sizes.size());
  for (double* const sum : {&result.mean, &result.farther}) *sum /= count;
  result.at_distance = static_cast<double>(there) / count;
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(99 * sizes.size() / 100);
  std::nth_element(sizes.begin(), at, sizes.end());
  result.quantile_99 = *at;
  return result;
}

}  // namespace vdb_offset
