#include "vdb_offset/vertex_stacks.h"

#include "vdb_offset/base/parallel.h"

namespace vdb_offset {

std::vector<Vec3d> SharedStacks::surface(std::size_t layer) const {
  std::vector<Vec3d> places(vertices());
  for_each_index(vertices(), [&](std::size_t v) { places[v] = of(v)[layer]; });
  return places;
}

}  // namespace vdb_offset
