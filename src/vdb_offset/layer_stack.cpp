#include "vdb_offset/layer_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vdb_offset/layer_rail.h"
#include "vdb_offset/parallel.h"

namespace vdb_offset {
namespace {

// Vertices that a thread takes at a time.
constexpr std::size_t kVertexBlock = 64;
// Where more triangles than this may be the closest ones, a tree finds them sooner.
constexpr std::size_t kMostNear = 200;
// How much longer than the way straight to the vertex the way along the rail may be.
constexpr double kReachRoom = 1.01;

class Stacker {
 public:
  Stacker(const Body& body, const BorderSlides* slides, const CellColumns& columns, std::span<const Vec3d> source,
          std::span<const Distances> heights, FaultFinder& faults, Paths& paths)
      : body_(body),
        front_(body.front.surface()),
        slides_(slides),
        columns_(columns),
        source_(source),
        heights_(heights),
        side_(heights.back().farthest() < 0 ? -1 : 1),
        faults_(faults),
        paths_(paths),
        most_(source.size(), 0.0),
        straight_(source.size(), 0),
        wrong_column_(columns.size(), 0) {
    stack_.stacks = Stacks(source.size(), heights.size());
    stack_.first_achieved.assign(source.size(), 0.0);
    for_each_index(source.size(), [&](std::size_t v) { most_[v] = share_at_end(static_cast<std::uint32_t>(v)); });
    stack_.share = most_;
  }

  LayerStack run(Progress& progress) {
    Indices all(source_.size());
    for (std::uint32_t v = 0; v < all.size(); ++v) all[v] = v;
    Indices uneven = all;
    if (heights_.back().uniform()) std::erase_if(uneven, [&](std::uint32_t v) { return stack_.share[v] == 1; });
    smooth(std::move(uneven));
    put(all);
    Indices back = std::move(all);
    std::erase_if(back, [&](std::uint32_t v) { return !moves(v) || (stack_.share[v] == most_[v] && most_[v] > 0); });
    faults_.look(back, [&](std::uint32_t v) { return outermost(v); });
    check_all_columns();
    stack_.statistics.wrong_columns = wrong_columns_.size();
    while (straighten()) progress.advance(0);
    while (thin()) progress.advance(1);
    let_all_out(progress);
    finish();
    return std::move(stack_);
  }

 private:
  /// Triangles near a rail: what they are no nearer than, and their planes, seen from the rail's end.
  struct Near {
    struct Plane {
      Vec3d normal;
      double height;
    };
    std::vector<ClosestQuery::Candidate> triangles;
    std::vector<Plane> planes;

    void find_planes(const Surface& front, const Vec3d& end) {
      planes.clear();
      for (const auto& near : triangles) {
        const Vec3d& n = front.triangle_normals[near.triangle];
        planes.push_back({n, n.dot(front.vertices[front.triangles[near.triangle][0]] - end)});
      }
    }
  };

  double asked(std::uint32_t v) const { return std::abs(heights_.back()[v]); }
  bool moves(std::uint32_t v) const { return body_.on_front(v) && heights_.back()[v] != 0; }
  const Vec3d& outermost(std::uint32_t v) const { return stack_.stacks.of(v).back(); }

  /// What a vertex could keep of its heights for where its path ended; nothing where no way up has all of the faces
  /// around it in view.
  double share_at_end(std::uint32_t v) {
    if (!moves(v) || !(paths_.achieved[v] > 0)) return 0;
    const Vec3d& whole = paths_.displacement[v];
    straight_[v] = body_.is_bound(v) || !sees_all_faces(v, start_of_rail(v));
    if (straight_[v] && !sees_all_faces(v, whole)) return 0;
    if (paths_.state[v] == VertexState::Reached) return 1;
    const double share = std::min(1.0, paths_.achieved[v] / asked(v));
    return share < kLeastShare ? 0 : share;
  }

  bool sees_all_faces(std::uint32_t v, const Vec3d& way) const {
    const double length = way.length();
    for (const auto t : body_.surface.triangles_around(v)) {
      const auto& [a, b, c] = body_.surface.triangles[t];
      if (!body_.is_front(t)) continue;
      const Vec3d n = (source_[b] - source_[a]).cross(source_[c] - source_[a]);
      if (n.lengthSqr() > 0 && !(side_ * n.dot(way) > kLeastSlope * n.length() * length)) return false;
    }
    return true;
  }

  /// As long as the whole way.
  Vec3d start_of_rail(std::uint32_t v) const {
    const std::uint32_t on_front = body_.front_vertex.empty() ? v : body_.front_vertex[v];
    return start_direction(front_, on_front) * (side_ * paths_.displacement[v].length());
  }

  Rail rail_of(std::uint32_t v) const {
    const Vec3d& whole = paths_.displacement[v];
    if (straight_[v]) return {whole, Vec3d(0.0)};
    return {whole, start_of_rail(v) - whole};
  }

  /// Lowers shares of these vertices and their neighbours until thickness is even enough: for each what the lowest
  /// allow. Returns all vertices that it lowered.
  Indices smooth(Indices changed) {
    Indices lowered;
    for (std::size_t i = 0; i < changed.size(); ++i) {
      const std::uint32_t v = changed[i];
      if (!moves(v)) continue;
      const double thickness = stack_.share[v] * asked(v);
      for (const auto column : columns_.around(v)) {
        const auto base = columns_.base(column);
        const std::size_t k = static_cast<std::size_t>(std::find(base.begin(), base.end(), v) - base.begin());
        for (const auto w : {base[(k + 1) % base.size()], base[(k + base.size() - 1) % base.size()]}) {
          const double most = thickness + kThicknessSlope * (source_[w] - source_[v]).length();
          if (!(stack_.share[w] * asked(w) > most * (1 + 1e-9))) continue;
          stack_.share[w] = most / asked(w) < kLeastShare ? 0 : most / asked(w);
          lowered.push_back(w);
          changed.push_back(w);
        }
      }
    }
    sort_unique(lowered);
    return lowered;
  }

  /// Puts these vertices' layers where their shares want them.
  void put(const Indices& vertices) {
    for_each_index((vertices.size() + kVertexBlock - 1) / kVertexBlock,
                   [&](std::size_t block) {
                     const std::size_t first = block * kVertexBlock;
                     Near near;
                     for (std::size_t i = first; i < std::min(first + kVertexBlock, vertices.size()); ++i)
                       put(vertices[i], near);
                   },
                   1);
  }

  void put(std::uint32_t v, Near& near) {
    std::fill(stack_.stacks.of(v).begin(), stack_.stacks.of(v).end(), source_[v]);
    if (!(stack_.share[v] > 0)) return;
    if (slides_ && body_.is_bound(v) && put_along_border(v)) return;
    if (!put_among_few(v, near)) put_with_care(v);
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

  /// As CareField, where the closest triangle is one of a few. Who goes a length from one place to another comes nearer
  /// to any of them by no more than that, so that few have to be looked at again: on the way down to the surface, what
  /// was farther than the closest mostly stays so. Nor is a triangle nearer than its plane.
  class FewField {
   public:
    FewField(const Surface& front, const Vec3d& end, Near& near) : front_(front), near_(near), end_(end), place_(end) {
      const auto less = [](const auto& a, const auto& b) { return a.least < b.least; };
      triangle_ = std::min_element(near.triangles.begin(), near.triangles.end(), less)->triangle;
    }

    Phi at(const Vec3d& x) const { return phi_of(front_.closest_on(triangle_, x), x); }
    Phi find(const Vec3d& x) {
      gone_ += (x - place_).length();
      place_ = x;
      const std::uint32_t believed = triangle_;
      Phi nearest = at(x);
      const Vec3d from_end = x - end_;
      for (std::size_t i = 0; i < near_.triangles.size(); ++i) {
        auto& [triangle, least] = near_.triangles[i];
        if (triangle == believed) {
          least = nearest.value + gone_;
          continue;
        }
        const auto& [normal, height] = near_.planes[i];
        const double enough = nearest.value * (1 - kRounding);
        if (least - gone_ >= enough || std::abs(normal.dot(from_end) - height) >= enough) continue;
        const Phi other = phi_of(front_.closest_on(triangle, x), x);
        least = other.value + gone_;
        if (!(other.value < nearest.value)) continue;
        nearest = other;
        triangle_ = triangle;
      }
      return nearest;
    }

   private:
    static constexpr double kRounding = 1e-9;
    const Surface& front_;
    Near& near_;  // what triangles are no nearer than here has the way gone since added
    Vec3d end_, place_;
    double gone_ = 0;
    std::uint32_t triangle_;
  };
  /// What may be the closest triangle to some point of the rail is no farther from its end than that point's distance
  /// and the way to it, so hardly farther than the vertex: few are, which are collected once for all layers. False if
  /// that was wrong of a layer, or does not lead to its height.
  bool put_among_few(std::uint32_t v, Near& near) {
    const auto stack = stack_.stacks.of(v);
    const Vec3d& whole = paths_.displacement[v];
    const Vec3d end = source_[v] - front_.origin + whole;
    const double reach = std::max(whole.length(), paths_.achieved[v]) * kReachRoom;
    body_.front.collect(end, reach, near.triangles);
    if (near.triangles.empty() || near.triangles.size() > kMostNear) return false;
    near.find_planes(front_, end);
    return descend(v, FewField(front_, end, near), [&](std::size_t k, double phi) {
      const double height = stack_.share[v] * std::abs(heights_[k][v]);
      return std::abs(phi - height) <= kReachedTolerance * height &&
             (stack[k + 1] - source_[v] - whole).length() + phi <= reach;
    });
  }

  void put_with_care(std::uint32_t v) {
    descend(v, CareField<ClosestQuery>(body_.front, body_.hint(v)), [](std::size_t, double) { return true; });
  }

  /// Goes down a vertex's rail from height to height, from the outermost. `placed` is told of each layer and its
  /// distance, and may end the descent: then this is false.
  template <class Field, class Placed>
  bool descend(std::uint32_t v, Field&& field, Placed&& placed) {
    const auto stack = stack_.stacks.of(v);
    const double share = stack_.share[v];
    const Rail rail = rail_of(v);
    const Vec3d origin = source_[v] - front_.origin;
    RailPlace above{1, field.find(origin + rail.whole)};
    for (std::size_t k = heights_.size(); k-- > 0;) {
      const double target = share * std::abs(heights_[k][v]);
      const bool at_end = k + 1 == heights_.size() && share == most_[v];
      if (!at_end) above = place_on(rail, origin, above, target, field);
      stack[k + 1] = source_[v] + (at_end ? rail.whole : round_way(rail(above.eta), target));
      if (!placed(k, above.phi.value)) return false;
      stack_.first_achieved[v] = above.phi.value;
    }
    return true;
  }

  void check_all_columns() {
    for_each_index(
        columns_.size(), [&](std::size_t c) { wrong_column_[c] = !columns_.is_valid(c, stack_.stacks, side_); }, 64);
    for (std::uint32_t c = 0; c < columns_.size(); ++c)
      if (wrong_column_[c]) wrong_columns_.push_back(c);
  }

  Indices columns_around(const Indices& vertices) const {
    Indices columns;
    for (const auto v : vertices) columns.insert(columns.end(), columns_.around(v).begin(), columns_.around(v).end());
    sort_unique(columns);
    return columns;
  }

  void check_columns(const Indices& moved) {
    const Indices columns = columns_around(moved);
    for_each_index(
        columns.size(),
        [&](std::size_t i) { wrong_column_[columns[i]] = !columns_.is_valid(columns[i], stack_.stacks, side_); }, 64);
    std::erase_if(wrong_columns_, [&](std::uint32_t c) { return !wrong_column_[c]; });
    for (const auto c : columns)
      if (wrong_column_[c]) wrong_columns_.push_back(c);
    sort_unique(wrong_columns_);
  }

  void move(const Indices& vertices) {
    put(vertices);
    faults_.look(vertices, [&](std::uint32_t v) { return outermost(v); });
    check_columns(vertices);
    ++stack_.statistics.rounds;
  }

  Indices corners_of_wrong_columns() const {
    Indices corners;
    for (const auto c : wrong_columns_) corners.insert(corners.end(), columns_.base(c).begin(), columns_.base(c).end());
    sort_unique(corners);
    return corners;
  }

  /// Stands the layers of wrong cells' vertices on straight lines, where these see all faces around. False if none is
  /// left that could be.
  bool straighten() {
    Indices corners = corners_of_wrong_columns();
    std::erase_if(corners, [&](std::uint32_t v) {
      return straight_[v] || stack_.share[v] == 0 || !sees_all_faces(v, paths_.displacement[v]);
    });
    if (corners.empty()) return false;
    for (const auto v : corners) straight_[v] = 1;
    stack_.statistics.straightened += corners.size();
    move(corners);
    return true;
  }

  Indices wrong_vertices() const {
    Indices wrong = faults_.wrong_vertices();
    const Indices corners = corners_of_wrong_columns();
    wrong.insert(wrong.end(), corners.begin(), corners.end());
    sort_unique(wrong);
    return wrong;
  }

  /// Thins the layers of the vertices that something is wrong with. False if none of them has any height left.
  bool thin() {
    Indices wrong = wrong_vertices();
    std::erase_if(wrong, [&](std::uint32_t v) { return stack_.share[v] == 0; });
    if (wrong.empty()) return false;
    for (const auto v : wrong) {
      stack_.share[v] *= kKeptHeight;
      if (stack_.share[v] < kLeastShare) stack_.share[v] = 0;
    }
    const Indices lowered = smooth(wrong);
    wrong.insert(wrong.end(), lowered.begin(), lowered.end());
    sort_unique(wrong);
    move(wrong);
    return true;
  }

  /// Lets all that is thinned out again, step by step.
  void let_all_out(Progress& progress) {
    Indices thinned;
    for (std::uint32_t v = 0; v < source_.size(); ++v)
      if (stack_.share[v] > 0 && stack_.share[v] < most_[v]) thinned.push_back(v);
    std::vector<double> before = stack_.share;
    for (int i = 0; i < kLetOuts && let_out(thinned, before); ++i) {
      for (const auto v : thinned) before[v] = stack_.share[v];
      progress.advance(1);
    }
  }

  /// Lets these vertices out by one step, as far as thickness stays even, and takes those back to their share `before`
  /// that something is then wrong with. False if none could be let out.
  bool let_out(const Indices& thinned, const std::vector<double>& before) {
    Indices out = thinned;
    std::erase_if(out, [&](std::uint32_t v) { return !(before[v] < most_[v]); });
    for (const auto v : out) stack_.share[v] = std::min(most_[v], before[v] / kKeptHeight);
    smooth_around(out);
    std::erase_if(out, [&](std::uint32_t v) { return stack_.share[v] == before[v]; });
    for (Indices moved = out; !moved.empty();) {
      move(moved);
      moved = wrong_vertices();
      std::erase_if(moved, [&](std::uint32_t v) { return stack_.share[v] == before[v]; });
      for (const auto v : moved) stack_.share[v] = before[v];
      const Indices lowered = smooth(moved);
      moved.insert(moved.end(), lowered.begin(), lowered.end());
      sort_unique(moved);
    }
    return std::any_of(out.begin(), out.end(), [&](std::uint32_t v) { return stack_.share[v] > before[v]; });
  }

  /// As smooth(), where vertices have been let out that their neighbours may hold back.
  void smooth_around(const Indices& vertices) {
    Indices around = vertices;
    for (const auto v : vertices)
      for (const auto column : columns_.around(v))
        around.insert(around.end(), columns_.base(column).begin(), columns_.base(column).end());
    sort_unique(around);
    smooth(std::move(around));
  }

  void finish() {
    for (std::uint32_t v = 0; v < source_.size(); ++v) {
      if (!moves(v)) continue;
      paths_.displacement[v] =
          stack_.share[v] == most_[v] && most_[v] > 0 ? paths_.displacement[v] : outermost(v) - source_[v];
      if (stack_.share[v] == 1) continue;
      ++stack_.statistics.thinned_vertices;
      stack_.statistics.flat_vertices += stack_.share[v] == 0;
      if (stack_.share[v] == most_[v] && most_[v] > 0) continue;  // as far as its path went
      paths_.achieved[v] = stack_.share[v] > 0 ? faults_.distance_of(v) : 0;
      paths_.state[v] = VertexState::Limited;
    }
  }

  const Body& body_;
  const Surface& front_;
  const BorderSlides* slides_;
  const CellColumns& columns_;
  std::span<const Vec3d> source_;
  std::span<const Distances> heights_;
  int side_;
  FaultFinder& faults_;
  Paths& paths_;
  std::vector<double> most_;            // the share that each vertex could keep for where its path ended
  std::vector<std::uint8_t> straight_;  // whether its layers stand on a straight line
  std::vector<std::uint8_t> wrong_column_;
  Indices wrong_columns_;
  LayerStack stack_;
};

}  // namespace

LayerStack stack_layers(const Body& body, const BorderSlides* slides, const CellColumns& columns,
                        std::span<const Vec3d> source, std::span<const Distances> heights, FaultFinder& faults,
                        Paths& paths, const ProgressCallback& callback) {
  constexpr std::size_t kExpectedRounds = 32;
  Progress progress(callback, Stage::Layers, kExpectedRounds);
  return Stacker(body, slides, columns, source, heights, faults, paths).run(progress);
}

}  // namespace vdb_offset
