// Compiled with -frounding-math, which CGAL's interval arithmetic needs.
#include "vdb_offset/crossings.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Segment_3_Triangle_3.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vdb_offset/box_tree.h"

namespace vdb_offset {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Segment = Kernel::Segment_3;

class CrossingFinder {
 public:
  CrossingFinder(const Surface& surface, std::span<const Vec3d> positions, std::span<const std::uint8_t> moved)
      : surface_(surface), positions_(positions), moved_(moved) {
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
      if (has_moved(t)) in_tree_.push_back(t);
    if (!in_tree_.empty()) tree_.build(in_tree_.size(), [&](std::size_t i) { return box_of(in_tree_[i]); });
  }

  bool has_work() const { return !in_tree_.empty(); }

  /// Adds the moved triangles that triangle t meets; of two that have moved, the one with the smaller number looks.
  void find(std::uint32_t t, std::vector<TrianglePair>& found) const {
    tree_.for_each_overlap(box_of(t), [&](std::size_t i) {
      const std::uint32_t other = in_tree_[i];
      if (other == t || (other < t && has_moved(t))) return;
      if (!solid(t).is_degenerate() && !solid(other).is_degenerate() && meet(t, other))
        found.push_back(std::minmax(t, other));
    });
  }

 private:
  bool has_moved(std::uint32_t t) const { return moved_.empty() || moved_[t]; }

  Point point(std::uint32_t vertex) const {
    const Vec3d& p = positions_[vertex];
    return {p[0], p[1], p[2]};
  }
  Triangle solid(std::uint32_t t) const {
    const auto& [a, b, c] = surface_.triangles[t];
    return {point(a), point(b), point(c)};
  }

  /// Rounded outwards, relative to the surface's own frame.
  FloatBox box_of(std::size_t t) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    FloatBox box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    for (const auto v : surface_.triangles[t])
      for (std::size_t k = 0; k < 3; ++k) {
        const auto x = static_cast<float>(positions_[v][static_cast<int>(k)] - surface_.origin[static_cast<int>(k)]);
        const float rounding = std::abs(x) * 0x1p-23f + std::numeric_limits<float>::denorm_min();
        box.lower[k] = std::min(box.lower[k], x - rounding);
        box.upper[k] = std::max(box.upper[k], x + rounding);
      }
    return box;
  }

  bool meet(std::uint32_t s, std::uint32_t t) const {
    const auto &a = surface_.triangles[s], &b = surface_.triangles[t];
    std::uint32_t shared[3], only_a[3], only_b[3];
    int n_shared = 0, n_a = 0, n_b = 0;
    for (const auto v : a) (std::count(b.begin(), b.end(), v) ? shared[n_shared++] : only_a[n_a++]) = v;
    for (const auto v : b)
      if (!std::count(a.begin(), a.end(), v)) only_b[n_b++] = v;
    if (n_shared == 0) return CGAL::do_intersect(solid(s), solid(t));
    if (n_shared == 1)
      return CGAL::do_intersect(Segment(point(only_a[0]), point(only_a[1])), solid(t)) ||
             CGAL::do_intersect(Segment(point(only_b[0]), point(only_b[1])), solid(s));
    if (n_shared == 3) return false;  // the same triangle twice, or a sheet's two sides
    const Point p = point(shared[0]), q = point(shared[1]), pa = point(only_a[0]), pb = point(only_b[0]);
    return CGAL::coplanar(p, q, pa, pb) && CGAL::coplanar_orientation(p, q, pa, pb) == CGAL::POSITIVE;
  }

  const Surface& surface_;
  std::span<const Vec3d> positions_;
  std::span<const std::uint8_t> moved_;
  std::vector<std::uint32_t> in_tree_;  // the triangles that have moved
  BoxTree tree_;
};

}  // namespace

std::vector<TrianglePair> find_crossings(const Surface& surface, std::span<const Vec3d> positions,
                                         std::span<const std::uint8_t> moved) {
  const CrossingFinder finder(surface, positions, moved);
  if (!finder.has_work()) return {};
  tbb::enumerable_thread_specific<std::vector<TrianglePair>> found;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, surface.triangles.size(), 256), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t)
      finder.find(static_cast<std::uint32_t>(t), found.local());
  });
  std::vector<TrianglePair> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace vdb_offset
