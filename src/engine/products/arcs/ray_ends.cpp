// SPDX-License-Identifier: Apache-2.0
#include "products/arcs/ray_ends.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "motion/paths/straight_path.h"

namespace vdb_offset {
namespace {

// Where a ray begins whose end is not at its distance in a straight line, in distances. Not measured.
constexpr double kFirstStep = 1.0 / 16;
// Steps of a ray. Reasoned: on a ray at 75 degrees from the normal each takes a quarter of what is left.
constexpr int kMostRaySteps = 100;

/// A ray that has not ended.
struct OpenRay {
  std::size_t number;
  double length = 0, last_length = 0, last_phi = 0;
};

}  // namespace

std::vector<RidgeRayEnd> ray_ends(const ClosestQuery& query, std::span<const RidgeRay> rays, double longest) {
  std::vector<RidgeRayEnd> ends(rays.size(), {0, false});
  std::vector<OpenRay> open;
  for (std::size_t i = 0; i < rays.size(); ++i) open.push_back({i, rays[i].distance});
  for (int round = 0; round < kMostRaySteps && !open.empty(); ++round) {
    std::vector<Vec3d> points;
    points.reserve(open.size());
    for (const OpenRay& one : open) points.push_back(rays[one.number].origin + rays[one.number].direction * one.length);
    const std::vector<Closest> closest = closest_points(query, points);
    std::vector<OpenRay> left;
    for (std::size_t i = 0; i < open.size(); ++i) {
      OpenRay one = open[i];
      const double distance = rays[one.number].distance, phi = closest[i].distance;
      RidgeRayEnd& end = ends[one.number];
      if (phi >= distance * (1 - kStopTolerance)) {
        end = {one.length, true};
        continue;
      }
      if (round == 0) {  // it is not straight: from near the surface on
        left.push_back({one.number, kFirstStep * distance});
        continue;
      }
      if (phi < one.last_phi || one.length > longest * distance) {
        end = {one.last_length, false};
        continue;
      }
      end = {one.length, false};
      left.push_back({one.number, one.length + std::min(distance - phi, kFreeShare * phi), one.length, phi});
    }
    open.swap(left);
  }
  return ends;
}

}  // namespace vdb_offset
