// SPDX-License-Identifier: Apache-2.0
#include <vdb_offset/offset.h>

int main() {
  vdb_offset::Polygons tetrahedron;
  tetrahedron.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (auto face : {std::array{0u, 2u, 1u}, {0u, 1u, 3u}, {1u, 2u, 3u}, {2u, 0u, 3u}})
    tetrahedron.add_face({face[0], face[1], face[2]});
  const auto result = vdb_offset::offset(tetrahedron.view(), {.distance = 0.1});
  return vdb_offset::falls_short(result.states[0]) ? 1 : 0;
}
