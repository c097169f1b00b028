// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/prevailing_point.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "ground/system/assert.h"

namespace vdb_offset {
namespace {

// Planes of which the point may lie on any three. Reasoned: of a corner of more planes the smallest hardly count, and
// the work grows with the third power.
constexpr std::size_t kMostPlanes = 10;
// Least determinant of what three, or two, normals span. Reasoned: they meet farther off than any miter may go.
constexpr double kLeastSpan = 1e-6;
// Planes of at least this share of the area have to be this near to where they ought to be. Reasoned: with less, none
// prevails.
constexpr double kPrevailing = 0.5, kNearEnough = 0.1;

/// The smallest x on two or three planes; nothing where they do not meet.
std::optional<Vec3d> smallest_on(const Vec3d& a, const Vec3d& b) {
  const double aa = a.lengthSqr(), bb = b.lengthSqr(), ab = a.dot(b), span = aa * bb - ab * ab;
  if (!(span > kLeastSpan)) return std::nullopt;
  return (a * (bb - ab) + b * (aa - ab)) / span;
}
std::optional<Vec3d> smallest_on(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double span = a.dot(b.cross(c));
  if (!(std::abs(span) > kLeastSpan)) return std::nullopt;
  return (b.cross(c) + c.cross(a) + a.cross(b)) / span;
}

/// The best point so far, and what it costs.
class BestPoint {
 public:
  BestPoint(std::span<const Vec3d> normals, std::span<const double> areas, double longest)
      : normals_(normals), areas_(areas), longest_(longest) {}

  void offer(const Vec3d& x) {
    if (!(x.lengthSqr() <= longest_ * longest_)) return;
    double cost = 0;
    for (std::size_t i = 0; i < normals_.size(); ++i) cost += areas_[i] * std::abs(normals_[i].dot(x) - 1);
    if (!(cost < least_)) return;
    least_ = cost;
    best_ = x;
  }

  const std::optional<Vec3d>& best() const { return best_; }

 private:
  std::span<const Vec3d> normals_;
  std::span<const double> areas_;
  double longest_, least_ = std::numeric_limits<double>::infinity();
  std::optional<Vec3d> best_;
};

}  // namespace

void for_each_point_on_planes(std::span<const Vec3d> normals, std::span<const double> areas, std::size_t most,
                              const std::function<void(const Vec3d& x)>& visit) {
  VDB_OFFSET_ASSERT(normals.size() == areas.size());
  std::vector<std::size_t> largest(normals.size());
  std::iota(largest.begin(), largest.end(), std::size_t{0});
  std::stable_sort(largest.begin(), largest.end(), [&](std::size_t i, std::size_t k) { return areas[i] > areas[k]; });
  std::erase_if(largest, [&](std::size_t i) { return !(normals[i].lengthSqr() > kLeastSpan); });
  largest.resize(std::min(largest.size(), most));
  const auto visit_if_any = [&](const std::optional<Vec3d>& x) {
    if (x) visit(*x);
  };
  for (std::size_t i = 0; i < largest.size(); ++i) {
    const Vec3d& a = normals[largest[i]];
    visit(a / a.lengthSqr());
    for (std::size_t k = 0; k < i; ++k) {
      const Vec3d& b = normals[largest[k]];
      visit_if_any(smallest_on(a, b));
      for (std::size_t l = 0; l < k; ++l) visit_if_any(smallest_on(a, b, normals[largest[l]]));
    }
  }
}

std::optional<Vec3d> prevailing_point(std::span<const Vec3d> normals, std::span<const double> areas, double longest) {
  BestPoint best(normals, areas, longest);
  for_each_point_on_planes(normals, areas, kMostPlanes, [&](const Vec3d& x) { best.offer(x); });
  if (!best.best()) return std::nullopt;
  double all = 0, near = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    all += areas[i];
    if (std::abs(normals[i].dot(*best.best()) - 1) <= kNearEnough) near += areas[i];
  }
  if (!(near >= kPrevailing * all)) return std::nullopt;
  return best.best();
}

}  // namespace vdb_offset
