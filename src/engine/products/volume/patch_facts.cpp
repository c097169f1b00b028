// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "ground/mesh/triangulate.h"
#include "vdb_offset/cells.h"

namespace vdb_offset {
namespace {

// How far a patch may be off its plane, as a share of its size: files keep seven digits.
constexpr double kPatchOffPlane = 1e-6;

// The share of that below which an offset is rounding.
constexpr double kRoundingOff = 1e-6;

/// The plane that all points of a patch lie in.
std::optional<SymmetryPlane> plane_of_patch(const VolumeMesh& mesh, const BoundaryPatch& patch) {
  Vec3d area(0.0), lowest(std::numeric_limits<double>::infinity()), highest = -lowest;
  for (std::size_t f = 0; f < patch.face_count(); ++f) area += area_vector(mesh.points, patch.face(f));
  for (const auto p : patch.corners) {
    lowest = openvdb::math::minComponent(lowest, mesh.points[p]);
    highest = openvdb::math::maxComponent(highest, mesh.points[p]);
  }
  if (!area.normalize(0.0)) return std::nullopt;
  const double tolerance = kPatchOffPlane * (highest - lowest).length();
  for (int axis = 0; axis < 3; ++axis)
    if (highest[axis] - lowest[axis] <= tolerance) {
      const double side = area[axis] > 0 ? 1 : -1;
      area = Vec3d(0.0);
      area[axis] = side;
    }
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto p : patch.corners) {
    const double height = area.dot(mesh.points[p]);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  if (high - low > 2 * tolerance) return std::nullopt;
  const double offset = (low + high) / 2;
  // What is left of 0 by rounding is 0.
  return SymmetryPlane{area, std::abs(offset) > kRoundingOff * tolerance ? offset : 0};
}

}  // namespace

const char* name(BoundaryPatch::Kind kind) {
  constexpr const char* kNames[] = {"wall", "farfield", "side", "symmetry", "empty", "inlet", "outlet", "periodic"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::vector<PatchFacts> patch_facts(const VolumeMesh& mesh) {
  std::vector<PatchFacts> facts;
  for (const BoundaryPatch& patch : mesh.patches) {
    if (patch.face_count() == 0) continue;
    PatchFacts& each = facts.emplace_back(PatchFacts{patch.name, patch.kind, patch.face_count(), std::nullopt});
    if (patch.kind != BoundaryPatch::Kind::Wall && patch.kind != BoundaryPatch::Kind::Outer)
      each.plane = plane_of_patch(mesh, patch);
  }
  return facts;
}

}  // namespace vdb_offset
