// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/layers.h"

#include <catch2/catch.hpp>
#include <cstdint>
#include <utility>
#include <vector>

using namespace vdb_offset;

namespace {

/// Stacks of which layer k of vertex v is at (v, k, 0); vertex 1 is flat.
VertexStacks numbered_stacks(std::size_t vertices, std::size_t layers) {
  VertexStacks stacks(vertices, layers);
  for (std::size_t v = 0; v < vertices; ++v)
    for (std::size_t k = 0; k <= layers; ++k)
      stacks.of(v)[k] = Vec3d(static_cast<double>(v), v == 1 ? 0 : static_cast<double>(k), 0);
  return stacks;
}

}  // namespace

TEST_CASE("stacks: each vertex has the wall's position and one for each layer", "[layers][stacks]") {
  const VertexStacks stacks = numbered_stacks(3, 2);
  CHECK(stacks.vertices() == 3);
  CHECK(stacks.layers() == 2);
  for (std::size_t v = 0; v < 3; ++v) {
    REQUIRE(stacks.of(v).size() == 3);
    CHECK(stacks.of(v)[0] == Vec3d(static_cast<double>(v), 0, 0));
    CHECK(stacks.is_flat(v) == (v == 1));
  }
  CHECK(stacks.of(2)[2] == Vec3d(2, 2, 0));
  CHECK(VertexStacks().vertices() == 0);
}

TEST_CASE("stacks: a copy has positions of its own; what is moved from does not", "[layers][stacks]") {
  VertexStacks stacks = numbered_stacks(3, 2);
  VertexStacks copy = stacks;
  copy.of(0)[1] = Vec3d(7, 7, 7);
  CHECK(stacks.of(0)[1] == Vec3d(0, 1, 0));
  VertexStacks assigned;
  assigned = copy;
  CHECK(assigned.of(0)[1] == Vec3d(7, 7, 7));
  const Vec3d* kept = assigned.of(0).data();
  const VertexStacks moved = std::move(assigned);
  CHECK(moved.of(0).data() == kept);
}

TEST_CASE("stacks: vertices that share a stack are at its positions in every layer", "[layers][stacks]") {
  const SharedStacks shared(numbered_stacks(3, 2), {2, 0, 2, 1});
  CHECK(shared.vertices() == 4);
  CHECK(shared.layers() == 2);
  CHECK(shared.of(0).data() == shared.of(2).data());
  CHECK(shared.is_flat(3));
  CHECK_FALSE(shared.is_flat(0));
  CHECK(shared.surface(0) == std::vector<Vec3d>{Vec3d(2, 0, 0), Vec3d(0, 0, 0), Vec3d(2, 0, 0), Vec3d(1, 0, 0)});
  CHECK(shared.surface(2) == std::vector<Vec3d>{Vec3d(2, 2, 0), Vec3d(0, 2, 0), Vec3d(2, 2, 0), Vec3d(1, 0, 0)});
}
