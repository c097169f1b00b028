#include "vdb_offset/curve_stack.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vdb_offset/layer_rail.h"
#include "vdb_offset/parallel.h"

namespace vdb_offset {
namespace {

/// > 0 if a to b and a to c turn counterclockwise, as far as a corner has to.
bool turns(const Vec3d& a, const Vec3d& b, const Vec3d& c, double sign) {
  const Vec3d ab = b - a, ac = c - a;
  return sign * (ab[0] * ac[1] - ab[1] * ac[0]) > kLeastLean * ab.length() * ac.length();
}

class CurveStacker {
 public:
  CurveStacker(const PlaneCurves& curves, std::span<const Distances> heights, Paths& paths)
      : curves_(curves),
        heights_(heights),
        side_(heights.back().farthest() < 0 ? -1 : 1),
        paths_(paths),
        faults_(curves),
        points_(curves.source.size()),
        most_(points_.size(), 0.0),
        straight_(points_.size(), 0),
        wrong_(curves.line().segments.size(), 0) {
    stack_.stacks = Stacks(points_.size(), heights.size());
    stack_.first_achieved.assign(points_.size(), 0.0);
    std::iota(points_.begin(), points_.end(), 0u);
    for (const auto p : points_) most_[p] = share_at_end(p);
    stack_.share = most_;
  }

  LayerStack run(Progress& progress) {
    smooth(points_);
    move(points_);
    stack_.statistics.wrong_columns = wrong_segments().size();
    while (straighten()) progress.advance(0);
    while (thin()) progress.advance(1);
    let_out(progress);
    finish();
    return std::move(stack_);
  }

 private:
  Vec3d source(std::uint32_t p) const { return {curves_.source[p][0], curves_.source[p][1], 0}; }
  double asked(std::uint32_t p) const { return std::abs(heights_.back()[p]); }
  const Segment& segment(std::uint32_t s) const { return curves_.line().segments[s]; }

  /// What a point could keep of its heights for where its path ended; nothing where no way up has both segments there
  /// in view, or where curves branch.
  double share_at_end(std::uint32_t p) {
    if (faults_.around(p).size() > 2) return 0;
    if (heights_.back()[p] == 0 || !(paths_.achieved[p] > 0)) return 0;
    const Vec3d& whole = paths_.displacement[p];
    straight_[p] = !sees_all(p, start_of_rail(p));
    if (straight_[p] && !sees_all(p, whole)) return 0;
    if (paths_.state[p] == VertexState::Reached) return 1;
    const double share = std::min(1.0, paths_.achieved[p] / asked(p));
    return share < kLeastShare ? 0 : share;
  }

  bool sees_all(std::uint32_t p, const Vec3d& way) const {
    for (const auto s : faults_.around(p))
      if (!(side_ * curves_.line().triangle_normals[s].dot(way) > kLeastSlope * way.length())) return false;
    return true;
  }

  Vec3d start_of_rail(std::uint32_t p) const {
    return start_direction(curves_.line(), p) * (side_ * paths_.displacement[p].length());
  }

  /// Lowers shares of these points and their neighbours until thickness is even enough. Returns those that it lowered.
  Indices smooth(Indices changed) {
    Indices lowered;
    for (std::size_t i = 0; i < changed.size(); ++i) {
      const std::uint32_t p = changed[i];
      if (heights_.back()[p] == 0) continue;
      const double thickness = stack_.share[p] * asked(p);
      for (const auto s : faults_.around(p)) {
        const std::uint32_t q = segment(s)[segment(s)[0] == p];
        const double most = thickness + kThicknessSlope * (curves_.source[q] - curves_.source[p]).length();
        if (!(stack_.share[q] * asked(q) > most * (1 + 1e-9))) continue;
        stack_.share[q] = most / asked(q) < kLeastShare ? 0 : most / asked(q);
        lowered.push_back(q);
        changed.push_back(q);
      }
    }
    sort_unique(lowered);
    return lowered;
  }

  /// Puts a point's layers where its share wants them, from the outermost down its rail.
  void put(std::uint32_t p) {
    const auto stack = stack_.stacks.of(p);
    std::fill(stack.begin(), stack.end(), source(p));
    const double share = stack_.share[p];
    if (!(share > 0)) return;
    const Vec3d& whole = paths_.displacement[p];
    const Rail rail{whole, straight_[p] ? Vec3d(0.0) : start_of_rail(p) - whole};
    const Vec3d origin = curves_.in_frame(curves_.source[p]);
    CareField<CurveQuery> field(curves_.front, faults_.around(p).front());
    RailPlace above{1, field.find(origin + whole)};
    for (std::size_t k = heights_.size(); k-- > 0;) {
      const double target = share * std::abs(heights_[k][p]);
      const bool at_end = k + 1 == heights_.size() && share == most_[p];
      if (!at_end) above = place_on(rail, origin, above, target, field);
      stack[k + 1] = stack[0] + (at_end ? whole : round_way(rail(above.eta), target));
      stack_.first_achieved[p] = above.phi.value;
    }
  }

  void move(const Indices& points) {
    for_each_index(
        points.size(), [&](std::size_t i) { put(points[i]); }, 64);
    std::vector<Vec2d> places;
    Indices segments;
    for (const auto p : points) {
      const Vec3d& outermost = stack_.stacks.of(p).back();
      places.emplace_back(outermost[0], outermost[1]);
      segments.insert(segments.end(), faults_.around(p).begin(), faults_.around(p).end());
    }
    faults_.move(points, places);
    sort_unique(segments);
    for_each_index(
        segments.size(), [&](std::size_t i) { wrong_[segments[i]] = !is_valid(segments[i]); }, 64);
    ++stack_.statistics.rounds;
  }

  /// Whether every cell over a segment turns the right way at each corner that is not flat.
  bool is_valid(std::uint32_t s) const {
    const auto a = stack_.stacks.of(segment(s)[0]), b = stack_.stacks.of(segment(s)[1]);
    const bool a_flat = a.front() == a.back(), b_flat = b.front() == b.back();
    if (a_flat && b_flat) return true;
    const double sign = -side_;  // outward is to the right
    for (std::size_t k = 1; k < a.size(); ++k) {
      if (!a_flat && !(turns(a[k - 1], b[k - 1], a[k], sign) && turns(a[k], a[k - 1], b[k], sign))) return false;
      if (!b_flat && !(turns(b[k - 1], b[k], a[k - 1], sign) && turns(b[k], a[k], b[k - 1], sign))) return false;
    }
    return true;
  }

  Indices wrong_segments() const {
    Indices wrong;
    for (std::uint32_t s = 0; s < wrong_.size(); ++s)
      if (wrong_[s]) wrong.push_back(s);
    return wrong;
  }

  Indices corners_of_wrong_segments() const {
    Indices corners;
    for (const auto s : wrong_segments()) corners.insert(corners.end(), segment(s).begin(), segment(s).end());
    sort_unique(corners);
    return corners;
  }

  Indices wrong_points() const {
    Indices wrong = faults_.wrong_points();
    const Indices corners = corners_of_wrong_segments();
    wrong.insert(wrong.end(), corners.begin(), corners.end());
    sort_unique(wrong);
    return wrong;
  }

  /// Stands the layers of wrong cells' points on straight lines, where these see both segments. False if none is left.
  bool straighten() {
    Indices corners = corners_of_wrong_segments();
    std::erase_if(corners, [&](std::uint32_t p) {
      return straight_[p] || stack_.share[p] == 0 || !sees_all(p, paths_.displacement[p]);
    });
    if (corners.empty()) return false;
    for (const auto p : corners) straight_[p] = 1;
    stack_.statistics.straightened += corners.size();
    move(corners);
    return true;
  }

  /// False if none of the points that something is wrong with has any height left.
  bool thin() {
    Indices wrong = wrong_points();
    std::erase_if(wrong, [&](std::uint32_t p) { return stack_.share[p] == 0; });
    if (wrong.empty()) return false;
    for (const auto p : wrong) {
      stack_.share[p] *= kKeptHeight;
      if (stack_.share[p] < kLeastShare) stack_.share[p] = 0;
    }
    const Indices lowered = smooth(wrong);
    wrong.insert(wrong.end(), lowered.begin(), lowered.end());
    sort_unique(wrong);
    move(wrong);
    return true;
  }

  /// Lets all that is thinned out again, step by step, and takes those back that something is then wrong with.
  void let_out(Progress& progress) {
    Indices thinned = points_;
    std::erase_if(thinned, [&](std::uint32_t p) { return !(stack_.share[p] > 0 && stack_.share[p] < most_[p]); });
    for (int i = 0; i < kLetOuts && !thinned.empty(); ++i) {
      progress.advance(1);
      const std::vector<double> before = stack_.share;
      for (const auto p : thinned) stack_.share[p] = std::min(most_[p], before[p] / kKeptHeight);
      smooth(points_);
      const auto stays = [&](std::uint32_t p) { return stack_.share[p] == before[p]; };
      std::erase_if(thinned, stays);
      for (Indices moved = thinned; !moved.empty();) {
        move(moved);
        moved = wrong_points();
        std::erase_if(moved, stays);
        for (const auto p : moved) stack_.share[p] = before[p];
        const Indices lowered = smooth(moved);
        moved.insert(moved.end(), lowered.begin(), lowered.end());
        sort_unique(moved);
      }
      std::erase_if(thinned, [&](std::uint32_t p) { return !(stack_.share[p] > before[p]); });
    }
  }

  void finish() {
    for (const auto p : points_) {
      if (heights_.back()[p] == 0 || stack_.share[p] == 1) continue;
      ++stack_.statistics.thinned_vertices;
      stack_.statistics.flat_vertices += stack_.share[p] == 0;
      if (stack_.share[p] == most_[p] && most_[p] > 0) continue;  // as far as its path went
      paths_.displacement[p] = stack_.stacks.of(p).back() - source(p);
      paths_.achieved[p] = stack_.share[p] > 0 ? faults_.distance_of(p) : 0;
      paths_.state[p] = VertexState::Limited;
    }
  }

  const PlaneCurves& curves_;
  std::span<const Distances> heights_;
  int side_;
  Paths& paths_;
  CurveFaults faults_;
  Indices points_;
  std::vector<double> most_;            // the share that each point could keep for where its path ended
  std::vector<std::uint8_t> straight_;  // whether its layers stand on a straight line
  std::vector<std::uint8_t> wrong_;     // of each segment
  LayerStack stack_;
};

}  // namespace

LayerStack stack_curves(const PlaneCurves& curves, std::span<const Distances> heights, Paths& paths,
                        const ProgressCallback& callback) {
  constexpr std::size_t kExpectedRounds = 32;
  Progress progress(callback, Stage::Layers, kExpectedRounds);
  return CurveStacker(curves, heights, paths).run(progress);
}

}  // namespace vdb_offset
