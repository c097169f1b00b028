// SPDX-License-Identifier: Apache-2.0
#include "products/layers/layer_grower.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

using namespace vdb_offset;

namespace {

/// A wall along x: vertices `spacing` apart, a column between each two, layers straight up. A column is valid as long
/// as neither of its corners is thicker than a limit, an outermost vertex free of faults up to another one.
class LineWall final : public LayerWall {
 public:
  LineWall(RailStacks& stacks, std::size_t vertices) : LayerWall(stacks), most_of_vertex(vertices, kNoLimit) {
    for (std::uint32_t c = 0; c + 1 < vertices; ++c) corners_.push_back({c, c + 1});
    for (std::uint32_t v = 0; v < vertices; ++v) {
      auto& around = around_.emplace_back();
      if (v > 0) around.push_back(v - 1);
      if (v + 1 < vertices) around.push_back(v);
    }
    most_of_column.assign(corners_.size(), kNoLimit);
  }
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

  bool moves(std::uint32_t) const override { return true; }
  bool sees_all_faces(std::uint32_t, const Vec3d&) const override { return true; }
  Vec3d direction_of(std::uint32_t) const override { return {0, 0, 1}; }
  std::size_t column_count() const override { return corners_.size(); }
  std::span<const std::uint32_t> base(std::size_t column) const override { return corners_[column]; }
  std::span<const std::uint32_t> columns_around(std::uint32_t v) const override { return around_[v]; }
  bool is_valid(std::size_t column) const override {
    return std::all_of(corners_[column].begin(), corners_[column].end(),
                       [&](std::uint32_t v) { return thickness(v) <= most_of_column[column]; });
  }
  void put(const Indices& vertices) override {
    for (const auto v : vertices)
      for (std::size_t k = 0; k < stacks_.of(v).size(); ++k) {
        const double height = k == 0 ? 0 : stacks_.share(v) * stacks_.asked().heights[k - 1][v];
        stacks_.of(v)[k] = stacks_.asked().source[v] + Vec3d(0, 0, height);
      }
  }
  void find_faults(const Indices&) override {}
  Indices faulty_vertices() const override {
    Indices faulty;
    for (std::uint32_t v = 0; v < around_.size(); ++v)
      if (thickness(v) > most_of_vertex[v]) faulty.push_back(v);
    return faulty;
  }
  double distance_of(std::uint32_t v) const override { return thickness(v); }

  std::vector<double> most_of_vertex, most_of_column;

 private:
  double thickness(std::uint32_t v) const { return stacks_.outermost(v)[2] - stacks_.asked().source[v][2]; }

  std::vector<std::array<std::uint32_t, 2>> corners_;
  std::vector<Indices> around_;
};

struct GrownLine {
  LayerStack stack;
  Paths paths;
};

/// Two layers of heights 0.5 and 1 on a wall whose limits limit(wall) sets.
template <class Limit>
GrownLine grow_line(std::size_t vertices, double spacing, Limit&& limit) {
  std::vector<Vec3d> source;
  for (std::size_t v = 0; v < vertices; ++v) source.emplace_back(static_cast<double>(v) * spacing, 0, 0);
  const std::vector<Distances> heights{0.5, 1.0};
  GrownLine grown;
  grown.paths.displacement.assign(vertices, Vec3d(0, 0, 1));
  grown.paths.achieved.assign(vertices, 1);
  grown.paths.state.assign(vertices, VertexState::Reached);
  const AskedLayers asked(source, Vec3d(0.0), heights);
  RailStacks stacks(asked, grown.paths);
  LineWall wall(stacks, vertices);
  limit(wall);
  const ProgressCallback nobody;
  Progress progress(nobody, Stage::Layers, 1);
  grown.stack = grow_on(wall, grown.paths, {}, progress);
  return grown;
}

}  // namespace

TEST_CASE("grower: where all is valid all heights are kept", "[layers][grower]") {
  const GrownLine grown = grow_line(5, 1, [](LineWall&) {});
  CHECK(grown.stack.share == std::vector<double>(5, 1));
  CHECK(grown.stack.statistics.thinned_vertices == 0);
  CHECK(grown.stack.statistics.wrong_columns == 0);
  for (std::size_t v = 0; v < 5; ++v) {
    CHECK(grown.paths.displacement[v] == Vec3d(0, 0, 1));
    CHECK(grown.paths.state[v] == VertexState::Reached);
    CHECK(grown.stack.stacks.of(v)[1][2] == 0.5);
  }
}

TEST_CASE("grower: an invalid column keeps at least five sixths of what is valid, and others keep all",
          "[layers][grower][oracle]") {
  for (const double most : {0.9, 0.5, 0.3, 0.07}) {
    CAPTURE(most);
    // So far apart that no neighbour has to be thinned for evenness.
    const GrownLine grown = grow_line(6, 10, [&](LineWall& wall) { wall.most_of_column[2] = most; });
    CHECK(grown.stack.statistics.wrong_columns == 1);
    CHECK(grown.stack.statistics.thinned_vertices == 2);
    CHECK(grown.stack.statistics.flat_vertices == 0);
    for (std::uint32_t v = 0; v < 6; ++v) {
      const double share = grown.stack.share[v];
      if (v != 2 && v != 3) {
        CHECK(share == 1);
        continue;
      }
      CHECK(share <= most);
      CHECK(share > most * 5 / 6);
      CHECK(grown.paths.state[v] == VertexState::Limited);
      CHECK(grown.paths.achieved[v] == Approx(share).epsilon(1e-15));
      CHECK(grown.paths.displacement[v] == Vec3d(0, 0, share));
    }
  }
}

TEST_CASE("grower: neighbours differ by no more than half the edge between them", "[layers][grower][oracle]") {
  constexpr double kMost = 0.2, kSpacing = 0.4;
  const GrownLine grown = grow_line(11, kSpacing, [&](LineWall& wall) { wall.most_of_vertex[5] = kMost; });
  const std::vector<double>& share = grown.stack.share;
  CHECK(share[5] <= kMost);
  CHECK(share[5] > kMost * 5 / 6);
  for (std::size_t v = 0; v + 1 < share.size(); ++v)
    CHECK(std::abs(share[v + 1] - share[v]) <= kSpacing / 2 * (1 + 1e-9));
  // Each of the others is let out as far as that leaves it, but for the last step: less than a sixth.
  for (std::size_t v = 0; v < share.size(); ++v) {
    const double apart = std::abs(static_cast<double>(v) - 5), room = std::min(1.0, share[5] + apart * kSpacing / 2);
    CAPTURE(v);
    CHECK(share[v] > room * 5 / 6);
  }
}

TEST_CASE("grower: a vertex that may have no height at all becomes flat, and its neighbours lean on it",
          "[layers][grower]") {
  const GrownLine grown = grow_line(5, 1, [](LineWall& wall) { wall.most_of_vertex[2] = 0; });
  CHECK(grown.stack.share[2] == 0);
  CHECK(grown.stack.stacks.is_flat(2));
  CHECK(grown.stack.statistics.flat_vertices == 1);
  CHECK(grown.paths.achieved[2] == 0);
  for (const std::size_t v : {1u, 3u}) {
    CHECK(grown.stack.share[v] <= 0.5 * (1 + 1e-9));
    CHECK(grown.stack.share[v] > 0.5 * 5 / 6);
  }
}
