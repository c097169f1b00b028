// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/offset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/base/rounding.h"
#include "vdb_offset/error.h"
#include "vdb_offset/pipeline/field_stage.h"
#include "vdb_offset/validity/clearance.h"

namespace vdb_offset {
namespace {

// The most rounds, each of which is an offset. Not measured.
constexpr std::size_t kMostOffsets = 24;
// The number of rounds without progress after which fitting ends. Not measured.
constexpr std::size_t kPatience = 4;
// The gap that is aimed at, and the gap that counts as far enough, relative to the clearance: above it by the first,
// and below it by no more than the second, so that rounding does not decide.
constexpr double kBeyond = 3e-7, kFarEnough = 1e-6;
// The least gain of a vertex, as a share of what it goes farther inward, that the next round reckons with: what a
// vertex goes at once is at most seven times what it lacks. Not measured.
constexpr double kLeastFitGain = 0.15;

/// The other mesh, and distances from it.
class Other {
 public:
  Other(PolygonView mesh, double clearance)
      : surface_(placed(mesh)), query_(surface_), obstacles_{query_, clearance}, finder_(obstacles_) {}

  Other(const Other&) = delete;
  Other& operator=(const Other&) = delete;

  const Surface& surface() const { return surface_; }
  bool is_solid() const { return surface_.facts.closed() && surface_.facts.oriented(); }

  /// The distance of a position from the mesh; negative inside, if the mesh is a solid.
  double gap_at(const Vec3d& world, std::uint32_t hint = 0) const {
    const Vec3d x = world - surface_.origin;
    const auto [distance, triangle, feature, tied, point] = query_(x, hint);
    return is_solid() && surface_.pseudonormal(triangle, feature).dot(x - point) < 0 ? -distance : distance;
  }

  struct Near {
    double gap;   ///< The least distance, but no more than the limit that was asked for.
    Vec3d share;  ///< Barycentric coordinates of the triangle's nearest point.
  };
  /// The nearest point of a triangle, or its corner that is deepest inside. `at_corners` are the gaps of its corners.
  Near near(const TriangleCorners& world, const std::array<double, 3>& at_corners, double limit) const {
    const TriangleCorners local = {world[0] - surface_.origin, world[1] - surface_.origin, world[2] - surface_.origin};
    Vec3d where(0.0);
    Near near{finder_.gap(local, limit, where), Vec3d(0.0)};
    if (near.gap < limit) near.share = shares(local, where);
    for (int k = 0; k < 3; ++k) {
      const double at_corner = at_corners[static_cast<std::size_t>(k)];
      if (!(at_corner < std::min(0.0, near.gap))) continue;
      near.gap = at_corner;
      near.share = Vec3d(0.0);
      near.share[k] = 1;
    }
    return near;
  }

 private:
  static Surface placed(PolygonView mesh) {
    Surface surface = build_surface(mesh, {}, Orient::FixDirectionOnly);
    to_local_frame(surface, frame_voxel_size(surface.facts));
    return surface;
  }

  /// The barycentric coordinates of a point.
  static Vec3d shares(const TriangleCorners& t, const Vec3d& x) {
    const Vec3d n = (t[1] - t[0]).cross(t[2] - t[0]);
    Vec3d share(1.0 / 3);
    if (!(n.lengthSqr() > 0)) return share;
    for (int k = 0; k < 3; ++k) {
      const Vec3d &a = t[static_cast<std::size_t>(k + 1) % 3], &b = t[static_cast<std::size_t>(k + 2) % 3];
      share[k] = std::max(0.0, n.dot((b - a).cross(x - a)) / n.lengthSqr());
    }
    return share / (share[0] + share[1] + share[2]);
  }

  Surface surface_;
  ClosestQuery query_;
  Obstacles obstacles_;
  ClearanceFinder finder_;
};

/// Rounds of offsets, each of which goes farther by what the last one lacked.
class Fitting {
 public:
  Fitting(PolygonView mesh, PolygonView other, double clearance, const OffsetOptions& options)
      : mesh_(mesh),
        clearance_(clearance),
        options_(options),
        surface_(build_surface(mesh, options.weld, options.orient)),
        other_(other, clearance),
        depth_(surface_.vertices.size(), 0.0),
        stuck_(surface_.vertices.size(), 0),
        near_(surface_.triangles.size()),
        told_(surface_.triangles.size(), 0.0),
        gain_(surface_.triangles.size(), 1.0),
        vertex_gap_(surface_.vertices.size(), 0.0),
        vertex_told_(surface_.vertices.size(), 0.0),
        vertex_gain_(surface_.vertices.size(), 1.0) {
    double largest = 0;
    for (const Vec3d& p : mesh.positions)
      for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(p[k]));
    wanted_ = clearance * (1 + kBeyond) + 2 * largest * Rounding(options.precision).epsilon();
    options_.obstacles = {};
    options_.clearance = 0;
    options_.metric = {};
    options_.off_source = options_.inner_skin_last = false;
    mark_what_stays();
  }

  OffsetResult run() {
    OffsetResult best = offset_by_depths();
    measure_gaps(best.positions);
    FitFacts facts;
    facts.clearance = clearance_;
    facts.is_signed = other_.is_solid();
    facts.starting_gap = least_gap(best.positions);
    facts.near_at_start = short_;
    auto best_so_far = std::pair(short_, -gap_);
    std::size_t fruitless = 0;
    for (std::size_t round = 0; short_ > 0 && round < kMostOffsets && fruitless < kPatience && deepen(); ++round) {
      OffsetResult next = offset_by_depths();
      facts.rounds = round + 1;
      find_stuck(next);
      measure_gaps(next.positions);
      if (const auto is = std::pair(short_, -gap_); is < best_so_far) {
        best_so_far = is;
        best = std::move(next);
        fruitless = 0;
      } else {
        ++fruitless;
      }
    }
    facts.near = best_so_far.first;
    finish(best, facts);
    return best;
  }

 private:
  void mark_what_stays() {
    for (std::size_t t = 0; t < surface_.triangles.size() && !options_.only.empty(); ++t)
      if (!options_.only[surface_.face[t]])
        for (const auto v : surface_.triangles[t]) stuck_[v] = 1;
  }

  OffsetResult offset_by_depths() const {
    std::vector<double> each(mesh_.positions.size(), 0.0);
    for (std::size_t v = 0; v < each.size(); ++v)
      if (surface_.welded[v] != kNone) each[v] = 0 - depth_[surface_.welded[v]];
    OffsetOptions options = options_;
    options.distance = Distances(std::move(each));
    return offset(mesh_, options);
  }

  /// Measures the gaps of triangles and vertices at positions as they will be written, and how far they have grown of
  /// what they were to grow.
  void measure_gaps(std::span<const Vec3d> positions) {
    positions_.resize(surface_.vertices.size());
    for (std::size_t w = 0; w < positions_.size(); ++w) {
      const auto v = surface_.representative[w];
      positions_[w] = Rounding(options_.precision)(mesh_.positions[v], positions[v]);
    }
    std::vector<double> before(near_.size());
    for (std::size_t t = 0; t < near_.size(); ++t) before[t] = near_[t].gap;
    std::vector<double> gaps(positions_.size());
    for_each_index(
        gaps.size(), [&](std::size_t w) { gaps[w] = other_.gap_at(positions_[w]); }, 64);
    std::vector<Other::Near> now(near_.size());
    for_each_index(
        now.size(),
        [&](std::size_t t) {
          const auto& [a, b, c] = surface_.triangles[t];
          now[t] = other_.near({positions_[a], positions_[b], positions_[c]}, {gaps[a], gaps[b], gaps[c]}, wanted_);
        },
        64);
    for (std::size_t t = 0; t < now.size(); ++t) gain_[t] = gain_of(now[t].gap - before[t], told_[t]);
    for (std::size_t w = 0; w < gaps.size(); ++w) vertex_gain_[w] = gain_of(gaps[w] - vertex_gap_[w], vertex_told_[w]);
    near_ = std::move(now);
    vertex_gap_ = std::move(gaps);
    short_ = 0;
    gap_ = std::numeric_limits<double>::infinity();
    for (const auto& near : near_) {
      short_ += near.gap < clearance_ * (1 - kFarEnough);
      gap_ = std::min(gap_, near.gap);
    }
  }

  static double gain_of(double gained, double told) {
    return told > 0 ? std::clamp(gained / told, kLeastFitGain, 1.0) : 1;
  }

  /// Lets each vertex go farther inward by what it lacks itself, then the corners of faces by what the faces' nearest
  /// points still lack, in the sense of least squares. Returns false if no vertex can go farther.
  bool deepen() {
    std::vector<double> own(depth_.size(), 0.0);
    for (std::size_t w = 0; w < own.size(); ++w)
      if (!stuck_[w] && vertex_gap_[w] < wanted_) own[w] = (wanted_ - vertex_gap_[w]) / vertex_gain_[w];
    vertex_told_ = own;
    for (std::size_t t = 0; t < near_.size(); ++t)
      if (near_[t].gap < wanted_) add_for_face(t, own);
    for (std::size_t w = 0; w < depth_.size(); ++w) depth_[w] += vertex_told_[w];
    for (std::size_t t = 0; t < near_.size(); ++t) told_[t] = sum_at(t, vertex_told_);
    return std::any_of(vertex_told_.begin(), vertex_told_.end(), [](double more) { return more > 0; });
  }

  /// How much farther the nearest point of a triangle goes if the vertices go this much farther.
  double sum_at(std::size_t t, const std::vector<double>& more) const {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += near_[t].share[static_cast<int>(k)] * more[surface_.triangles[t][k]];
    return sum;
  }

  void add_for_face(std::size_t t, const std::vector<double>& own) {
    Vec3d free = near_[t].share;
    for (std::size_t k = 0; k < 3; ++k)
      if (stuck_[surface_.triangles[t][k]]) free[static_cast<int>(k)] = 0;
    const double squared = free.lengthSqr(), lack = (wanted_ - near_[t].gap) / gain_[t] - sum_at(t, own);
    if (!(squared > 0 && lack > 0)) return;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto w = surface_.triangles[t][k];
      vertex_told_[w] = std::max(vertex_told_[w], own[w] + lack * free[static_cast<int>(k)] / squared);
    }
  }

  /// Marks vertices that did not get as far as they were to go: they are not asked to go farther.
  void find_stuck(const OffsetResult& result) {
    for (std::size_t w = 0; w < depth_.size(); ++w) {
      const auto v = surface_.representative[w];
      if (depth_[w] == 0 || result.states[v] == VertexState::Reached) continue;
      stuck_[w] = 1;
    }
  }

  void finish(OffsetResult& best, FitFacts& facts) const {
    for (std::size_t v = 0; v < best.positions.size(); ++v) {
      if (best.positions[v] == mesh_.positions[v]) continue;
      ++facts.moved;
      facts.deepest = std::max(facts.deepest, best.achieved[v]);
    }
    facts.gap = least_gap(best.positions);
    facts.enclosed = count_enclosed(best.positions);
    best.statistics.fit = facts;
  }

  /// The least gap of all, even if it is above the clearance.
  double least_gap(std::span<const Vec3d> positions) const {
    const auto at = [&](std::uint32_t w) {
      const auto v = surface_.representative[w];
      return Rounding(options_.precision)(mesh_.positions[v], positions[v]);
    };
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t w = 0; w < surface_.vertices.size(); ++w) least = std::min(least, other_.gap_at(at(w)));
    if (least < 0) return least;
    for (const auto& [a, b, c] : surface_.triangles)
      least = std::min(least, other_.near({at(a), at(b), at(c)}, {0, 0, 0}, least).gap);
    return least;
  }

  /// Counts the components of the other mesh that lie in the result's solid, by one vertex of each.
  std::size_t count_enclosed(std::span<const Vec3d> positions) const {
    Surface result = build_surface({positions, mesh_.corners, mesh_.face_begin}, options_.weld, options_.orient);
    if (!result.facts.closed() || !result.facts.oriented()) return 0;
    to_local_frame(result, frame_voxel_size(result.facts));
    const ClosestQuery query(result);
    const Surface& other = other_.surface();
    std::vector<std::uint8_t> seen(other.facts.components, 0);
    std::size_t enclosed = 0;
    for (std::size_t w = 0; w < other.vertices.size(); ++w) {
      if (std::exchange(seen[other.component[w]], std::uint8_t{1})) continue;
      const Vec3d x = other.vertices[w] + other.origin - result.origin;
      const auto [distance, triangle, feature, tied, point] = query(x, 0);
      enclosed += result.pseudonormal(triangle, feature).dot(x - point) < 0;
    }
    return enclosed;
  }

  PolygonView mesh_;
  double clearance_, wanted_ = 0;
  OffsetOptions options_;
  Surface surface_;
  Other other_;
  std::vector<double> depth_;        // of each vertex: the distance that it goes inward
  std::vector<std::uint8_t> stuck_;  // of each vertex: 1 if it cannot go any farther, or is not to
  std::vector<Other::Near> near_;    // of each triangle
  std::vector<double> told_,
      gain_;  // of each triangle: how far its nearest point was to go, and the share it got of that
  std::vector<double> vertex_gap_, vertex_told_, vertex_gain_;  // of each vertex: its gap, and these two
  std::vector<Vec3d> positions_;                                // of each vertex
  std::size_t short_ = 0;                                       // triangles that are too near
  double gap_ = 0;  // the least gap of a triangle, but no more than what was wanted
};

}  // namespace

OffsetResult fit(PolygonView mesh, PolygonView other, double clearance, const OffsetOptions& options) {
  if (!(clearance > 0) || !std::isfinite(clearance))
    throw InvalidInput("fit: expected a clearance above 0, got " + std::to_string(clearance));
  if (other.face_count() == 0) throw InvalidInput("fit: expected another mesh with faces, found none");
  return Fitting(mesh, other, clearance, options).run();
}

}  // namespace vdb_offset
