// SPDX-License-Identifier: Apache-2.0
// Finds which vertices on the borders of a mesh a motion takes to others there. An edge of a border counts if the
// motion takes it to another one that runs the other way, as it does along a face of the next copy.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "ground/mesh/match_points.h"
#include "products/periodic/mesh_borders.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/periodic.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

/// How near to others the motion puts a border's vertices, at the best.
double least_gap(const MeshBorders& borders, std::span<const Vec3d> moved) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < moved.size(); ++i)
    for (std::size_t j = 0; j < moved.size(); ++j)
      if (j != i) least = std::min(least, (moved[i] - borders.points[j]).length());
  return least;
}

void require_motion(const PeriodicMotion& motion) {
  if (motion.angle != 0 ? !(motion.axis.length() > 0) : !(motion.shift.length() > 0))
    throw InvalidInput("periodic: expected a turn about an axis, or a shift, got neither");
}

}  // namespace

PeriodicPairs find_periodic_pairs(PolygonView mesh, const PeriodicMotion& motion) {
  require_motion(motion);
  const MeshBorders borders(mesh);
  if (borders.vertices.empty()) throw InvalidInput("periodic: expected a mesh with borders, got a closed one");
  std::vector<Vec3d> moved;
  moved.reserve(borders.points.size());
  for (const Vec3d& x : borders.points) moved.push_back(motion(x));
  const std::vector<Index> mate = match_points(moved, borders.points, kOffPeriod * used_diagonal(mesh));
  PeriodicPairs pairs{.motion = motion, .image = std::vector<Index>(mesh.positions.size(), kNone)};
  bool any = false;
  for (const auto& [a, b] : borders.edges) {
    const Index to_a = mate[borders.number.at(a)], to_b = mate[borders.number.at(b)];
    if (to_a == kNone || to_b == kNone) continue;
    const Index image_a = borders.vertices[to_a], image_b = borders.vertices[to_b];
    if (!borders.edges.contains({image_b, image_a})) continue;
    pairs.image[a] = image_a;
    pairs.image[b] = image_b;
    any = true;
  }
  if (!any) {
    const double gap = least_gap(borders, moved);
    throw InvalidInput("periodic: expected a border that the motion takes to another one, got none" +
                       (gap > 0 ? fmt::format("; the nearest that a vertex comes to another one is {:.3g}", gap) : ""));
  }
  for (Index v = 0; v < pairs.image.size(); ++v) {
    if (borders.first[v] == kNone) continue;
    pairs.image[v] = pairs.image[borders.first[v]];
    pairs.facts.pairs += borders.first[v] == v && pairs.image[v] != kNone && pairs.image[v] != v;
  }
  return pairs;
}

}  // namespace vdb_offset
