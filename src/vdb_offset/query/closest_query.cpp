#include "vdb_offset/query/closest_query.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "vdb_offset/base/float_lanes.h"
#include "vdb_offset/base/morton.h"

namespace vdb_offset {

ClosestQuery::ClosestQuery(const Surface& surface) : surface_(surface) {
  const Vec3d lower = surface.facts.lower - surface.origin, upper = surface.facts.upper - surface.origin;
  double reach = 0;
  for (int k = 0; k < 3; ++k) reach = std::max({reach, std::abs(lower[k]), std::abs(upper[k])});
  // Boxes hold coordinates of size 1 or so: their squares neither overflow nor vanish in a float.
  scale_ = reach > 0 ? std::ldexp(1.0, -std::ilogb(reach)) : 1.0;
  slack_ = static_cast<float>(reach * scale_ * 4e-7);
  constexpr std::size_t kSize = kLeafSize;
  rectangles_.resize((surface_.triangles.size() + kSize - 1) / kSize);
  tree_.build(rectangles_.size(), [&](std::size_t leaf) {
    rectangles_[leaf] = rectangles_of(leaf);
    FloatBox box;
    for (std::size_t t = leaf * kSize; t < std::min((leaf + 1) * kSize, surface_.triangles.size()); ++t)
      for (const auto v : surface_.triangles[t])
        for (int k = 0; k < 3; ++k) {
          const auto x = static_cast<float>(surface_.vertices[v][k] * scale_);
          const auto axis = static_cast<std::size_t>(k);
          box.lower[axis] = std::min(box.lower[axis], x);
          box.upper[axis] = std::max(box.upper[axis], x);
        }
    return box;
  });
}

ClosestQuery::Rectangles ClosestQuery::rectangles_of(std::size_t leaf) const {
  constexpr float kNowhere = 1e18f;
  Rectangles some{};
  for (int i = 0; i < kLeafSize; ++i) {
    const std::size_t t = leaf * kLeafSize + static_cast<std::size_t>(i);
    if (t >= surface_.triangles.size()) {
      some.centre[0][i] = kNowhere;
      continue;
    }
    Vec3d corner[3];
    for (std::size_t k = 0; k < 3; ++k) corner[k] = surface_.vertices[surface_.triangles[t][k]] * scale_;
    std::size_t longest = 0;
    double length = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (const double other = (corner[(k + 1) % 3] - corner[k]).length(); other > length) {
        longest = k;
        length = other;
      }
    const Vec3d middle = (corner[longest] + corner[(longest + 1) % 3]) / 2.0,
                edge = length > 0 ? (corner[(longest + 1) % 3] - corner[longest]) / length : Vec3d(0.0),
                to_third = corner[(longest + 2) % 3] - middle, across = to_third - edge * edge.dot(to_third),
                centre = middle + across / 2.0;
    // Of a very thin triangle the normal may lean along its edge.
    Vec3d normal = surface_.triangle_normals[t];
    normal -= edge * edge.dot(normal);
    if (normal.lengthSqr() > 0) normal.normalize();
    for (int k = 0; k < 3; ++k) {
      some.centre[k][i] = static_cast<float>(centre[k]);
      some.normal[k][i] = static_cast<float>(normal[k]);
      some.edge[k][i] = static_cast<float>(edge[k]);
    }
    some.half_length[i] = static_cast<float>(length / 2 * (1 + 1e-6)) + slack_;
    some.half_width[i] = static_cast<float>(across.length() / 2 * (1 + 1e-6)) + slack_;
  }
  return some;
}

/// Which of eight boxes are no farther from a point than the root of `limit`, as bits; and how far they all are,
/// squared.
unsigned ClosestQuery::near_siblings(const BoxTree::Siblings& box, const float* local, float limit, float* squared) {
  unsigned near = 0;
  for (int i = 0; i < kWidth; i += kLanes) {
    Lanes sum{};
    for (int k = 0; k < 3; ++k) {
      const Lanes below = load_lanes(box.lower[k] + i) - local[k], above = local[k] - load_lanes(box.upper[k] + i);
      const Lanes outside = max_lanes(max_lanes(below, above), Lanes{});
      sum += outside * outside;
    }
    store_lanes(squared + i, sum);
    near |= lane_bits(sum <= limit + Lanes{}) << i;
  }
  return near;
}

namespace {

/// Some rectangles as a point sees them: how far it is from their centres, over their planes, along their edges and
/// across, how far beyond their ends and sides.
struct RectangleView {
  Lanes away[3], normal[3], edge[3], height, along, across, beyond_end, beyond_side;
  Lanes squared;  // distance, no larger than it is
};

/// Rectangles i .. i + kLanes - 1 of some. One millionth makes up for rounding. Of a triangle without a normal, all
/// that is not along its edge is across.
template <class Rectangles>
RectangleView look_at(const Rectangles& some, int i, const float* local) {
  RectangleView view{};
  Lanes squared{};
  for (int k = 0; k < 3; ++k) {
    view.away[k] = local[k] - load_lanes(some.centre[k] + i);
    view.normal[k] = load_lanes(some.normal[k] + i);
    view.edge[k] = load_lanes(some.edge[k] + i);
    squared += view.away[k] * view.away[k];
    view.height += view.away[k] * view.normal[k];
    view.along += view.away[k] * view.edge[k];
  }
  const Lanes height2 = view.height * view.height, along2 = view.along * view.along;
  view.across = sqrt_lanes(max_lanes(squared * 0.999999f - (height2 + along2), Lanes{}));
  view.beyond_end = max_lanes(max_lanes(view.along, -view.along) - load_lanes(some.half_length + i), Lanes{});
  view.beyond_side = max_lanes(view.across - load_lanes(some.half_width + i), Lanes{});
  view.squared = (height2 + (view.beyond_end * view.beyond_end + view.beyond_side * view.beyond_side)) * 0.999999f;
  return view;
}

}  // namespace

/// The triangles of a lowest box that may be nearer to a point, in the tree's units, than the root of `limit`, a bit
/// for each; and how near they may be, squared.
unsigned ClosestQuery::near_rectangles(const Rectangles& some, const float* local, float limit, float* least_squared) {
  unsigned near = 0;
  for (int i = 0; i < kLeafSize; i += kLanes) {
    const RectangleView view = look_at(some, i, local);
    store_lanes(least_squared + i, view.squared);
    near |= lane_bits(view.squared <= limit + Lanes{}) << i;
  }
  return near;
}

/// Planes that face a point, at a distance, with a box's triangles behind them.
struct ClosestQuery::Planes {
  float normal[3][kLeafSize], distance[kLeafSize];
};

/// As near_rectangles(), with the planes in front of the rectangles. Those in front of the rims of what is longer than
/// it is far away would not be exact enough: these have their own planes.
unsigned ClosestQuery::planes_before(const Rectangles& some, const float* local, float limit, Planes& planes) {
  constexpr float kTiny = 1e-30f;
  unsigned near = 0;
  for (int i = 0; i < kLeafSize; i += kLanes) {
    const RectangleView view = look_at(some, i, local);
    const unsigned found = lane_bits(view.squared <= limit + Lanes{});
    if (found == 0) continue;
    near |= found << i;
    const Lanes distance = sqrt_lanes(view.squared), one = Lanes{} + 1.0f;
    const IntLanes before_rim = load_lanes(some.half_length + i) + load_lanes(some.half_width + i) <= distance;
    const Lanes each = one / max_lanes(distance, Lanes{} + kTiny),
                side = view.beyond_side / max_lanes(view.across, Lanes{} + kTiny),
                end = (view.along < Lanes{} ? -view.beyond_end : view.beyond_end) - side * view.along,
                up = view.height < Lanes{} ? -one : one;
    const Lanes along_normal = before_rim ? view.height * (one - side) * each : up,
                along_edge = before_rim ? end * each : Lanes{}, along_way = before_rim ? side * each : Lanes{};
    for (int k = 0; k < 3; ++k)
      store_lanes(planes.normal[k] + i,
                  view.normal[k] * along_normal + view.edge[k] * along_edge + view.away[k] * along_way);
    store_lanes(planes.distance + i, before_rim ? distance : view.height * up);
  }
  return near;
}

/// One query's descent through the tree, nearest boxes first.
class ClosestQuery::Search {
 public:
  Search(const ClosestQuery& query, const Vec3d& x, std::uint32_t hint) : Search(query, x, hint, {}) {
    best_ = surface_.walk_to_closest(x, triangle_);
    tighten();
  }
  /// From a point of the surface that is known to be near, on a triangle.
  Search(const ClosestQuery& query, const Vec3d& x, std::uint32_t triangle, const TrianglePoint& known)
      : query_(query), surface_(query.surface_), x_(x), triangle_(triangle), best_(known) {
    for (int k = 0; k < 3; ++k) local_[k] = static_cast<float>(x[k] * query.scale_);
    rounding_ = query.slack_ + 4e-7f * std::max({std::abs(local_[0]), std::abs(local_[1]), std::abs(local_[2])});
    tighten();
  }

  /// Through these blocks of lowest boxes, which must hold all that may be nearer.
  Closest run_through(std::span<const std::uint32_t> blocks) {
    for (const auto block : blocks) open(0, block);
    return {std::sqrt(best_.squared_distance), triangle_, best_.feature, tied_, best_.point};
  }

  Closest run() {
    stack_[depth_++] = {0.0f, static_cast<std::uint32_t>(query_.tree_.levels().size() - 1), 0};
    while (depth_ > 0) {
      const Visit visit = stack_[--depth_];
      if (visit.squared_distance > limit_) continue;
      open(visit.level, visit.node);
    }
    return {std::sqrt(best_.squared_distance), triangle_, best_.feature, tied_, best_.point};
  }

 private:
  /// The siblings `node` of level `level`, and how far away the box is that holds them.
  struct Visit {
    float squared_distance;
    std::uint32_t level, node;
  };

  /// A box is left out only if it is farther than the best by more than float rounding can hide.
  void tighten() {
    const double distance = std::sqrt(best_.squared_distance), tie = query_.farthest_tie(distance);
    const float reach = (static_cast<float>(distance * query_.scale_) + rounding_) * 1.000001f;
    limit_ = reach * reach;
    tie_ = tie * tie;
  }

  /// Whether two points that are as near are not the same, as that of an edge or a corner is on each triangle there.
  static bool are_apart(const TrianglePoint& a, const TrianglePoint& b) {
    constexpr double kApart = 1e-12;
    return (a.point - b.point).lengthSqr() > kApart * a.squared_distance;
  }

  void compare(std::uint32_t other) {
    const TrianglePoint candidate = surface_.closest_on(other, x_);
    if (candidate.squared_distance >= best_.squared_distance) {
      tied_ = tied_ || (candidate.squared_distance <= tie_ && are_apart(candidate, best_));
      return;
    }
    const TrianglePoint before = std::exchange(best_, candidate);
    triangle_ = other;
    tighten();
    tied_ = before.squared_distance <= tie_ && (tied_ || are_apart(before, candidate));
  }

  /// Puts the siblings that are near enough on the stack, the nearest last, so that it is taken first; lowest boxes are
  /// looked into at once, as by then the bound is tight and their order matters little.
  void open(std::uint32_t level, std::uint32_t node) {
    float squared[kWidth];
    unsigned near = near_siblings(query_.tree_.levels()[level][node], local_, limit_, squared);
    if (level == 0) {
      for (; near != 0; near &= near - 1) {
        const int child = std::countr_zero(near);
        if (squared[child] <= limit_) look_at_triangles(node * kWidth + static_cast<std::uint32_t>(child));
      }
      return;
    }
    const std::size_t base = depth_;
    for (; near != 0; near &= near - 1) {
      const auto child = static_cast<std::uint32_t>(std::countr_zero(near));
      std::size_t at = depth_++;
      for (; at > base && stack_[at - 1].squared_distance < squared[child]; --at) stack_[at] = stack_[at - 1];
      stack_[at] = {squared[child], level - 1, node * kWidth + child};
    }
  }

  void look_at_triangles(std::uint32_t leaf) {
    float squared[kLeafSize];
    for (unsigned near = near_rectangles(query_.rectangles_[leaf], local_, limit_, squared); near != 0;
         near &= near - 1) {
      const int at = std::countr_zero(near);
      if (squared[at] > limit_) continue;
      compare(leaf * kLeafSize + static_cast<std::uint32_t>(at));
    }
  }

  const ClosestQuery& query_;
  const Surface& surface_;
  const Vec3d& x_;
  std::uint32_t triangle_;
  TrianglePoint best_;
  float local_[3];  // x in the tree's units
  float rounding_, limit_ = 0;
  double tie_ = 0;  // a point no farther than the root of this is as near as the closest
  bool tied_ = false;
  std::array<Visit, kWidth * 12> stack_;  // 8^12 leaves are far more than 2^31 triangles
  std::size_t depth_ = 0;
};

Closest ClosestQuery::operator()(const Vec3d& x, std::uint32_t hint) const { return Search(*this, x, hint).run(); }

/// The blocks of lowest boxes that some balls may meet, all together; returns how many, of which `blocks` has room for
/// the first.
std::size_t ClosestQuery::find_blocks(std::span<const Ball> balls, Blocks& blocks) const {
  std::size_t count = 0;
  const auto take = [&](std::size_t block) {
    if (count < kMostBlocks) blocks[count] = static_cast<std::uint32_t>(block);
    ++count;
  };
  if (tree_.levels().size() == 1) {
    take(0);
    return count;
  }
  FloatBox box;
  for (const auto& [centre, radius] : balls)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = centre[static_cast<int>(k)] * scale_, r = radius * scale_;
      const auto slack = slack_ + static_cast<float>((std::abs(x) + r) * 4e-7);
      box.lower[k] = std::min(box.lower[k], static_cast<float>(x - r) - slack);
      box.upper[k] = std::max(box.upper[k], static_cast<float>(x + r) + slack);
    }
  tree_.for_each_overlap(box, take, 1);
  return count;
}

/// Some points whose closest points are looked for together.
class ClosestQuery::Group {
 public:
  static constexpr std::size_t kMost = 32;

  Group(const ClosestQuery& query, std::span<const Vec3d> points, std::span<const std::uint32_t> hints,
        std::span<Closest> answers)
      : query_(query), points_(points), answers_(answers) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      triangle_[i] = hints[i];
      walked_[i] = query.surface_.walk_to_closest(points[i], triangle_[i]);
      balls_[i] = {points[i], std::sqrt(walked_[i].squared_distance)};
    }
  }

  /// Points first .. last - 1: by halves, if the balls that nothing nearer lies outside of do not lie close together.
  void answer(std::size_t first, std::size_t last) const {
    Blocks blocks;
    const std::size_t count = query_.find_blocks(std::span(balls_).subspan(first, last - first), blocks);
    if (count > kMostBlocks && last - first > 1) {
      answer(first, (first + last) / 2);
      return answer((first + last) / 2, last);
    }
    for (std::size_t i = first; i < last; ++i) {
      Search search(query_, points_[i], triangle_[i], walked_[i]);
      answers_[i] = count > kMostBlocks ? search.run() : search.run_through(std::span(blocks).first(count));
    }
  }

 private:
  const ClosestQuery& query_;
  std::span<const Vec3d> points_;
  std::span<Closest> answers_;
  std::array<std::uint32_t, kMost> triangle_;
  std::array<TrianglePoint, kMost> walked_;
  std::array<Ball, kMost> balls_;
};

/// Collects the triangles near one ball after the other.
class ClosestQuery::Collector {
 public:
  Collector(const ClosestQuery& query, std::span<const Ball> balls,
            const std::function<void(std::size_t, NearTriangles&)>& take)
      : query_(query), balls_(balls), take_(take) {}

  /// Balls first .. last - 1: by halves, if they do not lie close together.
  void collect(std::size_t first, std::size_t last) {
    Blocks blocks;
    const std::size_t count = query_.find_blocks(balls_.subspan(first, last - first), blocks);
    if (count > kMostBlocks && last - first > 1) {
      collect(first, (first + last) / 2);
      return collect((first + last) / 2, last);
    }
    for (std::size_t i = first; i < last; ++i) {
      begin(balls_[i]);
      if (count > kMostBlocks) descend();
      else
        for (std::size_t k = 0; k < count; ++k) open(0, blocks[k], [](std::size_t, std::uint32_t) {});
      take_(i, near_);
    }
  }

 private:
  void begin(const Ball& ball) {
    for (int k = 0; k < 3; ++k) local_[k] = static_cast<float>(ball.centre[k] * query_.scale_);
    rounding_ = query_.slack_ + 4e-7f * std::max({std::abs(local_[0]), std::abs(local_[1]), std::abs(local_[2])});
    const auto radius = static_cast<float>(ball.radius * query_.scale_), reach = (radius + rounding_) * 1.000001f;
    limit_ = reach * reach;
    // A ball of no size, or next to none, is no unit.
    unit_ = std::max({radius, rounding_, std::numeric_limits<float>::min()});
    near_.begin(ball.centre, static_cast<double>(unit_) / query_.scale_);
  }

  void descend() {
    std::array<std::pair<std::size_t, std::uint32_t>, kWidth * 12> stack;  // level and node
    std::size_t depth = 0;
    stack[depth++] = {query_.tree_.levels().size() - 1, 0};
    while (depth > 0) {
      const auto [level, node] = stack[--depth];
      open(level, node, [&](std::size_t below, std::uint32_t child) { stack[depth++] = {below, child}; });
    }
  }

  /// Looks into lowest boxes, and hands on what is above these.
  template <class HandOn>
  void open(std::size_t level, std::uint32_t node, HandOn&& hand_on) {
    float squared[kWidth];
    for (unsigned near = near_siblings(query_.tree_.levels()[level][node], local_, limit_, squared); near != 0;
         near &= near - 1) {
      const std::uint32_t child = node * kWidth + static_cast<std::uint32_t>(std::countr_zero(near));
      if (level == 0) look_at_triangles(child);
      else hand_on(level - 1, child);
    }
  }

  void look_at_triangles(std::size_t leaf) {
    Planes planes;
    for (unsigned near = planes_before(query_.rectangles_[leaf], local_, limit_, planes); near != 0; near &= near - 1) {
      const auto at = static_cast<std::size_t>(std::countr_zero(near));
      near_.add(static_cast<std::uint32_t>(leaf * kLeafSize + at),
                {planes.normal[0][at], planes.normal[1][at], planes.normal[2][at]},
                (planes.distance[at] * 0.999999f - rounding_) / unit_);
    }
  }

  const ClosestQuery& query_;
  std::span<const Ball> balls_;
  const std::function<void(std::size_t, NearTriangles&)>& take_;
  NearTriangles near_;
  float local_[3], rounding_ = 0, limit_ = 0, unit_ = 1;
};

void ClosestQuery::collect_together(std::span<const Ball> balls,
                                    const std::function<void(std::size_t, NearTriangles&)>& take) const {
  if (!balls.empty()) Collector(*this, balls, take).collect(0, balls.size());
}

/// Points on ways up from the surface, whose closest points are looked for together.
class ClosestQuery::Ways {
 public:
  Ways(const ClosestQuery& query, std::span<const Vec3d> points, std::span<const std::size_t> begin,
       std::span<const std::uint32_t> hints, std::span<Closest> answers)
      : query_(query), points_(points), answers_(answers), walked_(points.size()) {
    for (std::size_t way = 0; way + 1 < begin.size(); ++way) add_way(begin[way], begin[way + 1], hints);
  }

  void answer() const {
    query_.collect_together(balls_, [&](std::size_t i, const NearTriangles& near) {
      for (std::size_t p = runs_[i].first; p < runs_[i].second; ++p) choose(p, near);
    });
  }

 private:
  /// Nothing nearer to one of the points than what was found beside it lies outside of the ball around the farthest
  /// that holds all their balls. If that is hardly larger than the largest of them, it serves for all.
  void add_way(std::size_t first, std::size_t last, std::span<const std::uint32_t> hints) {
    constexpr double kHardlyLarger = 1.05;
    std::size_t farthest = first;
    for (std::size_t p = first; p < last; ++p) {
      std::uint32_t triangle = hints[p];
      const TrianglePoint walked = query_.surface_.walk_to_closest(points_[p], triangle);
      walked_[p] = {std::sqrt(walked.squared_distance), triangle, walked.feature, false, walked.point};
      if (walked_[p].distance > walked_[farthest].distance) farthest = p;
    }
    const Vec3d& centre = points_[farthest];
    double radius = 0;
    for (std::size_t p = first; p < last; ++p)
      radius = std::max(radius, (points_[p] - centre).length() + walked_[p].distance);
    if (radius <= kHardlyLarger * walked_[farthest].distance) {
      add_ball(first, last, {centre, radius});
      return;
    }
    for (std::size_t p = first; p < last; ++p) add_ball(p, p + 1, {points_[p], walked_[p].distance});
  }

  void add_ball(std::size_t first, std::size_t last, const Ball& ball) {
    balls_.push_back(ball);
    runs_.emplace_back(first, last);
  }

  void choose(std::size_t p, const NearTriangles& near) const {
    Closest best = walked_[p];
    near.visit_nearer(points_[p], best.distance, [&](std::size_t i) {
      const std::uint32_t triangle = near.triangle(i);
      if (triangle == best.triangle) return best.distance;
      const TrianglePoint candidate = query_.surface_.closest_on(triangle, points_[p]);
      if (candidate.squared_distance < best.distance * best.distance)
        best = {std::sqrt(candidate.squared_distance), triangle, candidate.feature, false, candidate.point};
      return best.distance;
    });
    answers_[p] = best;
  }

  const ClosestQuery& query_;
  std::span<const Vec3d> points_;
  std::span<Closest> answers_;
  std::vector<Closest> walked_;  // what is close to each point, and next to the hint
  std::vector<Ball> balls_;
  std::vector<std::pair<std::size_t, std::size_t>> runs_;  // of points, one for each ball
};

void ClosestQuery::answer_along_ways(std::span<const Vec3d> points, std::span<const std::size_t> begin,
                                     std::span<const std::uint32_t> hints, std::span<Closest> answers) const {
  Ways(*this, points, begin, hints, answers).answer();
}

void ClosestQuery::answer_together(std::span<const Vec3d> points, std::span<const std::uint32_t> hints,
                                   std::span<Closest> answers) const {
  for (std::size_t i = 0; i < points.size(); i += Group::kMost) {
    const std::size_t count = std::min(Group::kMost, points.size() - i);
    Group(*this, points.subspan(i, count), hints.subspan(i, count), answers.subspan(i, count)).answer(0, count);
  }
}

std::vector<Closest> closest_points(const ClosestQuery& query, std::span<const Vec3d> points) {
  const MeshFacts& facts = query.surface().facts;
  const MortonCurve curve(facts.lower - query.surface().origin, facts.upper - query.surface().origin);
  std::vector<std::pair<std::uint64_t, std::size_t>> order(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) { order[i] = {curve(points[i]), i}; });
  tbb::parallel_sort(order.begin(), order.end());
  std::vector<Closest> answers(points.size());
  // Runs of one length, whatever the number of threads: an answer may depend on its hint.
  constexpr std::size_t kRun = 256;
  tbb::parallel_for(std::size_t{0}, (points.size() + kRun - 1) / kRun, [&](std::size_t run) {
    std::uint32_t hint = 0;
    for (std::size_t i = run * kRun; i < std::min(points.size(), (run + 1) * kRun); ++i) {
      answers[order[i].second] = query(points[order[i].second], hint);
      hint = answers[order[i].second].triangle;
    }
  });
  return answers;
}

}  // namespace vdb_offset
