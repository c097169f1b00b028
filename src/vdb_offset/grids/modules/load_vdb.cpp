// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/grids/modules/vdb_module.h"
#include "vdb_offset/io/base/open_module.h"

// Stands in for what uses OpenVDB's library where that is a module.
namespace vdb_offset {
namespace {

const VdbModule& vdb_to_write(const std::string& path) {
  using io::ModuleUse;
  static const auto& module = *static_cast<const VdbModule*>(io::open_module(path, "vdb_offset_vdb", ModuleUse::Write));
  return module;
}

const VdbModule& vdb_to_work() {
  using io::ModuleUse;
  static const auto& module =
      *static_cast<const VdbModule*>(io::open_module("capture", "vdb_offset_vdb", ModuleUse::Work));
  return module;
}

}  // namespace

void require_vdb_writer(const std::string& path) { vdb_to_write(path); }

void write_grids(const std::string& path, std::ostream& file, const DistanceField& field, bool closed_surface,
                 const std::vector<std::pair<std::string, std::string>>& metadata) {
  vdb_to_write(path).write_grids(path, file, field, closed_surface, metadata);
}

void require_level_sets() { vdb_to_work(); }

std::unique_ptr<const LevelSet> make_level_set(std::span<const openvdb::Coord> origins, float beyond,
                                               const FillLeaf& fill) {
  return vdb_to_work().make_level_set(origins, beyond, fill);
}

}  // namespace vdb_offset
