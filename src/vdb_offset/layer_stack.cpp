#include "vdb_offset/layer_stack.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "vdb_offset/parallel.h"

namespace vdb_offset {
namespace {

// How much of its heights a vertex keeps in a round of thinning; below the last share it keeps none.
constexpr double kKeptHeight = 0.85, kLeastShare = 0.01;
// Rounds in which thinned vertices are let out again, each by one step.
constexpr int kLetOuts = 12;
// Thickness may change by so much of the length of an edge.
constexpr double kThicknessSlope = 0.5;
// Heights are solved far below the promised 1e-6.
constexpr double kHeightTolerance = 1e-8;
// What the way up must have at least of each face's normal at the wall.
constexpr double kLeastSlope = 1e-2;
// Vertices whose distances are asked for together.
constexpr std::size_t kVertexBlock = 16;

/// The curve that a vertex's layers stand on: x(eta) = whole eta + bend eta (1 - eta)^2, from 0 at the surface to 1.
struct Rail {
  Vec3d whole, bend;
  Vec3d operator()(double eta) const { return whole * eta + bend * (eta * (1 - eta) * (1 - eta)); }
};

class Stacker {
 public:
  Stacker(const Body& body, const CellColumns& columns, std::span<const Vec3d> source,
          std::span<const Distances> heights, FaultFinder& faults, Paths& paths)
      : body_(body),
        front_(body.front.surface()),
        columns_(columns),
        source_(source),
        heights_(heights),
        side_(heights.back().farthest() < 0 ? -1 : 1),
        faults_(faults),
        paths_(paths),
        most_(source.size(), 0.0),
        straight_(source.size(), 0),
        wrong_column_(columns.size(), 0) {
    stack_.stacks.layers = heights.size();
    stack_.stacks.places.resize(source.size() * (heights.size() + 1));
    stack_.first_achieved.assign(source.size(), 0.0);
    for_each_index(source.size(), [&](std::size_t v) { most_[v] = share_at_end(static_cast<std::uint32_t>(v)); });
    stack_.share = most_;
  }

  LayerStack run(Progress& progress) {
    Indices all(source_.size());
    for (std::uint32_t v = 0; v < all.size(); ++v) all[v] = v;
    smooth(all);
    put(all);
    Indices back = std::move(all);
    std::erase_if(back, [&](std::uint32_t v) { return !moves(v) || (stack_.share[v] == most_[v] && most_[v] > 0); });
    faults_.look(back, [&](std::uint32_t v) { return outermost(v); });
    check_all_columns();
    stack_.statistics.wrong_columns = wrong_columns_.size();
    straighten();
    while (thin()) progress.advance(1);
    for (int i = 0; i < kLetOuts && let_out(); ++i) progress.advance(1);
    finish();
    return std::move(stack_);
  }

 private:
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
    const std::size_t blocks = (vertices.size() + kVertexBlock - 1) / kVertexBlock;
    for_each_index(
        blocks,
        [&](std::size_t block) {
          const std::size_t first = block * kVertexBlock;
          put_block(std::span(vertices).subspan(first, std::min(kVertexBlock, vertices.size() - first)));
        },
        4);
  }

  /// In haste, by walks from triangle to triangle, and found out whether that was right. Walks end where the distance
  /// is least all around, so that those for vertices with which it was not start again where it is least of all.
  void put_block(std::span<const std::uint32_t> vertices) {
    constexpr int kHasty = 3;
    const std::size_t layers = heights_.size();
    std::vector<std::uint32_t> pending, wrong, hints;
    for (const auto v : vertices) {
      std::fill(stack_.stacks.of(v).begin(), stack_.stacks.of(v).end(), source_[v]);
      if (!(stack_.share[v] > 0)) continue;
      pending.push_back(v);
      hints.insert(hints.end(), layers, nearest_face(v));
    }
    std::vector<Vec3d> points;
    std::vector<Closest> closest;
    for (int i = 0; i < kHasty && !pending.empty(); ++i) {
      points.clear();
      for (std::size_t j = 0; j < pending.size(); ++j) {
        std::uint32_t* const hint = hints.data() + j * layers;
        climb(pending[j], [&](std::size_t k, const Vec3d& x) {
          if (i == 0 && k > 0 && hint[k] == hint[0]) hint[k] = hint[k - 1];
          return std::sqrt(front_.walk_to_closest(x, hint[k]).squared_distance);
        });
        for (const Vec3d& place : stack_.stacks.of(pending[j]).subspan(1)) points.push_back(place - front_.origin);
      }
      closest.resize(points.size());
      body_.front.answer_together(points, hints, closest);
      wrong.clear();
      std::size_t kept = 0;
      for (std::size_t j = 0; j < pending.size(); ++j) {
        const auto answers = std::span(closest).subspan(j * layers, layers);
        if (has_heights(pending[j], answers)) continue;
        wrong.push_back(pending[j]);
        for (const Closest& answer : answers) hints[kept++] = answer.triangle;
      }
      hints.resize(kept);
      pending.swap(wrong);
    }
    for (const auto v : pending) put_with_care(v);
  }

  /// The triangle around a vertex that is closest to where its rail leads at first.
  std::uint32_t nearest_face(std::uint32_t v) const {
    const std::uint32_t on_front = body_.front_vertex.empty() ? v : body_.front_vertex[v];
    const Rail rail = rail_of(v);
    const Vec3d way = (rail.whole + rail.bend) * static_cast<double>(side_);
    std::uint32_t nearest = kNone;
    double least = 0;
    for (const auto t : front_.triangles_around(on_front)) {
      const double rise = front_.triangle_normals[t].dot(way);
      if (nearest != kNone && rise >= least) continue;
      nearest = t;
      least = rise;
    }
    return nearest;
  }

  /// Whether a vertex's layers are at their heights.
  bool has_heights(std::uint32_t v, std::span<const Closest> closest) {
    stack_.first_achieved[v] = closest.front().distance;
    for (std::size_t k = 0; k < closest.size(); ++k) {
      const double height = stack_.share[v] * std::abs(heights_[k][v]);
      if (!(std::abs(closest[k].distance - height) <= kReachedTolerance * height)) return false;
    }
    return true;
  }

  void put_with_care(std::uint32_t v) {
    std::uint32_t hint = body_.hint(v);
    const auto phi = [&](const Vec3d& x) {
      const Closest found = body_.front(x, hint);
      hint = found.triangle;
      return found.distance;
    };
    climb(v, [&](std::size_t, const Vec3d& x) { return phi(x); });
    stack_.first_achieved[v] = phi(stack_.stacks.of(v)[1] - front_.origin);
  }

  /// Goes along a vertex's rail from height to height. phi(layer, x) is the distance of a point in the front's frame.
  template <class Phi>
  void climb(std::uint32_t v, Phi&& phi) {
    const auto stack = stack_.stacks.of(v);
    const double share = stack_.share[v];
    const Rail rail = rail_of(v);
    const Vec3d origin = source_[v] - front_.origin;
    double eta = 0, here = 0;
    const double end = paths_.achieved[v];
    for (std::size_t k = 0; k < heights_.size(); ++k) {
      const double target = share * std::abs(heights_[k][v]);
      const bool at_end = k + 1 == heights_.size() && share == most_[v];
      if (at_end) eta = 1;
      else if (target > here) eta = solve(eta, here, end, target, [&](double s) { return phi(k, origin + rail(s)); });
      stack[k + 1] = source_[v] + (at_end ? rail.whole : round_way(rail(eta), target));
      here = std::max(here, target);
    }
  }

  /// Where on the rail, between `low` with distance `phi_low` and its end, the distance is `target`: false position
  /// with Illinois' weights, which meets a linear distance at once.
  template <class Phi>
  static double solve(double low, double phi_low, double phi_end, double target, Phi&& phi) {
    constexpr int kMost = 60;
    double high = 1, f_low = phi_low - target, f_high = phi_end - target;
    if (!(f_high > 0)) return 1;
    // The distance near the surface is linear from there: the first guess follows that from `low` on.
    double guess = low > 0 ? low * target / phi_low : target / phi_end;
    if (!(guess > low && guess < high)) guess = (low * f_high - high * f_low) / (f_high - f_low);
    for (int i = 0; i < kMost; ++i) {
      const double f = phi(guess) - target;
      if (std::abs(f) <= kHeightTolerance * target) return guess;
      if (f < 0) {
        low = guess;
        f_low = f;
        f_high *= i > 1 ? 0.5 : 1.0;
      } else {
        high = guess;
        f_high = f;
        f_low *= i > 1 ? 0.5 : 1.0;
      }
      const double next = (low * f_high - high * f_low) / (f_high - f_low);
      guess = next > low && next < high ? next : (low + high) / 2;
    }
    return guess;
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

  /// Stands the layers of wrong cells' vertices on straight lines, where these see all faces around.
  void straighten() {
    Indices corners = corners_of_wrong_columns();
    std::erase_if(corners, [&](std::uint32_t v) {
      return straight_[v] || stack_.share[v] == 0 || !sees_all_faces(v, paths_.displacement[v]);
    });
    if (corners.empty()) return;
    for (const auto v : corners) straight_[v] = 1;
    stack_.statistics.straightened = corners.size();
    move(corners);
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

  /// Lets all that is thinned out by one step, as far as thickness stays even, and takes those back that something is
  /// then wrong with. False if none could be let out.
  bool let_out() {
    Indices out;
    for (std::uint32_t v = 0; v < source_.size(); ++v)
      if (stack_.share[v] > 0 && stack_.share[v] < most_[v]) out.push_back(v);
    const std::vector<double> before = stack_.share;
    for (const auto v : out) stack_.share[v] = std::min(most_[v], before[v] / kKeptHeight);
    smooth_around(out);
    std::erase_if(out, [&](std::uint32_t v) { return stack_.share[v] == before[v]; });
    bool any = false;
    for (Indices moved = out; !moved.empty();) {
      move(moved);
      moved = wrong_vertices();
      std::erase_if(moved, [&](std::uint32_t v) { return stack_.share[v] == before[v]; });
      for (const auto v : moved) stack_.share[v] = before[v];
      const Indices lowered = smooth(moved);
      moved.insert(moved.end(), lowered.begin(), lowered.end());
      sort_unique(moved);
    }
    for (const auto v : out) any = any || stack_.share[v] > before[v];
    return any;
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

LayerStack stack_layers(const Body& body, const CellColumns& columns, std::span<const Vec3d> source,
                        std::span<const Distances> heights, FaultFinder& faults, Paths& paths,
                        const ProgressCallback& callback) {
  constexpr std::size_t kExpectedRounds = 32;
  Progress progress(callback, Stage::Layers, kExpectedRounds);
  return Stacker(body, columns, source, heights, faults, paths).run(progress);
}

}  // namespace vdb_offset
