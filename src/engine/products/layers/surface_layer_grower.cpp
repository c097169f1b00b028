// SPDX-License-Identifier: Apache-2.0
// Puts layers over a surface for the grower (layer_grower.cpp), at exact distances. The layers of a vertex stand on its
// rail, and are found on the way down from height to height, in the first of three ways that is known to be right. The
// vertex's own fan of triangles is enough if the empty ball at the end of its path leaves nothing nearer beside it. The
// triangles in a ball around the rail come next, collected for many vertices at once; then an exact query for each
// step. Border vertices that slide go where the border leads them at each height. Each vertex is put by itself, so that
// the result does not depend on the number of threads. What is thinned, and by how much, is not decided here. After
// that, layers are rounded to what a file keeps and measured again, and what was held back is counted.
#include "products/layers/surface_layer_grower.h"

#include "ground/system/progress_count.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/layers/fan_distance.h"
#include "products/layers/layer_grower.h"
#include "products/layers/layer_wall.h"

namespace vdb_offset {
namespace {

// Vertices that a thread takes at a time: kSmallBlock if there are fewer than kFewVertices, so that all threads have
// work. For speed alone; not measured.
constexpr std::size_t kVertexBlock = 64, kSmallBlock = 16, kFewVertices = 8192;
// The number of triangles in the ball around a rail beyond which exact queries of a tree take over from going through
// all of them. For speed alone; not measured.
constexpr std::size_t kMostNear = 2000;
// The factor by which the ball around a rail, in which triangles are collected, is larger than that of a straight rail
// along which the distance grows evenly: room for bent rails. Layers for which it is too small are put by exact
// queries. For speed alone; not measured.
constexpr double kBallRoom = 1.02;
// The largest radius around a vertex, as a share of the distance at the end of its path, within which triangles outside
// of its fan are searched for; where nearer ones may lie farther out, they are collected around the rail instead. For
// speed alone; not measured.
constexpr double kFanShare = 0.5;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The constrained surface that layers are grown on.
class SurfaceWall final : public LayerWall {
 public:
  SurfaceWall(const ConstrainedSurface& constrained, const BorderSlides* slides, const GrowthColumns& columns,
              FaultFinder& faults, Paths& paths, RailStacks& stacks)
      : LayerWall(stacks),
        asked_(stacks.asked()),
        source_(asked_.source),
        heights_(asked_.heights),
        paths_(paths),
        constrained_(constrained),
        moving_part_(constrained.moving_part.surface()),
        slides_(slides),
        columns_(columns),
        faults_(faults) {}

 private:
  bool moves(std::uint32_t v) const override { return constrained_.vertex_on_part(v) && heights_.back()[v] != 0; }
  bool is_bound(std::uint32_t v) const override { return constrained_.is_bound(v) || columns_.is_opened(v); }

  bool sees_all_faces(std::uint32_t v, const Vec3d& displacement) const override {
    const double length = displacement.length();
    for (const auto t : constrained_.surface.triangles_around(v)) {
      const auto& [a, b, c] = constrained_.surface.triangles[t];
      if (!constrained_.triangle_on_part(t)) continue;
      const Vec3d n = (source_[b] - source_[a]).cross(source_[c] - source_[a]);
      if (n.lengthSqr() > 0 && !(asked_.side * n.dot(displacement) > kLeastSlope * n.length() * length)) return false;
    }
    return true;
  }

  Vec3d direction_of(std::uint32_t v) const override { return start_direction(moving_part_, on_part(v)); }

  std::size_t column_count() const override { return columns_.size(); }
  std::span<const std::uint32_t> base(std::size_t column) const override { return columns_.base(column); }
  std::span<const std::uint32_t> columns_around(std::uint32_t v) const override { return columns_.around(v); }
  bool is_valid(std::size_t column) const override {
    return columns_.is_valid(column, stacks_.positions(), asked_.side);
  }
  std::array<bool, 2> are_valid(std::size_t column, std::size_t other) const override {
    return columns_.are_valid(column, other, stacks_.positions(), asked_.side);
  }

  void find_faults(const Indices& vertices) override {
    faults_.move(
        vertices, [&](std::uint32_t v) { return stacks_.outermost(v); }, &paths_);
  }
  /// The faults at the ends of paths are known.
  void find_first_faults(const Indices& all) override {
    Indices back = all;
    std::erase_if(back, [&](std::uint32_t v) { return !moves(v) || stacks_.is_at_end(v); });
    find_faults(back);
  }
  Indices faulty_vertices() const override { return faults_.faulty_vertices(); }
  double distance_of(std::uint32_t v) const override { return faults_.distance_of(v); }

  void put(const Indices& vertices) override {
    const std::size_t size = vertices.size() < kFewVertices ? kSmallBlock : kVertexBlock;
    for_each_index((vertices.size() + size - 1) / size,
                   [&](std::size_t block) {
                     const std::size_t first = block * size;
                     put_block(std::span(vertices).subspan(first, std::min(size, vertices.size() - first)));
                   },
                   1);
  }

  /// Vertices whose layers are to be put below the tops of their rails, and the balls that hold all triangles which may
  /// be the closest to these layers.
  struct Puts {
    std::vector<std::uint32_t> vertices;
    std::vector<double> tops;
    std::vector<ClosestQuery::Ball> balls;
    void add(std::uint32_t v, double top, const ClosestQuery::Ball& ball) {
      vertices.push_back(v);
      tops.push_back(top);
      balls.push_back(ball);
    }
  };

  void put_block(std::span<const std::uint32_t> vertices) {
    VertexFan fan;
    Puts by_fan, by_ball;
    std::vector<double> distances;
    for (const auto v : vertices) {
      stacks_.flatten(v);
      const bool slides = slides_ && constrained_.is_bound(v) && !asked_.is_mitered(v);
      if (!(stacks_.share(v) > 0) || (slides && put_along_border(v))) continue;
      const double top = stacks_.top_of(v), radius = put_on_fan(v, top, fan, distances);
      if (radius < kInfinity) by_fan.add(v, top, {source_[v] - moving_part_.origin, radius});
      else by_ball.add(v, top, ball_of_rail(v, top));
    }
    constrained_.moving_part.collect_together(by_fan.balls, [&](std::size_t i, NearTriangles& near) {
      const std::uint32_t v = by_fan.vertices[i];
      const auto of_layers = std::span(distances).subspan(i * heights_.size(), heights_.size());
      if (!is_on_fan(v, of_layers, near)) by_ball.add(v, by_fan.tops[i], ball_of_rail(v, by_fan.tops[i]));
    });
    constrained_.moving_part.collect_together(by_ball.balls, [&](std::size_t i, NearTriangles& near) {
      const std::uint32_t v = by_ball.vertices[i];
      if (!put_by_near(v, by_ball.tops[i], by_ball.balls[i], fan, near)) put_by_query(v);
    });
  }

  /// The ball that holds all triangles which may be the closest to a layer of a vertex. Such a triangle is no farther
  /// from a layer than its height, and heights fall towards the vertex as the lengths of the rail do: all of them lie
  /// in the ball whose diameter goes from the vertex through the top of the rail, and beyond it by the outermost
  /// height.
  ClosestQuery::Ball ball_of_rail(std::uint32_t v, double top) const {
    const Vec3d to_top = stacks_.rail_of(v)(top), foot = source_[v] - moving_part_.origin;
    const double length = to_top.length(), radius = (length + std::min(length, stacks_.thickness(v))) / 2;
    if (!(length > 0)) return {foot, 0};
    return {foot + to_top * (radius / length), radius * kBallRoom};
  }

  /// Puts the layers of a border vertex where it slides to. Returns false if it does not reach one of its heights so.
  bool put_along_border(std::uint32_t v) {
    if (!slides_->lead(v)) return false;
    const auto stack = stacks_.of(v);
    for (std::size_t k = heights_.size(); k-- > 0;) {
      const double height = stacks_.share(v) * heights_[k][v], target = std::abs(height);
      const bool at_end = k + 1 == heights_.size() && stacks_.share(v) == stacks_.most(v);
      const Vec3d displacement =
          at_end ? paths_.displacement[v]
                 : round_displacement((*slides_)(v, height) - constrained_.surface.vertices[v], target);
      stack[k + 1] = source_[v] + displacement;
      const double achieved =
          constrained_.moving_part(stack[k + 1] - moving_part_.origin, constrained_.hint(v)).distance;
      stacks_.set_first_achieved(v, achieved);
      if (!(std::abs(achieved - target) <= kReachedTolerance * target)) return false;
    }
    return true;
  }

  std::uint32_t on_part(std::uint32_t v) const {
    return constrained_.part_vertex.empty() ? v : constrained_.part_vertex[v];
  }

  /// Puts layers where their distances from the vertex's fan are the heights. Returns the radius around the vertex
  /// within which all triangles lie that may be nearer to some of them: the ball around the end of its path is empty.
  /// The radius is infinite where it would be large, or where a closest triangle is clearly not in the fan.
  double put_on_fan(std::uint32_t v, double top, VertexFan& fan, std::vector<double>& distances) {
    fan.begin(moving_part_, on_part(v));
    const double free = paths_.achieved[v] - 2 * faults_.rounding(v);
    if (!fan.whole() || !(free > 0)) return kInfinity;
    const auto stack = stacks_.of(v);
    SpaceBesideBall beside(source_[v], source_[v] + paths_.displacement[v], free);
    const std::size_t before = distances.size();
    distances.resize(before + heights_.size());
    const bool there = stacks_.put_down(v, top, FanDistance(fan), [&](std::size_t k, double phi) {
      distances[before + k] = phi;
      if (!is_at_height(v, k, phi)) return false;
      // The distance at the end of a path is known to be exact.
      const bool at_end = k + 1 == heights_.size() && stacks_.is_at_end(v);
      return at_end || beside.add(stack[k + 1], phi, kFanShare * free);
    });
    if (there) return beside.radius();
    distances.resize(before);
    return kInfinity;
  }
  /// Whether no triangle near a vertex is nearer to its layers than its fan. `distances` are those of the layers.
  bool is_on_fan(std::uint32_t v, std::span<const double> distances, NearTriangles& near) const {
    near.remove_if([&](std::uint32_t t) {
      const auto& corners = moving_part_.triangles[t];
      return std::find(corners.begin(), corners.end(), on_part(v)) != corners.end();
    });
    bool holds = true;
    for (std::size_t k = distances.size(); near.size() > 0 && holds && k-- > 0;) {
      const Vec3d x = stacks_.of(v)[k + 1] - moving_part_.origin;
      const double nearer = distances[k] * (1 - kSameDistance);
      near.visit_nearer(x, nearer, [&](std::size_t i) {
        const Phi other = phi_of(moving_part_.closest_on(near.triangle(i), x), x);
        near.hold_back(i, x, other.away, other.value);
        holds = holds && !(other.value < nearer);
        return nearer;
      });
    }
    return holds;
  }

  /// Puts layers by the vertex's fan and the triangles in the ball around its rail, which are collected once for all
  /// layers. Returns false if they are many, or if a layer turns out to be outside of what the ball is large enough
  /// for, or not at its height.
  bool put_by_near(std::uint32_t v, double top, const ClosestQuery::Ball& ball, VertexFan& fan, NearTriangles& near) {
    const auto stack = stacks_.of(v);
    if (near.size() > kMostNear) return false;
    fan.begin(moving_part_, on_part(v));
    near.remove_if([&](std::uint32_t t) { return fan.has(t); });
    const Vec3d centre = ball.centre + moving_part_.origin;
    return stacks_.put_down(v, top, NearDistance(moving_part_, fan, near), [&](std::size_t k, double phi) {
      return is_at_height(v, k, phi) && (stack[k + 1] - centre).length() + phi <= ball.radius;
    });
  }

  bool is_at_height(std::uint32_t v, std::size_t k, double distance) const {
    const double height = stacks_.share(v) * asked_.distance(k, v);
    return std::abs(distance - height) <= kReachedTolerance * height;
  }

  /// Puts layers by exact queries: slower than any other way, and always right.
  void put_by_query(std::uint32_t v) {
    stacks_.put_down(v, 1, QueryDistance<ClosestQuery>(constrained_.moving_part, constrained_.hint(v)),
                     [](std::size_t, double) { return true; });
  }

  const AskedLayers& asked_;
  std::span<const Vec3d> source_;
  std::span<const Distances> heights_;
  Paths& paths_;
  const ConstrainedSurface& constrained_;
  const Surface& moving_part_;
  const BorderSlides* slides_;
  const GrowthColumns& columns_;
  FaultFinder& faults_;
};

}  // namespace

LayerStack stack_layers(const ConstrainedSurface& constrained, const BorderSlides* slides, const GrowthColumns& columns,
                        std::span<const Vec3d> source, std::span<const Distances> heights, FaultFinder& faults,
                        Paths& paths, std::span<const Vec3d> unspread, const ProgressCallback& callback) {
  // Half of the stage is shown as done after this many rounds. Not measured.
  constexpr std::size_t kExpectedRounds = 32;
  Progress progress(callback, Stage::Layers, kExpectedRounds, Units::Unknown);
  VDB_OFFSET_ASSERT(source.size() == constrained.surface.vertices.size());
  AskedLayers asked(source, constrained.moving_part.surface().origin, heights);
  asked.stretch_mitered(paths);
  RailStacks stacks(asked, paths);
  SurfaceWall wall(constrained, slides, columns, faults, paths, stacks);
  return grow_on(wall, paths, unspread, progress);
}

void round_layers(std::span<const Vec3d> source, const Rounding& precision,
                  const std::function<bool(std::uint32_t)>& is_written,
                  const std::function<std::optional<double>(std::uint32_t, const Vec3d&)>& distance_at,
                  LayerStack& stack, Paths& paths) {
  VDB_OFFSET_ASSERT(stack.stacks.vertices() == source.size() && paths.displacement.size() == source.size());
  if (precision.kind == Rounding::Kind::Double && precision.scale == Vec3d(1.0)) return;
  for_each_index(source.size(), [&](std::size_t i) {
    const auto v = static_cast<std::uint32_t>(i);
    // Flat stacks stay on the wall.
    if (!is_written(v) || stack.stacks.is_flat(v)) return;
    const auto positions = stack.stacks.of(v);
    for (Vec3d& position : positions.subspan(1)) position = precision(source[v], position);
    paths.displacement[v] = positions.back() - source[v];
    if (const auto first = distance_at(v, positions[1])) stack.first_achieved[v] = *first;
    if (const auto last = distance_at(v, positions.back())) paths.achieved[v] = *last;
  });
}

void count_held_back(const Paths& paths, const Distances& asked, std::span<const double> distances_before,
                     LimitStatistics& statistics) {
  VDB_OFFSET_ASSERT(distances_before.size() == paths.state.size());
  double lost = 0;
  std::size_t moving = 0;
  statistics.limited_vertices = 0;
  for (std::size_t v = 0; v < paths.state.size(); ++v) {
    const double target = std::abs(asked[v]);
    if (target == 0 || paths.state[v] == VertexState::Unused) continue;
    ++moving;
    statistics.limited_vertices += paths.state[v] == VertexState::Limited;
    lost += std::max(0.0, distances_before[v] - paths.achieved[v]) / target;
  }
  statistics.thickness_lost = lost / static_cast<double>(std::max<std::size_t>(1, moving));
}

}  // namespace vdb_offset
