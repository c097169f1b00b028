// SPDX-License-Identifier: Apache-2.0
#include "ground/numbers/box_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "ground/numbers/index_set.h"
#include "ground/system/assert.h"

namespace vdb_offset {
namespace {

void set_box(BoxTree::Siblings& siblings, std::size_t i, const FloatBox& box) {
  for (std::size_t k = 0; k < 3; ++k) {
    siblings.lower[k][i] = box.lower[k];
    siblings.upper[k][i] = box.upper[k];
  }
}

}  // namespace

FloatBox BoxTree::around(const Siblings& siblings) {
  FloatBox box;
  for (std::size_t k = 0; k < 3; ++k)
    for (int i = 0; i < kWidth; ++i) {
      box.lower[k] = std::min(box.lower[k], siblings.lower[k][i]);
      box.upper[k] = std::max(box.upper[k], siblings.upper[k][i]);
    }
  return box;
}

void BoxTree::build(std::size_t count, const std::function<FloatBox(std::size_t)>& box_of) {
  VDB_OFFSET_ASSERT(count > 0);
  levels_.clear();
  do {
    const bool lowest = levels_.empty();
    std::vector<Siblings> level((count + kWidth - 1) / kWidth);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, level.size(), 64), [&](const auto& range) {
      for (std::size_t node = range.begin(); node != range.end(); ++node)
        for (std::size_t i = 0; i < kWidth; ++i) {
          const std::size_t child = node * kWidth + i;
          set_box(level[node], i, child >= count ? FloatBox{} : lowest ? box_of(child) : around(levels_.back()[child]));
        }
    });
    count = level.size();
    levels_.push_back(std::move(level));
  } while (count > 1);
}

void BoxTree::refit(std::span<const std::uint32_t> changed, const std::function<FloatBox(std::size_t)>& box_of) {
  VDB_OFFSET_ASSERT(is_sorted_unique(changed));
  std::vector<std::uint32_t> nodes(changed.begin(), changed.end());
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    for (const auto child : nodes)
      set_box(levels_[level][child / kWidth], child % kWidth,
              level == 0 ? box_of(child) : around(levels_[level - 1][child]));
    for (auto& node : nodes) node /= kWidth;
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
}

}  // namespace vdb_offset
