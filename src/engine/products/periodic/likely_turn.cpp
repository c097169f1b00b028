// SPDX-License-Identifier: Apache-2.0
// Finds out whether a mesh may be one period of a shape that nobody has called so. Of a sector, vertices of its border
// at one place along an axis, and at one radius, span the same angle all along: that of the turn.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "products/periodic/mesh_borders.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/periodic.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// Angles to so many degrees are one, and turns by less are none: sectors of a circle have at least that much.
constexpr double kSameAngle = 1e-3, kLeastTurn = 0.5;
// Share of the places along the border with several vertices at which the angle has to be the same. Not measured.
constexpr double kMostPlaces = 0.5;

/// Where points are around one of the axes.
class AroundAxis {
 public:
  AroundAxis(std::span<const Vec3d> points, int axis, double tolerance) : axis_(axis), tolerance_(tolerance) {
    Vec3d middle(0.0);
    for (const Vec3d& x : points) middle += x;
    const double from = std::atan2(up(middle), across(middle));
    for (const Vec3d& x : points) {
      const double radius = std::hypot(up(x), across(x));
      if (radius < tolerance) continue;
      double angle = std::atan2(up(x), across(x)) - from;
      angle -= 2 * std::numbers::pi * std::round(angle / (2 * std::numbers::pi));
      auto [found, is_new] = spans_.try_emplace({place_of(x[axis]), place_of(radius)}, std::pair{angle, angle});
      found->second.first = std::min(found->second.first, angle);
      found->second.second = std::max(found->second.second, angle);
    }
  }

  /// The angle that most places span, degrees; 0 if there is none.
  double common_span() const {
    std::map<long long, std::size_t> count;
    std::size_t all = 0;
    for (const auto& [place, span] : spans_) {
      if (degrees(span) < kLeastTurn) continue;
      ++count[std::llround(degrees(span) / kSameAngle)];
      ++all;
    }
    const auto most = std::ranges::max_element(count, {}, [](const auto& entry) { return entry.second; });
    if (most == count.end() || static_cast<double>(most->second) < kMostPlaces * static_cast<double>(all)) return 0;
    for (const auto& [place, span] : spans_)
      if (std::llround(degrees(span) / kSameAngle) == most->first) return degrees(span);
    return 0;
  }

 private:
  double up(const Vec3d& x) const { return x[(axis_ + 2) % 3]; }
  double across(const Vec3d& x) const { return x[(axis_ + 1) % 3]; }
  long long place_of(double length) const { return std::llround(length / (4 * tolerance_)); }
  static double degrees(const std::pair<double, double>& span) {
    return (span.second - span.first) * 180 / std::numbers::pi;
  }

  int axis_;
  double tolerance_;
  std::map<std::pair<long long, long long>, std::pair<double, double>> spans_;
};

/// Whether all vertices with an image lie in a plane across an axis of coordinates, and all images, too.
bool is_between_axes(PolygonView mesh, const PeriodicPairs& pairs, double tolerance) {
  const auto all_in = [&](int axis, bool images) {
    for (std::uint32_t v = 0; v < pairs.image.size(); ++v) {
      if (pairs.image[v] == kNone) continue;
      if (std::abs(mesh.positions[images ? pairs.image[v] : v][axis]) > tolerance) return false;
    }
    return true;
  };
  const auto any_in = [&](bool images) { return all_in(0, images) || all_in(1, images) || all_in(2, images); };
  return any_in(false) && any_in(true);
}

}  // namespace

std::optional<PeriodicMotion> likely_turn(PolygonView mesh) {
  const MeshBorders borders(mesh);
  if (borders.vertices.empty()) return std::nullopt;
  const double tolerance = kOffPeriod * used_diagonal(mesh);
  for (int axis = 0; axis < 3; ++axis) {
    const double angle = AroundAxis(borders.points, axis, tolerance).common_span(), turns = 360 / angle;
    if (!(angle > kLeastTurn) || !(angle < 180 - kLeastTurn) || std::abs(turns - std::round(turns)) > kSameAngle)
      continue;
    PeriodicMotion motion{.angle = 360 / std::round(turns)};
    motion.axis[axis] = 1;
    try {
      const PeriodicPairs pairs = find_periodic_pairs(mesh, motion);
      if (!is_between_axes(mesh, pairs, tolerance)) return motion;
    } catch (const InvalidInput&) {
      continue;  // no border of it is another one's image
    }
  }
  return std::nullopt;
}

}  // namespace vdb_offset
