// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/field.h"

#include <fmt/format.h>
#include <openvdb/tools/SignedFloodFill.h>

#include "ground/system/memory.h"
#include "space/field/count_leaf_nodes.h"
#include "space/field/rasterise.h"
#include "space/surface/surface.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

openvdb::FloatGrid::Ptr make_level_set(PolygonView mesh, double voxel_size) {
  if (!can_hold(voxel_size))
    throw InvalidInput(
        fmt::format("level set: expected a voxel size above 1.5e-5, which OpenVDB's transforms need, got {:.6g} "
                    "(scale the model up)",
                    voxel_size));
  Surface surface = build_surface(mesh, {});
  if (!surface.facts.closed())
    throw InvalidInput("level set: expected a closed mesh, which has an inside, got another one");
  to_local_frame(surface, voxel_size);
  const double band = openvdb::LEVEL_SET_HALF_WIDTH * voxel_size;
  // Both grids of the band, and the triangles of each leaf node.
  constexpr double kLeafBytes = 2 * 4 * kLeafVoxels + 1000;
  require_memory(
      static_cast<std::size_t>(kLeafBytes * count_leaf_nodes(surface, {band, band}, kLeafWidth * voxel_size, false)),
      "level set");
  openvdb::FloatGrid::Ptr phi = rasterise(surface, {voxel_size, band}).phi;
  openvdb::tools::signedFloodFill(phi->tree());
  phi->setName("surface");
  return phi;
}

}  // namespace vdb_offset
