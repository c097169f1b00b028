// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "vdb_offset/error.h"
#include "vdb_offset/grids/write_grids.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset {

void save_vdb(const DistanceField& field, const std::string& path, bool closed_surface,
              const std::vector<std::pair<std::string, std::string>>& metadata) {
  if (!can_hold(field.voxel_size))
    throw WriteError(
        fmt::format("{}: expected a voxel size above 1.5e-5, which OpenVDB's transforms need, got {:.6g} "
                    "(scale the model up)",
                    path, field.voxel_size));
  replace_file(path, [&](const std::string& temporary) {
    try {
      std::ofstream file(temporary, std::ios::binary);
      file.exceptions(std::ios::badbit | std::ios::failbit);
      write_grids(path, file, field, closed_surface, metadata);
      file.close();
    } catch (const std::ios_base::failure&) {
      throw WriteError(path + ": cannot be written: " + std::strerror(errno));
    }
  });
}

}  // namespace vdb_offset
