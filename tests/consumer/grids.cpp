// SPDX-License-Identifier: Apache-2.0
// The distance field as OpenVDB's grids: a program of the component core is linked to OpenVDB, and loads no module.
#include <vdb_offset/field_grids.h>
#include <vdb_offset/offset.h>

int main() {
  vdb_offset::Polygons tetrahedron;
  tetrahedron.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (auto face : {std::array{0u, 2u, 1u}, {0u, 1u, 3u}, {1u, 2u, 3u}, {2u, 0u, 3u}})
    tetrahedron.add_face({face[0], face[1], face[2]});
  vdb_offset::OffsetOptions options;
  options.distance = 0.1;
  options.keep_field = true;
  const auto result = vdb_offset::offset(tetrahedron.view(), options);
  const vdb_offset::FieldGrids grids = vdb_offset::make_grids(*result.field);
  const auto at = openvdb::Coord::round(grids.phi->worldToIndex({0.2, 0.2, -0.08}));
  const double expected = -grids.phi->indexToWorld(at)[2];
  const bool same = grids.phi->activeVoxelCount() == result.statistics.active_voxels &&
                    grids.closest->tree().isValueOn(at) && grids.closest->tree().getValue(at) == 0;
  return same && std::abs(grids.phi->tree().getValue(at) - expected) < 1e-6 ? 0 : 1;
}
