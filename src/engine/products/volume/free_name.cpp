// SPDX-License-Identifier: Apache-2.0
#include "products/volume/free_name.h"

#include <fmt/format.h>

#include <algorithm>

namespace vdb_offset {

std::string free_name(const VolumeMesh& mesh, const std::string& wanted) {
  std::string name = wanted;
  for (int n = 2; std::ranges::find(mesh.patches, name, &BoundaryPatch::name) != mesh.patches.end(); ++n)
    name = fmt::format("{}_{}", wanted, n);
  return name;
}

}  // namespace vdb_offset
