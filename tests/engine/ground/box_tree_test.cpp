// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "ground/numbers/box_tree.h"

using namespace vdb_offset;

namespace {

/// Boxes of which neighbours are near each other, one in seven of them empty.
std::vector<FloatBox> some_boxes(std::size_t count) {
  std::mt19937 random(static_cast<unsigned>(count));
  std::uniform_real_distribution<float> size(0, 1);
  std::vector<FloatBox> boxes(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 7 == 3) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      boxes[i].lower[k] = 0.1F * static_cast<float>(i) + size(random);
      boxes[i].upper[k] = boxes[i].lower[k] + size(random);
    }
  }
  return boxes;
}

bool meet(const FloatBox& a, const FloatBox& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (a.lower[k] > b.upper[k] || a.upper[k] < b.lower[k]) return false;
  return true;
}

std::vector<std::size_t> found_by(const BoxTree& tree, const FloatBox& box) {
  std::vector<std::size_t> found;
  tree.for_each_overlap(box, [&](std::size_t i) { found.push_back(i); });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::size_t> found_by(const std::vector<FloatBox>& boxes, const FloatBox& box) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (meet(boxes[i], box)) found.push_back(i);
  return found;
}

}  // namespace

TEST_CASE("box tree: finds what brute force finds", "[box_tree]") {
  for (const std::size_t count : {1U, 7U, 8U, 9U, 64U, 65U, 700U}) {
    std::vector<FloatBox> boxes = some_boxes(count);
    BoxTree tree;
    tree.build(count, [&](std::size_t i) { return boxes[i]; });
    CHECK(tree.levels().back().size() == 1);
    for (const FloatBox& box : some_boxes(40)) CHECK(found_by(tree, box) == found_by(boxes, box));
    // Some of the boxes somewhere else.
    std::vector<std::uint32_t> changed;
    for (std::uint32_t i = 0; i < count; i += 5) {
      changed.push_back(i);
      boxes[i] = {{50, 50, 50}, {51, 51, 51}};
    }
    tree.refit(changed, [&](std::size_t i) { return boxes[i]; });
    for (const FloatBox& box : some_boxes(40)) CHECK(found_by(tree, box) == found_by(boxes, box));
    CHECK(found_by(tree, {{50, 50, 50}, {51, 51, 51}}).size() >= changed.size());
  }
}

TEST_CASE("box tree: boxes that only touch meet, and empty ones meet nothing", "[box_tree]") {
  const std::vector<FloatBox> boxes = {{{0, 0, 0}, {1, 1, 1}}, {}};
  BoxTree tree;
  tree.build(boxes.size(), [&](std::size_t i) { return boxes[i]; });
  CHECK(found_by(tree, {{1, 1, 1}, {2, 2, 2}}) == std::vector<std::size_t>{0});
  CHECK(found_by(tree, {{1.0001F, 0, 0}, {2, 1, 1}}).empty());
  constexpr float kAll = 1e30F;
  CHECK(found_by(tree, {{-kAll, -kAll, -kAll}, {kAll, kAll, kAll}}) == std::vector<std::size_t>{0});
}

TEST_CASE("box tree: a search ends with the first box that is wanted", "[box_tree]") {
  const std::vector<FloatBox> boxes = some_boxes(500);
  BoxTree tree;
  tree.build(boxes.size(), [&](std::size_t i) { return boxes[i]; });
  constexpr float kAll = 1e30F;
  const FloatBox all{{-kAll, -kAll, -kAll}, {kAll, kAll, kAll}};
  std::size_t calls = 0;
  CHECK(tree.any_overlap(all, [&](std::size_t) { return ++calls == 5; }));
  CHECK(calls == 5);
  CHECK_FALSE(tree.any_overlap(all, [](std::size_t) { return false; }));
}
