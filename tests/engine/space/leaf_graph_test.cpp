// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <map>
#include <random>
#include <tuple>

#include "space/field/leaf_graph.h"

using namespace vdb_offset;

namespace {

using Key = std::tuple<int, int, int>;

openvdb::Coord origin_of(std::mt19937& random, int across) {
  const auto coordinate = [&] {
    return kLeafWidth * (static_cast<int>(random() % static_cast<unsigned>(across)) - across / 2);
  };
  const int x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}

Key key(const openvdb::Coord& origin) { return {origin[0], origin[1], origin[2]}; }

/// Grids with these leaf nodes, one voxel of each active.
FieldGrids grids_with(const std::vector<openvdb::Coord>& origins) {
  FieldGrids grids = make_field_grids(1, 100, Vec3d(0.0));
  for (const openvdb::Coord& origin : origins) {
    grids.phi->tree().setValue(origin, 1);
    grids.closest->tree().setValue(origin, 0);
  }
  return grids;
}

/// Both know each other, or neither does; and neighbours lie across the face that says so.
void check_links(const LeafGraph& graph) {
  std::map<Key, std::int32_t> by_origin;
  for (std::size_t i = 0; i < graph.size(); ++i) by_origin[key(graph[i].origin)] = static_cast<std::int32_t>(i);
  REQUIRE(by_origin.size() == graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (int face = 0; face < kFaces; ++face) {
      openvdb::Coord there = graph[i].origin;
      there[face / 2] += face % 2 ? kLeafWidth : -kLeafWidth;
      const auto known = by_origin.find(key(there));
      const std::int32_t expected = known == by_origin.end() ? -1 : known->second;
      const std::int32_t neighbour = graph[i].neighbour[static_cast<std::size_t>(face)];
      CHECK(neighbour == expected);
      if (neighbour < 0) continue;
      const GraphLeaf& other = graph[static_cast<std::size_t>(neighbour)];
      CHECK(other.neighbour[static_cast<std::size_t>(opposite(face))] == static_cast<std::int32_t>(i));
      CHECK(other.colour() != graph[i].colour());
    }
}

}  // namespace

TEST_CASE("leaf graph: leaf nodes know those across their faces, and those that are made", "[leaf_graph]") {
  std::mt19937 random(5);
  std::vector<openvdb::Coord> origins;
  for (int i = 0; i < 100; ++i) origins.push_back(origin_of(random, 6));
  FieldGrids grids = grids_with(origins);
  LeafGraph graph(grids);
  const std::size_t before = graph.size();
  CHECK(before == grids.phi->tree().leafCount());
  check_links(graph);
  // Across every face of every leaf node; asked twice, a neighbour is one.
  for (std::size_t i = 0; i < before; ++i)
    for (int face = 0; face < kFaces; ++face) {
      const auto leaf = static_cast<std::int32_t>(i);
      const std::int32_t neighbour = graph.touch_neighbour(leaf, face);
      CHECK(graph.touch_neighbour(leaf, face) == neighbour);
    }
  graph.link_new_leaves();
  CHECK(graph.size() > before);
  check_links(graph);
  for (std::size_t i = 0; i < before; ++i)
    for (const std::int32_t neighbour : graph[i].neighbour) CHECK(neighbour >= 0);
  // Sweeps tell by their buffers whether they have been there.
  for (std::size_t i = 0; i < graph.size(); ++i) {
    CHECK(graph[i].phi->buffer().empty() == (i >= before));
    CHECK(graph[i].closest->buffer().empty() == (i >= before));
  }
}

TEST_CASE("leaf graph: of the new leaf nodes the grids keep those with active voxels", "[leaf_graph]") {
  FieldGrids grids = grids_with({openvdb::Coord(0, 0, 0)});
  LeafGraph graph(grids);
  const std::int32_t above = graph.touch_neighbour(0, 5), below = graph.touch_neighbour(0, 4);
  graph.link_new_leaves();
  const GraphLeaf& taken = graph[static_cast<std::size_t>(above)];
  taken.phi->allocate();
  taken.closest->allocate();
  taken.phi->setValueOn(3, 0.5F);
  taken.closest->setValueOn(3, 0);
  CHECK(graph[static_cast<std::size_t>(below)].phi->isEmpty());
  CHECK(grids.phi->tree().leafCount() == 3);
  graph.prune();
  CHECK(grids.phi->tree().leafCount() == 2);
  CHECK(grids.closest->tree().leafCount() == 2);
  CHECK(grids.phi->tree().isValueOn(openvdb::Coord(0, 0, kLeafWidth + 3)));
}

TEST_CASE("leaf graph: halo voxels are those that touch the leaf node, one each", "[leaf_graph]") {
  for (int face = 0; face < kFaces; ++face) {
    std::size_t count = 0;
    for_each_halo_voxel(face, [&](int padded, int there) {
      ++count;
      int ijk[3] = {there >> 6, there >> 3 & 7, there & 7};
      CHECK(ijk[face / 2] == (face % 2 ? 0 : kLeafWidth - 1));
      ijk[face / 2] = face % 2 ? kLeafWidth : -1;
      CHECK(padded == padded_index(ijk[0], ijk[1], ijk[2]));
      ijk[face / 2] = face % 2 ? kLeafWidth - 1 : 0;
      CHECK(across(face, padded) == padded_index(ijk[0], ijk[1], ijk[2]));
    });
    CHECK(count == 64);
  }
}
