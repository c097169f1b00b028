#include "vdb_offset/layer_stack.h"

#include <algorithm>
#include <cmath>

#include "vdb_offset/parallel.h"
#include "vdb_offset/stacker.h"
#include "vdb_offset/vertex_fan.h"

namespace vdb_offset {
namespace {

// Vertices that a thread takes at a time.
constexpr std::size_t kVertexBlock = 64;
// Where more triangles than this may be the closest ones, a tree finds them sooner.
constexpr std::size_t kMostNear = 2000;
// How much longer than the way straight to the vertex the way along the rail may be.
constexpr double kReachRoom = 1.01;

class SurfaceStacker final : public Stacker {
 public:
  SurfaceStacker(const Body& body, const BorderSlides* slides, const CellColumns& columns,
                 std::span<const Vec3d> source, std::span<const Distances> heights, FaultFinder& faults, Paths& paths)
      : Stacker(source, body.front.surface().origin, heights, paths),
        body_(body),
        front_(body.front.surface()),
        slides_(slides),
        columns_(columns),
        faults_(faults) {}

 private:
  bool moves(std::uint32_t v) const override { return body_.on_front(v) && heights_.back()[v] != 0; }
  bool is_bound(std::uint32_t v) const override { return body_.is_bound(v); }

  bool sees_all_faces(std::uint32_t v, const Vec3d& way) const override {
    const double length = way.length();
    for (const auto t : body_.surface.triangles_around(v)) {
      const auto& [a, b, c] = body_.surface.triangles[t];
      if (!body_.is_front(t)) continue;
      const Vec3d n = (source_[b] - source_[a]).cross(source_[c] - source_[a]);
      if (n.lengthSqr() > 0 && !(side_ * n.dot(way) > kLeastSlope * n.length() * length)) return false;
    }
    return true;
  }

  Vec3d direction_of(std::uint32_t v) const override {
    return start_direction(front_, body_.front_vertex.empty() ? v : body_.front_vertex[v]);
  }

  std::size_t column_count() const override { return columns_.size(); }
  std::span<const std::uint32_t> base(std::size_t column) const override { return columns_.base(column); }
  std::span<const std::uint32_t> columns_around(std::uint32_t v) const override { return columns_.around(v); }
  bool is_valid(std::size_t column) const override { return columns_.is_valid(column, stack_.stacks, side_); }
  std::array<bool, 2> are_valid(std::size_t column, std::size_t other) const override {
    return columns_.are_valid(column, other, stack_.stacks, side_);
  }

  void look(const Indices& vertices) override {
    faults_.look(vertices, [&](std::uint32_t v) { return outermost(v); });
  }
  /// What is wrong where paths end is known.
  void look_first(const Indices& all) override {
    Indices back = all;
    std::erase_if(back, [&](std::uint32_t v) { return !moves(v) || is_at_end(v); });
    look(back);
  }
  Indices faulty_vertices() const override { return faults_.wrong_vertices(); }
  double distance_of(std::uint32_t v) const override { return faults_.distance_of(v); }

  void put(const Indices& vertices) override {
    for_each_index((vertices.size() + kVertexBlock - 1) / kVertexBlock,
                   [&](std::size_t block) {
                     const std::size_t first = block * kVertexBlock;
                     put_block(std::span(vertices).subspan(first, std::min(kVertexBlock, vertices.size() - first)));
                   },
                   1);
  }

  void put_block(std::span<const std::uint32_t> vertices) {
    std::vector<std::uint32_t> open;
    std::vector<double> tops;
    std::vector<ClosestQuery::Ball> balls;
    for (const auto v : vertices) {
      std::fill(stack_.stacks.of(v).begin(), stack_.stacks.of(v).end(), source_[v]);
      if (!(stack_.share[v] > 0) || (slides_ && body_.is_bound(v) && put_along_border(v))) continue;
      const double top = top_of(v);
      const Vec3d way = rail_of(v)(top);
      open.push_back(v);
      tops.push_back(top);
      balls.push_back({source_[v] - front_.origin + way, way.length() * kReachRoom});
    }
    VertexFan fan;
    body_.front.collect_together(balls, [&](std::size_t i, NearTriangles& near) {
      if (!put_among_few(open[i], tops[i], balls[i], fan, near)) put_with_care(open[i]);
    });
  }

  /// False if a vertex gets to one of its heights not by sliding there.
  bool put_along_border(std::uint32_t v) {
    const auto stack = stack_.stacks.of(v);
    for (std::size_t k = heights_.size(); k-- > 0;) {
      const double height = stack_.share[v] * heights_[k][v], target = std::abs(height);
      const bool at_end = k + 1 == heights_.size() && stack_.share[v] == most_[v];
      const Vec3d way =
          at_end ? paths_.displacement[v] : round_way((*slides_)(v, height) - body_.surface.vertices[v], target);
      stack[k + 1] = source_[v] + way;
      stack_.first_achieved[v] = body_.front(stack[k + 1] - front_.origin, body_.hint(v)).distance;
      if (!(std::abs(stack_.first_achieved[v] - target) <= kReachedTolerance * target)) return false;
    }
    return true;
  }

  /// As CareField, where the closest triangle is one of those around the vertex, or of a few others.
  class FewField {
   public:
    FewField(const Surface& front, VertexFan& fan, NearTriangles& others) : front_(front), fan_(fan), others_(others) {
      if (others.size() > 0) believed_ = static_cast<std::uint32_t>(others.foremost());
    }

    Phi at(const Vec3d& x) const { return believed_ == kNone ? phi_of(fan_.away_from(x)) : of_other(believed_, x); }
    Phi find(const Vec3d& x) {
      Phi nearest = phi_of(fan_.find_away_from(x));
      const std::uint32_t believed = believed_;
      believed_ = kNone;
      const auto look = [&](std::uint32_t i) {
        const Phi other = of_other(i, x);
        others_.hold_back(i, x, other.away, other.value);
        if (!(other.value < nearest.value)) return;
        nearest = other;
        believed_ = i;
      };
      if (believed != kNone) look(believed);
      others_.visit_nearer(x, nearest.value, [&](std::size_t i) {
        if (i != believed) look(static_cast<std::uint32_t>(i));
        return nearest.value;
      });
      return nearest;
    }

   private:
    static Phi phi_of(const Vec3d& away) { return {away.length(), away}; }
    Phi of_other(std::uint32_t i, const Vec3d& x) const {
      return vdb_offset::phi_of(front_.closest_on(others_.triangle(i), x), x);
    }

    const Surface& front_;
    VertexFan& fan_;
    NearTriangles& others_;
    std::uint32_t believed_ = kNone;  // of the others
  };
  /// What may be the closest triangle to some point of the rail below its top is no farther from that than the point's
  /// distance and the way to it, so hardly farther than the vertex: few are, which are collected once for all layers.
  /// False if that was wrong of a layer, or does not lead to its height.
  bool put_among_few(std::uint32_t v, double top, const ClosestQuery::Ball& ball, VertexFan& fan, NearTriangles& near) {
    const auto stack = stack_.stacks.of(v);
    if (near.size() > kMostNear) return false;
    fan.begin(front_, body_.front_vertex.empty() ? v : body_.front_vertex[v]);
    near.remove_if([&](std::uint32_t t) { return fan.has(t); });
    const Vec3d centre = ball.centre + front_.origin;
    return put_down(v, top, FewField(front_, fan, near), [&](std::size_t k, double phi) {
      const double height = stack_.share[v] * std::abs(heights_[k][v]);
      return std::abs(phi - height) <= kReachedTolerance * height &&
             (stack[k + 1] - centre).length() + phi <= ball.radius;
    });
  }

  void put_with_care(std::uint32_t v) {
    put_down(v, 1, CareField<ClosestQuery>(body_.front, body_.hint(v)), [](std::size_t, double) { return true; });
  }

  const Body& body_;
  const Surface& front_;
  const BorderSlides* slides_;
  const CellColumns& columns_;
  FaultFinder& faults_;
};

}  // namespace

LayerStack stack_layers(const Body& body, const BorderSlides* slides, const CellColumns& columns,
                        std::span<const Vec3d> source, std::span<const Distances> heights, FaultFinder& faults,
                        Paths& paths, const ProgressCallback& callback) {
  constexpr std::size_t kExpectedRounds = 32;
  Progress progress(callback, Stage::Layers, kExpectedRounds);
  return SurfaceStacker(body, slides, columns, source, heights, faults, paths).run(progress);
}

}  // namespace vdb_offset
