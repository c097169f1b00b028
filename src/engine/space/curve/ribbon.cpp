// SPDX-License-Identifier: Apache-2.0
#include "space/curve/ribbon.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ground/numbers/box_tree.h"
#include "space/surface/surface.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// How far points may be off their plane, as a share of their extent. Rounding to seven digits puts each coordinate off
// by up to 5e-7 of itself. Not measured.
constexpr double kFlat = 1e-6;
// How far ends of curves may be apart and still count as one, as a share of the extent. Reasoned: what computing a
// point in two ways leaves in doubt is a hundred thousand times less, and a gap that is meant is more.
constexpr double kSameEnd = 1e-10;

/// The points that curves use, with the box around them.
struct UsedPoints {
  std::vector<std::uint32_t> points;
  Vec3d lower{std::numeric_limits<double>::infinity()}, upper{-std::numeric_limits<double>::infinity()};
};

UsedPoints used_points(CurvesView curves) {
  UsedPoints used;
  std::vector<std::uint8_t> seen(curves.positions.size(), 0);
  for (const auto p : curves.corners) {
    if (p >= curves.positions.size())
      throw InvalidInput(fmt::format("curves: expected points below {}, got {}", curves.positions.size(), p));
    if (!curves.positions[p].isFinite())
      throw InvalidInput(fmt::format("curves: expected finite coordinates, got others at point {} (from 0)", p));
    if (seen[p]) continue;
    seen[p] = 1;
    used.points.push_back(p);
    used.lower = openvdb::math::minComponent(used.lower, curves.positions[p]);
    used.upper = openvdb::math::maxComponent(used.upper, curves.positions[p]);
  }
  if (used.points.empty()) throw InvalidInput("curves: expected points on a curve, got none");
  return used;
}

template <class Measure>
std::uint32_t farthest(const UsedPoints& used, Measure&& measure) {
  return *std::max_element(used.points.begin(), used.points.end(),
                           [&](std::uint32_t a, std::uint32_t b) { return measure(a) < measure(b); });
}

/// A plane that is at right angles to no axis: u leads to the farthest point, v is at right angles to it in the plane
/// of the points. If all points are on a line, v is any direction across it, one with z = 0 if there is one.
PlaneFrame tilted_frame(CurvesView curves, const UsedPoints& used) {
  const auto& p = curves.positions;
  PlaneFrame frame;
  frame.origin = p[used.points.front()];
  const Vec3d along = p[farthest(used, [&](auto i) { return (p[i] - frame.origin).lengthSqr(); })] - frame.origin;
  frame.u = along.unit();
  const auto across = [&](std::uint32_t i) {
    const Vec3d from_origin = p[i] - frame.origin;
    return from_origin - frame.u * frame.u.dot(from_origin);
  };
  Vec3d side = across(farthest(used, [&](auto i) { return across(i).lengthSqr(); }));
  if (!(side.length() > kFlat * along.length())) {
    side = Vec3d(-frame.u[1], frame.u[0], 0);
    if (!(side.lengthSqr() > 1e-12)) side = Vec3d(1, 0, 0);
  }
  frame.v = side.unit();
  // The plane is seen from +z, or else from +y or +x, so that right and left do not depend on the order of the points.
  const Vec3d normal = frame.u.cross(frame.v);
  const double facing = std::abs(normal[2]) > 1e-9 ? normal[2] : std::abs(normal[1]) > 1e-9 ? normal[1] : normal[0];
  if (facing < 0) frame.v = -frame.v;
  return frame;
}

/// A piece of a chain: a segment, in the direction of its curve or turned round.
struct Step {
  std::uint32_t segment;
  bool turned;
};

class ChainWalker {
 public:
  ChainWalker(std::vector<Segment>& segments, std::size_t points)
      : segments_(segments), begin_(points + 1, 0), walked_(segments.size(), 0) {
    for (const auto& [a, b] : segments) ++begin_[a + 1], ++begin_[b + 1];
    for (std::size_t p = 0; p < points; ++p) begin_[p + 1] += begin_[p];
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    around_.resize(2 * segments.size());
    for (std::uint32_t s = 0; s < segments.size(); ++s)
      for (const auto p : segments[s]) around_[next[p]++] = s;
  }

  std::uint32_t degree(std::uint32_t point) const { return begin_[point + 1] - begin_[point]; }

  /// Calls visit(steps, closed) for every chain: those with ends first, then those without.
  template <class Visit>
  void run(Visit&& visit) {
    for (const bool loops : {false, true})
      for (std::uint32_t s = 0; s < segments_.size(); ++s)
        for (const bool turned : {false, true}) {
          const auto from = segments_[s][turned];
          if (walked_[s] || (!loops && degree(from) == 2)) continue;
          const std::vector<Step> steps = walk({s, turned});
          visit(steps, from == end_of(steps.back()));
        }
  }

  std::uint32_t end_of(const Step& step) const { return segments_[step.segment][!step.turned]; }

 private:
  std::vector<Step> walk(Step step) {
    std::vector<Step> steps;
    for (;;) {
      walked_[step.segment] = 1;
      steps.push_back(step);
      const auto at = end_of(step);
      if (degree(at) != 2) return steps;
      const auto next = around_[begin_[at]] == step.segment ? around_[begin_[at] + 1] : around_[begin_[at]];
      if (walked_[next]) return steps;
      step = {next, segments_[next][0] != at};
    }
  }

  std::vector<Segment>& segments_;
  std::vector<std::uint32_t> begin_, around_;  // the segments around each point
  std::vector<std::uint8_t> walked_;
};

/// A closed chain's points in order, and the box around them.
struct Loop {
  std::vector<Step> steps;
  std::vector<Vec2d> points;
  Vec2d lower, upper;
  double area = 0;  // above 0 if it runs counterclockwise

  bool may_hold(const Vec2d& x) const {
    return x[0] >= lower[0] && x[0] <= upper[0] && x[1] >= lower[1] && x[1] <= upper[1];
  }
  /// Whether a point is inside, by the parity of the number of segments that a ray to the right crosses.
  bool holds(const Vec2d& x) const {
    if (!may_hold(x)) return false;
    bool inside = false;
    for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++) {
      const Vec2d &a = points[i], &b = points[j];
      if ((a[1] > x[1]) == (b[1] > x[1])) continue;
      if (x[0] < a[0] + (b[0] - a[0]) * ((x[1] - a[1]) / (b[1] - a[1]))) inside = !inside;
    }
    return inside;
  }
  /// The middle of the longest segment. A corner would not do: other loops may touch this one there.
  Vec2d sample() const {
    std::size_t best = 0;
    double longest = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double length = (points[(i + 1) % points.size()] - points[i]).lengthSqr();
      if (length > longest) longest = length, best = i;
    }
    return (points[best] + points[(best + 1) % points.size()]) * 0.5;
  }
};

Loop make_loop(const std::vector<Step>& steps, const std::vector<Segment>& segments, std::span<const Vec2d> points) {
  Loop loop{steps, {}, Vec2d(std::numeric_limits<double>::infinity()), Vec2d(-std::numeric_limits<double>::infinity())};
  for (const auto& [s, turned] : steps) {
    const Vec2d p = points[segments[s][turned]];
    loop.points.push_back(p);
    for (int k = 0; k < 2; ++k)
      loop.lower[k] = std::min(loop.lower[k], p[k]), loop.upper[k] = std::max(loop.upper[k], p[k]);
  }
  const Vec2d origin = loop.points.front();
  for (std::size_t i = 0; i < loop.points.size(); ++i) {
    const Vec2d a = loop.points[i] - origin, b = loop.points[(i + 1) % loop.points.size()] - origin;
    loop.area += (a[0] * b[1] - a[1] * b[0]) / 2;
  }
  return loop;
}

}  // namespace

PlaneFrame plane_of(CurvesView curves) {
  const UsedPoints used = used_points(curves);
  PlaneFrame frame;
  for (const int axis : {2, 1, 0}) {
    if (used.lower[axis] != used.upper[axis]) continue;
    frame.origin[axis] = used.lower[axis];
    // The axes are x and y, seen from +z; z and x, from +y; or y and z, from +x.
    frame.u = Vec3d(0.0), frame.v = Vec3d(0.0);
    frame.u[(axis + 1) % 3] = frame.v[(axis + 2) % 3] = 1;
    return frame;
  }
  frame = tilted_frame(curves, used);
  const Vec3d normal = frame.u.cross(frame.v);
  const auto off = [&](std::uint32_t i) { return std::abs(normal.dot(curves.positions[i] - frame.origin)); };
  const std::uint32_t worst = farthest(used, off);
  if (off(worst) > kFlat * (used.upper - used.lower).length())
    throw InvalidInput(fmt::format("curves: expected points in one plane, got point {} (from 0) {:.3g} off the others'",
                                   worst, off(worst)));
  return frame;
}

namespace {

/// Rounded outwards.
FloatBox box_around(const Vec2d& lower, const Vec2d& upper) {
  FloatBox box{{0, 0, 0}, {0, 0, 0}};
  for (std::size_t k = 0; k < 2; ++k) {
    box.lower[k] = std::nextafter(static_cast<float>(lower[static_cast<int>(k)]), -FloatBox::kInfinity);
    box.upper[k] = std::nextafter(static_cast<float>(upper[static_cast<int>(k)]), FloatBox::kInfinity);
  }
  return box;
}

/// The segments of curves between points that count as one.
std::vector<Segment> segments_of(CurvesView curves, std::span<const Vec2d> points,
                                 std::span<const std::uint32_t> welded_to) {
  std::vector<Segment> segments;
  for (std::size_t c = 0; c < curves.face_count(); ++c) {
    const auto curve = curves.face(c);
    for (std::size_t i = 1; i < curve.size(); ++i) {
      const Segment segment{welded_to[curve[i - 1]], welded_to[curve[i]]};
      if (points[segment[0]] != points[segment[1]]) segments.push_back(segment);
    }
  }
  return segments;
}

/// The points where one segment ends and no other begins, from left to right; none where a segment is not much longer
/// than `apart`.
std::vector<std::uint32_t> ends_of(std::span<const Segment> segments, std::span<const Vec2d> points, double apart) {
  constexpr double kMuchLonger = 1000;
  std::vector<std::uint32_t> degree(points.size(), 0), ends;
  for (const Segment& segment : segments)
    for (const auto p : segment) ++degree[p];
  for (const Segment& segment : segments) {
    if ((points[segment[1]] - points[segment[0]]).length() <= kMuchLonger * apart) continue;
    for (const auto p : segment)
      if (degree[p] == 1) ends.push_back(p);
  }
  std::sort(ends.begin(), ends.end(), [&](std::uint32_t a, std::uint32_t b) {
    return points[a][0] != points[b][0] ? points[a][0] < points[b][0] : a < b;
  });
  return ends;
}

/// Lets two ends that are apart by rounding alone count as one, as those of a curve that sines and cosines close. False
/// if there are none.
bool weld_near_ends(std::span<const Segment> segments, std::span<const Vec2d> points,
                    std::vector<std::uint32_t>& welded_to) {
  double extent = 0;
  for (const Segment& segment : segments)
    extent = std::max(extent, (points[segment[0]] - points[segments.front()[0]]).length());
  const double apart = kSameEnd * extent;
  const std::vector<std::uint32_t> ends = ends_of(segments, points, apart);
  std::vector<std::uint32_t> one(points.size());
  std::iota(one.begin(), one.end(), 0);
  bool any = false;
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t j = i + 1; j < ends.size() && points[ends[j]][0] - points[ends[i]][0] <= apart; ++j) {
      const auto [first, second] = std::minmax(ends[i], ends[j]);
      if (one[first] != first || one[second] != second || (points[first] - points[second]).length() > apart) continue;
      one[second] = first;
      any = true;
    }
  for (std::uint32_t& p : welded_to)
    if (p != kNone) p = one[p];
  return any;
}

}  // namespace

CurveChains join_curves(CurvesView curves, std::span<const Vec2d> points) {
  CurveChains joined;
  joined.welded_to = weld_by_position(curves, {});
  joined.segments = segments_of(curves, points, joined.welded_to);
  if (weld_near_ends(joined.segments, points, joined.welded_to))
    joined.segments = segments_of(curves, points, joined.welded_to);
  ChainWalker walker(joined.segments, points.size());
  for (std::uint32_t p = 0; p < points.size(); ++p) {
    joined.ends += walker.degree(p) == 1;
    joined.branchings += walker.degree(p) > 2;
  }
  std::vector<Loop> loops;
  std::vector<std::vector<Step>> open;
  walker.run([&](const std::vector<Step>& steps, bool closed) {
    if (closed) loops.push_back(make_loop(steps, joined.segments, points));
    else open.push_back(steps);
  });
  joined.chains = loops.size() + open.size();
  joined.closed = loops.size();
  std::vector<Segment> in_order;
  in_order.reserve(joined.segments.size());
  const auto take = [&](std::vector<Step> steps, bool backwards) {
    if (backwards) std::reverse(steps.begin(), steps.end());
    for (const auto& [s, turned] : steps) {
      const auto [a, b] = joined.segments[s];
      in_order.push_back(turned != backwards ? Segment{b, a} : Segment{a, b});
    }
  };
  for (const auto& steps : open) {
    const auto turned = std::count_if(steps.begin(), steps.end(), [](const Step& step) { return step.turned; });
    take(steps, 2 * static_cast<std::size_t>(turned) > steps.size());
  }
  BoxTree boxes;
  if (!loops.empty())
    boxes.build(loops.size(), [&](std::size_t i) { return box_around(loops[i].lower, loops[i].upper); });
  for (const Loop& loop : loops) {
    const Vec2d sample = loop.sample();
    std::size_t around = 0;
    boxes.for_each_overlap(box_around(sample, sample),
                           [&](std::size_t i) { around += &loops[i] != &loop && loops[i].holds(sample); });
    take(loop.steps, (loop.area < 0) != (around % 2 == 1));
  }
  joined.segments = std::move(in_order);
  return joined;
}

std::vector<Vec3d> curve_normals(CurvesView curves) {
  const PlaneFrame frame = plane_of(curves);
  std::vector<Vec2d> points;
  for (const Vec3d& p : curves.positions) points.push_back(frame.to_plane(p));
  const CurveChains chains = join_curves(curves, points);
  std::vector<Vec2d> sum(points.size(), Vec2d(0.0));
  for (const auto& [a, b] : chains.segments) {
    const Vec2d along = (points[b] - points[a]).unit();
    for (const auto p : {a, b}) sum[p] += Vec2d(along[1], -along[0]);
  }
  std::vector<Vec3d> normals(points.size(), Vec3d(0.0));
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (chains.welded_to[p] == kNone) continue;
    const Vec2d& n = sum[chains.welded_to[p]];
    if (n.lengthSqr() > 1e-24) normals[p] = frame.to_space(n.unit());
  }
  return normals;
}

std::vector<double> curve_edges(CurvesView curves) {
  const PlaneFrame frame = plane_of(curves);
  std::vector<Vec2d> points;
  for (const Vec3d& p : curves.positions) points.push_back(frame.to_plane(p));
  const CurveChains chains = join_curves(curves, points);
  std::vector<double> sum(points.size(), 0.0), mean(points.size(), 0.0);
  std::vector<std::uint32_t> count(points.size(), 0);
  for (const auto& [a, b] : chains.segments)
    for (const auto p : {a, b}) {
      sum[p] += (points[b] - points[a]).length();
      ++count[p];
    }
  for (std::size_t p = 0; p < points.size(); ++p)
    if (const std::uint32_t own = chains.welded_to[p]; own != kNone && count[own] > 0) mean[p] = sum[own] / count[own];
  return mean;
}

Polygons make_ribbon(std::span<const Segment> segments, std::span<const Vec2d> points, double height) {
  Polygons ribbon;
  ribbon.positions.reserve(2 * points.size());
  for (const Vec2d& p : points)
    for (const double z : {0.0, height}) ribbon.positions.emplace_back(p[0], p[1], z);
  for (const auto& [a, b] : segments) ribbon.add_face({2 * a, 2 * b, 2 * b + 1, 2 * a + 1});
  return ribbon;
}

}  // namespace vdb_offset
