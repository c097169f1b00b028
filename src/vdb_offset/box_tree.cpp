#include "vdb_offset/box_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

namespace vdb_offset {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr FloatBox kEmpty{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

FloatBox around(const BoxTree::Siblings& siblings) {
  FloatBox box = kEmpty;
  for (std::size_t k = 0; k < 3; ++k)
    for (int i = 0; i < BoxTree::kWidth; ++i) {
      box.lower[k] = std::min(box.lower[k], siblings.lower[k][i]);
      box.upper[k] = std::max(box.upper[k], siblings.upper[k][i]);
    }
  return box;
}

}  // namespace

void BoxTree::build(std::size_t count, const std::function<FloatBox(std::size_t)>& box_of) {
  levels_.clear();
  do {
    const bool lowest = levels_.empty();
    std::vector<Siblings> level((count + kWidth - 1) / kWidth);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, level.size(), 64), [&](const auto& range) {
      for (std::size_t node = range.begin(); node != range.end(); ++node)
        for (std::size_t i = 0; i < kWidth; ++i) {
          const std::size_t child = node * kWidth + i;
          const FloatBox box = child >= count ? kEmpty : lowest ? box_of(child) : around(levels_.back()[child]);
          for (std::size_t k = 0; k < 3; ++k) {
            level[node].lower[k][i] = box.lower[k];
            level[node].upper[k][i] = box.upper[k];
          }
        }
    });
    count = level.size();
    levels_.push_back(std::move(level));
  } while (count > 1);
}

}  // namespace vdb_offset
