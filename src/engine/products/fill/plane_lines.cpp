// SPDX-License-Identifier: Apache-2.0
#include "products/fill/plane_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;
using Pair = std::array<Index, 2>;

// The sine of the angle between planes below which they do not cross.
constexpr double kParallel = 1e-6;

/// An end of a segment on a line.
struct PlaneLineEnd {
  Index point;
  double place;        // along the line
  bool leads_forward;  // what is to be filled lies in the line's direction
};

class PlaneLineFinder {
 public:
  PlaneLineFinder(std::span<const Vec3d> points, std::span<const OpenPlane> planes)
      : points_(points), planes_(planes) {}

  PlaneLines run() {
    find_ends();
    for (auto& [pair, ends] : ends_of_) follow(pair, ends);
    join_corners();
    return std::move(lines_);
  }

 private:
  Vec3d place(Index p) const { return p < points_.size() ? points_[p] : lines_.corners[p - points_.size()]; }

  /// The direction of the line in which two planes cross.
  Vec3d along(const Pair& pair) const {
    Vec3d direction = planes_[pair[0]].normal.cross(planes_[pair[1]].normal);
    direction.normalize(0.0);
    return direction;
  }

  /// Finds the points where an opening's edges go over from one plane to another.
  void find_ends() {
    std::map<Index, std::vector<std::pair<Index, Vec3d>>> edges_at;  // of each point: planes, and unit edges in these
    for (Index i = 0; i < planes_.size(); ++i)
      for (const auto& [a, b] : planes_[i].edges) {
        Vec3d edge = points_[b] - points_[a];
        edge.normalize(0.0);
        edges_at[a].emplace_back(i, edge);
        edges_at[b].emplace_back(i, edge);
      }
    for (const auto& [p, edges] : edges_at) {
      std::set<Index> its_planes;
      for (const auto& [plane, edge] : edges) its_planes.insert(plane);
      if (its_planes.size() == 1) continue;
      const Vec3d& x = points_[p];
      const Pair pair{*its_planes.begin(), *its_planes.rbegin()};
      if (its_planes.size() > 2 || planes_[pair[0]].normal.cross(planes_[pair[1]].normal).length() < kParallel)
        throw InvalidInput(
            fmt::format("fill: expected openings in planes that cross in pairs, got others at ({:.6g}, {:.6g}, {:.6g})",
                        x[0], x[1], x[2]));
      const Vec3d direction = along(pair);
      double forward = 0;
      for (const auto& [plane, edge] : edges) forward += direction.dot(planes_[plane].normal.cross(edge));
      ends_of_[pair].push_back({p, x.dot(direction), forward > 0});
    }
  }

  /// Pairs the ends on a line that face each other, and leads the others on to the next plane.
  void follow(const Pair& pair, std::vector<PlaneLineEnd>& ends) {
    std::ranges::sort(ends, {}, [](const PlaneLineEnd& end) { return std::pair(end.place, end.point); });
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const bool faces_next = ends[i].leads_forward && i + 1 < ends.size() && !ends[i + 1].leads_forward;
      if (faces_next) {
        lines_.segments.push_back({pair, {ends[i].point, ends[i + 1].point}});
        ++i;
      } else lead_on(pair, ends[i]);
    }
  }

  void lead_on(const Pair& pair, const PlaneLineEnd& end) {
    const Vec3d from = place(end.point), direction = along(pair) * (end.leads_forward ? 1.0 : -1.0);
    double least = std::numeric_limits<double>::infinity();
    Index third = kNone;
    for (Index k = 0; k < planes_.size(); ++k) {
      if (k == pair[0] || k == pair[1]) continue;
      const double slope = planes_[k].normal.dot(direction);
      if (std::abs(slope) < kParallel) continue;
      const double way = planes_[k].normal.dot(planes_[k].origin - from) / slope;
      if (way > 0 && way < least) least = way, third = k;
    }
    if (third == kNone) {
      lines_.is_closed = false;
      return;
    }
    std::array<Index, 3> key{pair[0], pair[1], third};
    std::ranges::sort(key);
    const auto [corner, is_new] = corners_.try_emplace(key, static_cast<Index>(points_.size() + lines_.corners.size()));
    if (is_new) lines_.corners.push_back(crossing(key, from));
    lines_.segments.push_back({pair, {end.point, corner->second}});
    joined_.insert({corner->second, pair});
  }

  /// Where three planes cross. A point that is to be on the first two may be a little off these.
  Vec3d crossing(const std::array<Index, 3>& three, const Vec3d& near) const {
    const Vec3d &a = planes_[three[0]].normal, &b = planes_[three[1]].normal, &c = planes_[three[2]].normal;
    const auto height = [&](Index plane) { return planes_[plane].normal.dot(planes_[plane].origin - near); };
    const Vec3d sum = b.cross(c) * height(three[0]) + c.cross(a) * height(three[1]) + a.cross(b) * height(three[2]);
    return near + sum / a.dot(b.cross(c));
  }

  /// Joins the corners that have no segment on a line yet, from one to the next.
  void join_corners() {
    std::map<Pair, std::vector<Index>> left;
    for (const auto& [key, corner] : corners_)
      for (const Pair& pair : {Pair{key[0], key[1]}, Pair{key[0], key[2]}, Pair{key[1], key[2]}})
        if (!joined_.contains({corner, pair})) left[pair].push_back(corner);
    for (auto& [pair, corners] : left) {
      const Vec3d direction = along(pair);
      std::ranges::sort(corners, {}, [&](Index corner) { return place(corner).dot(direction); });
      if (corners.size() % 2 == 1) lines_.is_closed = false;
      for (std::size_t i = 0; i + 1 < corners.size(); i += 2)
        lines_.segments.push_back({pair, {corners[i], corners[i + 1]}});
    }
  }

  std::span<const Vec3d> points_;
  std::span<const OpenPlane> planes_;
  std::map<Pair, std::vector<PlaneLineEnd>> ends_of_;  // of each line
  std::map<std::array<Index, 3>, Index> corners_;      // of three planes
  std::set<std::pair<Index, Pair>> joined_;            // corners that have a segment on a line
  PlaneLines lines_;
};

/// Places between two ends, as shares of the way, for edges that are so long there, grow by a factor, and are not
/// longer than `longest`.
std::vector<double> graded(double length, std::array<double, 2> sizes, double growth, double longest) {
  // Sums of so many parts are known to a thousandth of an edge.
  constexpr int kParts = 4096;
  const auto size_at = [&](double way) {
    return std::min({sizes[0] + (growth - 1) * way, sizes[1] + (growth - 1) * (length - way), longest});
  };
  std::vector<double> edges_before{0};
  for (int i = 0; i < kParts; ++i)
    edges_before.push_back(edges_before.back() + length / kParts / size_at(length * (i + 0.5) / kParts));
  const double count = std::max(1.0, std::ceil(edges_before.back() - 0.25));
  std::vector<double> shares;
  std::size_t part = 0;
  for (double k = 1; k < count; ++k) {
    const double wanted = edges_before.back() * k / count;
    while (edges_before[part + 1] < wanted) ++part;
    const double within = (wanted - edges_before[part]) / (edges_before[part + 1] - edges_before[part]);
    shares.push_back((static_cast<double>(part) + within) / kParts);
  }
  return shares;
}

/// Parts segments into edges, and adds these to the planes.
class PlaneLineCloser {
 public:
  PlaneLineCloser(double growth, double longest, std::vector<Vec3d>& points, std::vector<OpenPlane>& planes)
      : growth_(growth), longest_(longest), points_(points), planes_(planes) {
    for (const OpenPlane& plane : planes)
      for (const auto& [a, b] : plane.edges)
        for (const Index p : {a, b}) shorten(p, (points[a] - points[b]).length());
  }

  void make_alike(Index a, Index b) {
    shorten(a, size_.at(b));
    shorten(b, size_.at(a));
  }

  void add(const LineSegment& segment) {
    const auto [from, to] = segment.ends;
    const Vec3d a = points_[from], b = points_[to];
    const double length = (b - a).length();
    // A corner is as far from the edges as the segment that came to it is long.
    for (const auto& [near, far] : {Pair{from, to}, Pair{to, from}})
      if (!size_.contains(far)) shorten(far, std::min(longest_, size_.at(near) + (growth_ - 1) * length));
    std::vector<Index> line{from};
    for (const double share : graded(length, {size_.at(from), size_.at(to)}, growth_, longest_)) {
      line.push_back(static_cast<Index>(points_.size()));
      points_.push_back(a + (b - a) * share);
    }
    line.push_back(to);
    for (const auto& [own, other] : {segment.planes, Pair{segment.planes[1], segment.planes[0]}}) {
      // Seen from outside, what is to be filled is on the left, and behind the other plane.
      const bool is_backward = planes_[own].normal.cross(b - a).dot(planes_[other].normal) > 0;
      for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        if (is_backward) planes_[own].edges.push_back({line[i + 1], line[i]});
        else planes_[own].edges.push_back({line[i], line[i + 1]});
      }
    }
  }

 private:
  void shorten(Index p, double length) {
    const auto [size, is_new] = size_.try_emplace(p, length);
    if (!is_new) size->second = std::min(size->second, length);
  }

  double growth_, longest_;
  std::vector<Vec3d>& points_;
  std::vector<OpenPlane>& planes_;
  std::map<Index, double> size_;  // of edges at points
};

}  // namespace

PlaneLines find_plane_lines(std::span<const Vec3d> points, std::span<const OpenPlane> planes) {
  return PlaneLineFinder(points, planes).run();
}

void close_along(const PlaneLines& lines, double growth, double longest, std::vector<Vec3d>& points,
                 std::vector<OpenPlane>& planes, const std::map<std::uint32_t, std::uint32_t>& alike) {
  points.insert(points.end(), lines.corners.begin(), lines.corners.end());
  PlaneLineCloser closer(growth, longest, points, planes);
  for (const auto& [a, b] : alike) closer.make_alike(a, b);
  for (const LineSegment& segment : lines.segments) closer.add(segment);
}

}  // namespace vdb_offset
