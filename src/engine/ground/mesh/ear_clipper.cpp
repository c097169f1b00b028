// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/ear_clipper.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

namespace vdb_offset {
namespace {

constexpr std::uint32_t kNoCorner = ~std::uint32_t{0};

bool same(Point2 p, Point2 q) { return p.x == q.x && p.y == q.y; }

struct Ear {
  Point2 a, b, c;

  /// Whether a point is in the ear. Points on its edges are.
  bool holds(Point2 p) const { return cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0; }
};

struct Box2 {
  Point2 lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point2 upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  void include(Point2 p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
  /// Whether all of the box is to the right of the line from a to b. It is enough to look at the corner that is
  /// farthest to the left: rounding is monotone, so that cross() of no other point in the box is above that corner's.
  bool is_right_of(Point2 a, Point2 b) const {
    return cross(a, b, {b.y - a.y >= 0 ? lower.x : upper.x, b.x - a.x >= 0 ? upper.y : lower.y}) < 0;
  }
  bool misses(const Ear& ear) const {
    return is_right_of(ear.a, ear.b) || is_right_of(ear.b, ear.c) || is_right_of(ear.c, ear.a);
  }
};

/// The corners that are not cut off yet, in a binary tree of boxes: node i has the children 2 i + 1 and 2 i + 2.
class CornerTree {
 public:
  explicit CornerTree(const std::vector<Point2>& corners) : corners_(corners), order_(corners.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    const std::size_t leaves = std::bit_ceil((corners.size() + kLeaf - 1) / kLeaf);
    first_leaf_ = leaves - 1;
    nodes_.resize(2 * leaves - 1);
    leaf_of_.resize(corners.size());
    build(0, 0, corners.size());
  }

  void remove(std::uint32_t corner) {
    for (std::size_t node = leaf_of_[corner];; node = (node - 1) / 2) {
      --nodes_[node].left;
      if (node == 0) return;
    }
  }

  /// A corner in the ear that is not cut off and for which is_it() holds; kNoCorner if there is none.
  template <class IsIt>
  std::uint32_t find(const Ear& ear, IsIt&& is_it, std::size_t at = 0) const {
    const Node& node = nodes_[at];
    if (node.left == 0 || node.box.misses(ear)) return kNoCorner;
    if (at < first_leaf_) {
      const std::uint32_t found = find(ear, is_it, 2 * at + 1);
      return found != kNoCorner ? found : find(ear, is_it, 2 * at + 2);
    }
    for (std::size_t i = node.begin; i < node.end; ++i)
      if (ear.holds(corners_[order_[i]]) && is_it(order_[i])) return order_[i];
    return kNoCorner;
  }

 private:
  static constexpr std::size_t kLeaf = 8;  // corners in a lowest box; not measured beside other numbers
  struct Node {
    Box2 box;
    std::uint32_t begin = 0, end = 0, left = 0;
  };

  void build(std::size_t at, std::size_t begin, std::size_t end) {
    Node& node = nodes_[at];
    node.begin = static_cast<std::uint32_t>(begin);
    node.end = static_cast<std::uint32_t>(end);
    node.left = node.end - node.begin;
    for (std::size_t i = begin; i < end; ++i) node.box.include(corners_[order_[i]]);
    if (at >= first_leaf_) {
      for (std::size_t i = begin; i < end; ++i) leaf_of_[order_[i]] = static_cast<std::uint32_t>(at);
      return;
    }
    const std::size_t middle = (begin + end) / 2;
    const bool wide = node.box.upper.x - node.box.lower.x > node.box.upper.y - node.box.lower.y;
    const auto item_at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(item_at(begin), item_at(middle), item_at(end), [&](std::uint32_t i, std::uint32_t j) {
      return wide ? corners_[i].x < corners_[j].x : corners_[i].y < corners_[j].y;
    });
    build(2 * at + 1, begin, middle);
    build(2 * at + 2, middle, end);
  }

  const std::vector<Point2>& corners_;
  std::vector<std::uint32_t> order_, leaf_of_;
  std::vector<Node> nodes_;
  std::size_t first_leaf_ = 0;
};

/// A set of small numbers that finds the next member from a number on. Level 0 has a bit for each number; each further
/// level has a bit for each word of the one below, which is set if that word is not zero.
class NumberSet {
 public:
  explicit NumberSet(std::uint32_t count) {
    for (std::size_t size = count; levels_.empty() || size > 1;) {
      size = (size + 63) / 64;
      levels_.emplace_back(size, 0);
    }
    for (std::uint32_t i = 0; i < count; ++i) add(i);
  }
  void add(std::uint32_t i) {
    for (auto& level : levels_) {
      level[i / 64] |= std::uint64_t{1} << i % 64;
      i /= 64;
    }
  }
  void remove(std::uint32_t i) {
    for (auto& level : levels_) {
      level[i / 64] &= ~(std::uint64_t{1} << i % 64);
      if (level[i / 64] != 0) return;
      i /= 64;
    }
  }
  /// The least member that is not below `from`; kNoCorner if there is none.
  std::uint32_t next(std::uint32_t from) const {
    for (std::size_t l = 0; l < levels_.size(); ++l) {
      if (from / 64 >= levels_[l].size()) return kNoCorner;
      const std::uint64_t rest = levels_[l][from / 64] & ~std::uint64_t{0} << from % 64;
      if (rest != 0) {
        std::uint32_t i = from / 64 * 64 + static_cast<std::uint32_t>(std::countr_zero(rest));
        while (l-- > 0) i = i * 64 + static_cast<std::uint32_t>(std::countr_zero(levels_[l][i]));
        return i;
      }
      from = from / 64 + 1;
    }
    return kNoCorner;
  }

 private:
  std::vector<std::vector<std::uint64_t>> levels_;
};

/// Cuts ears off a polygon. The corners that are left are a linked ring in the order of their numbers.
class EarClipper {
 public:
  explicit EarClipper(std::vector<Point2> corners)
      : corners_(std::move(corners)),
        left_(static_cast<std::uint32_t>(corners_.size())),
        next_(left_),
        previous_(left_),
        is_gone_(left_, 0),
        waits_for_(left_, kNoCorner),
        first_waiting_(left_, kNoCorner),
        tree_(corners_),
        unknown_(left_) {
    for (std::uint32_t k = 0; k < left_; ++k) {
      next_[k] = (k + 1) % left_;
      previous_[k] = (k + left_ - 1) % left_;
    }
    triangles_.reserve(left_ - 2);
  }

  std::vector<std::array<std::uint32_t, 3>> run() {
    std::uint32_t at = 0;
    const bool large = left_ > kLargePolygon;
    while (left_ > 3) {
      at = next_ear(at);
      cut(at);
      at = next_[at];
      if (large) at = next_[at];
    }
    triangles_.push_back({previous_[at], at, next_[at]});
    return std::move(triangles_);
  }

 private:
  /// The next corner that is an ear, from `from` on; `from` itself if no corner is an ear.
  std::uint32_t next_ear(std::uint32_t from) {
    for (std::uint32_t k = from;;) {
      k = unknown_.next(k);
      if (k == kNoCorner) k = unknown_.next(0);
      if (k == kNoCorner) return from;
      if (is_ear(k)) return k;
      unknown_.remove(k);
    }
  }

  /// Whether a corner is an ear. If another corner lies in it, notes that this one waits for the other to be cut off.
  bool is_ear(std::uint32_t k) {
    const Ear ear{corners_[previous_[k]], corners_[k], corners_[next_[k]]};
    waits_for_[k] = kNoCorner;
    if (cross(ear.a, ear.b, ear.c) <= 0) return false;
    // Other corners at the positions of the ear's own do not count: a bridge to a hole passes its ends twice.
    const std::uint32_t in_the_way = tree_.find(ear, [&](std::uint32_t m) {
      const Point2 p = corners_[m];
      return !is_gone_[m] && !same(p, ear.a) && !same(p, ear.b) && !same(p, ear.c);
    });
    if (in_the_way == kNoCorner) return true;
    waits_for_[k] = in_the_way;
    waiting_.push_back({k, first_waiting_[in_the_way]});
    first_waiting_[in_the_way] = static_cast<std::uint32_t>(waiting_.size() - 1);
    return false;
  }

  void cut(std::uint32_t k) {
    const std::uint32_t before = previous_[k], after = next_[k];
    triangles_.push_back({before, k, after});
    next_[before] = after;
    previous_[after] = before;
    --left_;
    is_gone_[k] = 1;
    tree_.remove(k);
    unknown_.remove(k);
    for (std::uint32_t i = first_waiting_[k]; i != kNoCorner; i = waiting_[i].next)
      if (const auto corner = waiting_[i].corner; waits_for_[corner] == k && !is_gone_[corner]) unknown_.add(corner);
    unknown_.add(before);
    unknown_.add(after);
  }

  /// A corner that waits for another one to be cut off, and the next in the list of corners that wait for that one.
  struct Waiting {
    std::uint32_t corner, next;
  };

  std::vector<Point2> corners_;
  std::uint32_t left_;
  std::vector<std::uint32_t> next_, previous_;
  std::vector<std::uint8_t> is_gone_;
  std::vector<std::uint32_t> waits_for_, first_waiting_;
  std::vector<Waiting> waiting_;
  CornerTree tree_;
  NumberSet unknown_;  // corners that may be ears
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> clip_ears(std::vector<Point2> corners) {
  return EarClipper(std::move(corners)).run();
}

}  // namespace vdb_offset
