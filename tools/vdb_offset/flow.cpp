// SPDX-License-Identifier: Apache-2.0
#include "flow.h"

#include <algorithm>

namespace vdb_offset::tool {
namespace {

/// The longest side of the box around the vertices in use.
double longest_side(PolygonView mesh) {
  Vec3d lowest(0.0), highest(0.0);
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    const Vec3d& x = mesh.positions[mesh.corners[c]];
    lowest = c == 0 ? x : openvdb::math::minComponent(lowest, x);
    highest = c == 0 ? x : openvdb::math::maxComponent(highest, x);
  }
  const Vec3d size = highest - lowest;
  return std::max({size[0], size[1], size[2]});
}

}  // namespace

io::Flow flow_of(const Job& job) {
  const FlowRequest& request = job.request.flow;
  io::Flow flow = request.given;
  flow.length = request.length ? *request.length : longest_side(job.source.view());
  flow.viscosity = request.viscosity ? *request.viscosity / request.density.value_or(1)
                                     : flow.speed * flow.length / *request.reynolds;
  return flow;
}

}  // namespace vdb_offset::tool
