#include "vdb_offset/layer_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vdb_offset/parallel.h"
#include "vdb_offset/stacker.h"

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
    body_.front.collect_together(balls, [&](std::size_t i, NearTriangles& near) {
      if (!put_among_few(open[i], tops[i], balls[i], near)) put_with_care(open[i]);
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

  /// As CareField, where the closest triangle is one of a few.
  class FewField {
   public:
    FewField(const Surface& front, NearTriangles& near) : front_(front), near_(near), believed_(near.foremost()) {}

    Phi at(const Vec3d& x) const { return phi_of(front_.closest_on(near_.triangle(believed_), x), x); }
    Phi find(const Vec3d& x) {
      const std::size_t believed = believed_;
      Phi nearest = at(x);
      const Phi of_believed = nearest;
      near_.visit_nearer(x, nearest.value, [&](std::size_t i) {
        if (i == believed) return nearest.value;
        const Phi other = phi_of(front_.closest_on(near_.triangle(i), x), x);
        near_.hold_back(i, x, other.away, other.value);
        if (!(other.value < nearest.value)) return nearest.value;
        nearest = other;
        believed_ = i;
        return nearest.value;
      });
      near_.hold_back(believed, x, of_believed.away, of_believed.value);
      return nearest;
    }

   private:
    const Surface& front_;
    NearTriangles& near_;
    std::size_t believed_;
  };
  /// What may be the closest triangle to some point of the rail below its top is no farther from that than the point's
  /// distance and the way to it, so hardly farther than the vertex: few are, which are collected once for all layers.
  /// False if that was wrong of a layer, or does not lead to its height.
  bool put_among_few(std::uint32_t v, double top, const ClosestQuery::Ball& ball, NearTriangles& near) {
    const auto stack = stack_.stacks.of(v);
    if (near.size() == 0 || near.size() > kMostNear) return false;
    const Vec3d centre = ball.centre + front_.origin;
    return put_down(v, top, FewField(front_, near), [&](std::size_t k, double phi) {
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
