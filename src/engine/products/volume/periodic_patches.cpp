// SPDX-License-Identifier: Apache-2.0
#include "products/volume/periodic_patches.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "ground/mesh/match_points.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

/// The points of a patch, each once.
std::vector<Index> points_of(const BoundaryPatch& patch) {
  std::vector<Index> points = patch.corners;
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

/// For each point of the first patch that of the second which the motion takes it to.
std::map<Index, Index> images(const VolumeMesh& mesh, const BoundaryPatch& first, const BoundaryPatch& second) {
  const std::vector<Index> from = points_of(first), to = points_of(second);
  std::vector<Vec3d> moved, there;
  for (const Index p : from) moved.push_back((*mesh.motion)(mesh.points[p]));
  for (const Index p : to) there.push_back(mesh.points[p]);
  const std::vector<Index> match = match_points(moved, there, periodic_tolerance(mesh));
  std::map<Index, Index> image;
  for (std::size_t i = 0; i < from.size(); ++i)
    if (match[i] != kNone) image[from[i]] = to[match[i]];
  return image;
}

[[noreturn]] void refuse(const VolumeMesh& mesh, const BoundaryPatch& patch, std::span<const Index> face) {
  const Vec3d& place = mesh.points[face[0]];
  throw InvalidInput(
      fmt::format("periodic: expected faces of {} that all have an image, got one without at ({:.6g}, {:.6g}, {:.6g})",
                  patch.name, place[0], place[1], place[2]));
}

}  // namespace

std::pair<BoundaryPatch*, BoundaryPatch*> periodic_patches(VolumeMesh& mesh) {
  const auto is_periodic = [](const BoundaryPatch& patch) { return patch.kind == BoundaryPatch::Kind::Periodic; };
  const auto first = std::ranges::find_if(mesh.patches, is_periodic);
  const auto second = std::find_if(first + 1, mesh.patches.end(), is_periodic);
  return {&*first, &*second};
}

double periodic_tolerance(const VolumeMesh& mesh) {
  Vec3d lowest(std::numeric_limits<double>::infinity()), highest = -lowest;
  for (const BoundaryPatch& patch : mesh.patches)
    if (patch.kind == BoundaryPatch::Kind::Periodic)
      for (const Index p : patch.corners) {
        lowest = openvdb::math::minComponent(lowest, mesh.points[p]);
        highest = openvdb::math::maxComponent(highest, mesh.points[p]);
      }
  return kOffPeriod * (highest - lowest).length();
}

void match_periodic_patches(VolumeMesh& mesh) {
  if (!mesh.motion) return;
  const auto [first, second] = periodic_patches(mesh);
  const std::map<Index, Index> image = images(mesh, *first, *second);
  std::map<std::vector<Index>, std::size_t> known;  // the second patch's faces, by their sorted corners
  for (std::size_t f = 0; f < second->face_count(); ++f) {
    std::vector<Index> key(second->face(f).begin(), second->face(f).end());
    std::ranges::sort(key);
    known.emplace(std::move(key), f);
  }
  BoundaryPatch ordered{.name = second->name, .kind = second->kind};
  for (std::size_t f = 0; f < first->face_count(); ++f) {
    const auto face = first->face(f);
    std::vector<Index> corners{face[0]};
    corners.insert(corners.end(), face.rbegin(), face.rend() - 1);
    for (Index& p : corners) {
      const auto found = image.find(p);
      if (found == image.end()) refuse(mesh, *first, face);
      p = found->second;
    }
    std::vector<Index> key = corners;
    std::ranges::sort(key);
    const auto found = known.find(key);
    if (found == known.end()) refuse(mesh, *first, face);
    ordered.corners.insert(ordered.corners.end(), corners.begin(), corners.end());
    ordered.face_begin.push_back(static_cast<Index>(ordered.corners.size()));
    ordered.cell.push_back(second->cell[found->second]);
    known.erase(found);
  }
  if (!known.empty()) refuse(mesh, *second, second->face(known.begin()->second));
  *second = std::move(ordered);
}

}  // namespace vdb_offset
