// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/cad/judge/clearance.h"

namespace vdb_offset::cad {
namespace {

double reach_from(const Soup& from, const Soup& to, double most) {
  const Soup::Facing any{nullptr, gp_Vec(0, 0, 0), 1};
  for (const Soup::Triangle& t : from.triangles()) {
    const auto& p = t.points;
    const gp_Pnt middle((p[0].XYZ() + p[1].XYZ() + p[2].XYZ()) / 3);
    for (const gp_Pnt& point : {p[0], p[1], p[2], middle})
      if (const Soup::Nearest nearest = to.nearest(point, most, any); nearest.triangle >= 0) most = nearest.distance;
  }
  return most;
}

}  // namespace

double gap_between(const Soup& one, const Soup& other, double most) {
  return reach_from(one, other, reach_from(other, one, most));
}

}  // namespace vdb_offset::cad
