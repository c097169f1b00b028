// SPDX-License-Identifier: Apache-2.0
#include "space/field/field_grids.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "vdb_offset/field.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// Writes to a stream of ours, so that a full disk is noticed: openvdb::io::File hides its stream.
struct Archive : openvdb::io::Archive {
  using openvdb::io::Archive::write;
};

/// Writes grids, which share their trees with others, with metadata as strings.
void write_grids(openvdb::GridPtrVec grids, const std::string& path,
                 const std::vector<std::pair<std::string, std::string>>& metadata) {
  openvdb::initialize();  // registers the grid types that a file may hold; further calls do nothing
  for (const openvdb::GridBase::Ptr& grid : grids)
    for (const auto& [key, value] : metadata) grid->insertMeta(key, openvdb::StringMetadata(value));
  replace_file(path, [&](const std::string& temporary) {
    try {
      std::ofstream file(temporary, std::ios::binary);
      file.exceptions(std::ios::badbit | std::ios::failbit);
      Archive().write(file, grids, true);
      file.close();
    } catch (const std::ios_base::failure&) {
      throw WriteError(path + ": cannot be written: " + std::strerror(errno));
    } catch (const openvdb::Exception& error) {
      throw WriteError(path + ": cannot be written: " + error.what());
    }
  });
}

}  // namespace

FieldGrids make_field_grids(double voxel_size, double background, const Vec3d& origin) {
  FieldGrids grids;
  grids.voxel_size = voxel_size;
  grids.phi = openvdb::FloatGrid::create(static_cast<float>(background));
  grids.closest = openvdb::Int32Grid::create(-1);
  auto transform = openvdb::math::Transform::createLinearTransform(can_hold(voxel_size) ? voxel_size : 1.0);
  if (can_hold(voxel_size)) transform->postTranslate(origin);
  grids.phi->setName("phi");
  grids.phi->setGridClass(openvdb::GRID_LEVEL_SET);
  grids.closest->setName("closest_primitive");
  grids.phi->setTransform(transform);
  grids.closest->setTransform(transform);
  return grids;
}

std::shared_ptr<DistanceField> hand_out(DistanceField&& field, bool closed_surface) {
  if (closed_surface) openvdb::tools::signedFloodFill(field.phi->tree());
  for (const openvdb::GridBase::Ptr& grid :
       {openvdb::GridBase::Ptr(field.phi), openvdb::GridBase::Ptr(field.closest)}) {
    grid->insertMeta("reach_inside", openvdb::DoubleMetadata(field.reach.inside));
    grid->insertMeta("reach_outside", openvdb::DoubleMetadata(field.reach.outside));
  }
  return std::make_shared<DistanceField>(std::move(field));
}

void save_vdb(const DistanceField& field, const std::string& path,
              const std::vector<std::pair<std::string, std::string>>& metadata) {
  if (!can_hold(field.voxel_size))
    throw WriteError(
        fmt::format("{}: expected a voxel size above 1.5e-5, which OpenVDB's transforms need, got {:.6g} "
                    "(scale the model up)",
                    path, field.voxel_size));
  write_grids({field.phi->copyGrid(), field.closest->copyGrid()}, path, metadata);
}

void save_grid(const openvdb::FloatGrid::Ptr& grid, const std::string& path,
               const std::vector<std::pair<std::string, std::string>>& metadata) {
  write_grids({grid->copyGrid()}, path, metadata);
}

}  // namespace vdb_offset
