// SPDX-License-Identifier: Apache-2.0
// Makes room between two meshes by rounds of offsets inward: flat faces and vertices go farther by what they still
// lack. The round with the fewest triangles too near is the result; rounds end if none is, or if they get no better.
#include "vdb_offset/offset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "ground/numbers/rounding.h"
#include "ground/system/call_progress.h"
#include "ground/system/parallel.h"
#include "products/offset/field_stage.h"
#include "products/offset/fit_parts.h"
#include "space/field/run_bytes.h"
#include "valid/faults/clearance.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// The most rounds, each of which is an offset. Not measured.
constexpr std::size_t kMostOffsets = 24;
// The number of rounds without progress after which fitting ends. Not measured.
constexpr std::size_t kPatience = 4;
// The gap that is aimed at, and the gap that counts as far enough, relative to the clearance: above it by the first,
// and below it by no more than the second, so that rounding does not decide.
constexpr double kBeyond = 3e-7, kFarEnough = 1e-6;
// The least gain of a part, as a share of what it goes farther inward, that the next round reckons with: what a
// part goes at once is at most seven times what it lacks. Not measured.
constexpr double kLeastFitGain = 0.15;
constexpr double kLeastOfBest = 0.5;  // of the gain of another part at the same place; with less, a part stays
// The share of a corner below which a point of a triangle is on the edge across from it. Reasoned: far above rounding.
constexpr double kOnEdge = 1e-6;
// How far inside of a triangle what touches its rim is placed, as a share of the way to its middle. Not measured.
constexpr double kJustInside = 1e-3;
// Share of the clearance below which a gap has no direction but for rounding. Not measured.
constexpr double kTouching = 1e-6;

/// The surface in its local frame, with its normals.
Surface placed(Surface surface) {
  to_local_frame(surface, frame_voxel_size(surface.facts));
  return surface;
}

/// Where a triangle is nearest to the other mesh.
struct Near {
  double gap;   ///< The least distance, but no more than the limit that was asked for.
  Vec3d share;  ///< Barycentric coordinates of the triangle's nearest point.
};

/// The other mesh, and distances from it.
class Other {
 public:
  Other(PolygonView mesh, double clearance)
      : surface_(placed(build_surface(mesh, {}, Orient::FixDirectionOnly))),
        query_(surface_),
        obstacles_{query_, clearance},
        finder_(obstacles_) {}

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

  bool touches(double gap) const { return std::abs(gap) <= kTouching * obstacles_.clearance; }
  /// How much a point gains of what it goes along a unit vector, -1 to 1; where it touches the mesh, which has no
  /// outside, all.
  double gain_along(const Vec3d& world, const Vec3d& along) const {
    const Vec3d x = world - surface_.origin;
    const auto [distance, triangle, feature, tied, point] = query_(x, 0);
    const Vec3d normal = surface_.pseudonormal(triangle, feature);
    if (touches(distance)) return is_solid() ? along.dot(normal) / normal.length() : 1;
    return along.dot(is_solid() && normal.dot(x - point) < 0 ? point - x : x - point) / distance;
  }

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
      : triangles_(split_polygons(mesh)),
        mesh_{mesh.positions, mesh.corners, mesh.face_begin, triangles_},
        clearance_(clearance),
        options_(options),
        surface_(placed(build_surface(mesh_, options.weld, options.orient))),
        other_(other, clearance),
        parts_(surface_, options.only),
        depth_(parts_.count(), 0.0),
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
    options_.clearance = options_.taper = 0;  // and each vertex goes as far as it has to
    options_.metric = {};
    options_.off_source = options_.inner_skin_last = false;
    options_.corners = Corners::Miter;
    options_.bytes_held += surface_bytes(surface_) + surface_bytes(other_.surface());
  }

  /// What the first round would do.
  OffsetStatistics plan() {
    FitFacts facts = facts_at_start();
    if (short_ > 0) deepen();
    for (const double depth : depth_) facts.deepest = std::max(facts.deepest, depth);
    OffsetStatistics statistics = plan_offset(mesh_, to_depths(0));
    if (facts.deepest == 0) statistics.plan.bytes = kProcessBytes + options_.bytes_held;
    statistics.fit = facts;
    return statistics;
  }

  OffsetResult run() {
    OffsetResult best = offset(mesh_, to_depths(0));
    FitFacts facts = facts_at_start();
    auto best_so_far = std::pair(short_, -gap_);
    std::size_t fruitless = 0;
    for (std::size_t round = 0; short_ > 0 && round < kMostOffsets && fruitless < kPatience && deepen(); ++round) {
      facts.rounds = round + 1;
      OffsetResult next = offset(mesh_, to_depths(facts.rounds));
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
  FitFacts facts_at_start() {
    measure_gaps(mesh_.positions);
    return {.clearance = clearance_,
            .starting_gap = least_gap(mesh_.positions),
            .near_at_start = short_,
            .is_signed = other_.is_solid()};
  }

  /// Options with the distances of vertices and of corners of faces, by what their parts have to go.
  OffsetOptions to_depths(std::size_t round) const {
    std::vector<double> each(mesh_.positions.size(), 0.0), at_corner(mesh_.corners.size(), 0.0);
    std::vector<double> sum(surface_.vertices.size(), 0.0), count(surface_.vertices.size(), 0.0);
    for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        if (parts_.of(t)[k] == kNone) continue;
        const auto w = surface_.triangles[t][k];
        const double depth = depth_[parts_.of(t)[k]];
        sum[w] += depth;
        ++count[w];
        for (std::uint32_t c = mesh_.face_begin[surface_.face[t]]; c < mesh_.face_begin[surface_.face[t] + 1]; ++c)
          if (surface_.welded[mesh_.corners[c]] == w) at_corner[c] = 0 - depth;
      }
    for (std::size_t v = 0; v < each.size(); ++v)
      if (const auto w = surface_.welded[v]; w != kNone && count[w] > 0) each[v] = 0 - sum[w] / count[w];
    OffsetOptions options = options_;
    options.progress = part_of_round(options_.progress, round);
    options.distance = Distances(std::move(each), std::move(at_corner));
    return options;
  }

  /// Measures the gaps of triangles and vertices at positions as they will be written, and how far they have grown of
  /// what they were to grow.
  void measure_gaps(std::span<const Vec3d> positions) {
    positions_.resize(surface_.vertices.size());
    for (std::uint32_t w = 0; w < positions_.size(); ++w) positions_[w] = as_written(positions, w);
    std::vector<double> before(near_.size());
    for (std::size_t t = 0; t < near_.size(); ++t) before[t] = near_[t].gap;
    std::vector<double> gaps(positions_.size());
    for_each_index(
        gaps.size(), [&](std::size_t w) { gaps[w] = other_.gap_at(positions_[w]); }, 64);
    std::vector<Near> now(near_.size());
    for_each_index(
        now.size(),
        [&](std::size_t t) {
          const auto& [a, b, c] = surface_.triangles[t];
          now[t] = other_.near({positions_[a], positions_[b], positions_[c]}, {gaps[a], gaps[b], gaps[c]}, wanted_);
        },
        64);
    for (std::size_t t = 0; t < now.size(); ++t) measure_gain(now[t].gap - before[t], told_[t], gain_[t]);
    for (std::size_t w = 0; w < gaps.size(); ++w)
      measure_gain(gaps[w] - vertex_gap_[w], vertex_told_[w], vertex_gain_[w]);
    near_ = std::move(now);
    vertex_gap_ = std::move(gaps);
    short_ = 0;
    gap_ = std::numeric_limits<double>::infinity();
    for (const auto& near : near_) {
      short_ += near.gap < clearance_ * (1 - kFarEnough);
      gap_ = std::min(gap_, near.gap);
    }
  }

  /// Sets the share of what was expected that has been gained, if that was more than next to nothing.
  void measure_gain(double gained, double expected, double& gain) const {
    if (expected > kLeastOfBest * kLeastFitGain * wanted_) gain = std::clamp(gained / expected, kLeastFitGain, 1.0);
  }

  /// Lets parts go farther inward by what their vertices lack, then by what the nearest points of faces still lack, in
  /// the sense of least squares. Returns false if none can go farther.
  bool deepen() {
    more_.assign(depth_.size(), 0.0);
    at_vertex_.clear();
    vertex_told_.assign(vertex_told_.size(), 0.0);
    for (std::uint32_t w = 0; w < vertex_gap_.size(); ++w)
      if (!stuck_[w] && vertex_gap_[w] < wanted_) add_for_vertex(w);
    const std::vector<double> of_vertices = more_;
    for (std::uint32_t t = 0; t < near_.size(); ++t)
      if (near_[t].gap < wanted_) add_for_face(t, of_vertices);
    for (std::size_t p = 0; p < depth_.size(); ++p) {
      // What is far enough stays: a corner of faces of which one hardly moves has no miter.
      if (depth_[p] == 0 && more_[p] < kFarEnough * clearance_) more_[p] = 0;
      depth_[p] += more_[p];
    }
    for (std::uint32_t t = 0; t < near_.size(); ++t) told_[t] = sum_at(t, more_);
    return std::any_of(more_.begin(), more_.end(), [](double more) { return more > 0; });
  }

  /// How much farther the nearest point of a triangle goes if the parts go this much farther.
  double sum_at(std::uint32_t t, const std::vector<double>& more) const {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (parts_.of(t)[k] != kNone) sum += near_[t].share[static_cast<int>(k)] * more[parts_.of(t)[k]];
    return sum;
  }

  /// How much a point of a triangle gains of what the triangle goes inward. At its rim that is taken from just inside
  /// of the triangle, as what touches there has several sides.
  double expected_gain(std::uint32_t t, const Vec3d& point, bool touches) const {
    const auto& [a, b, c] = surface_.triangles[t];
    const Vec3d middle = (positions_[a] + positions_[b] + positions_[c]) / 3;
    return other_.gain_along(touches ? point + (middle - point) * kJustInside : point, -surface_.triangle_normals[t]);
  }

  /// How far each side of the surface at a point has to go, as a multiple of what the point lacks: as far as that
  /// helps, and no side that helps far less than another. So what is beside a wall that gives way stays. A side is
  /// named by its part at the vertex.
  /// \param around the triangles that the point is on, which share the vertex
  std::map<std::uint32_t, double> sides_at(const Vec3d& point, double gap, std::uint32_t vertex,
                                           std::span<const std::uint32_t> around) const {
    std::map<std::uint32_t, double> sides;
    const bool touches = other_.touches(gap);
    double best = kLeastFitGain;
    for (const auto t : around) {
      const std::uint32_t side = parts_.at(t, vertex);
      if (side == kNone) continue;
      double& most = sides.try_emplace(side, -1.0).first->second;
      most = std::max(most, expected_gain(t, point, touches));
      best = std::max(best, most);
    }
    std::erase_if(sides, [&](const auto& each) { return each.second < kLeastOfBest * best; });
    double squared = 0;
    for (const auto& [side, gain] : sides) squared += gain * gain;
    // What touches several sides of the other mesh has to leave each of them.
    for (auto& [side, gain] : sides) gain = touches ? 1 : gain / std::sqrt(squared);
    return sides;
  }

  /// What sides_at() finds at a vertex, once a round: of a fan, all triangles may be nearest there.
  const std::map<std::uint32_t, double>& sides_at_vertex(std::uint32_t w) {
    const auto [known, is_new] = at_vertex_.try_emplace(w);
    if (is_new) known->second = sides_at(positions_[w], vertex_gap_[w], w, surface_.triangles_around(w));
    return known->second;
  }

  /// Flat faces go for their triangles, which know better where they lack.
  void add_for_vertex(std::uint32_t w) {
    const double lack = (wanted_ - vertex_gap_[w]) / vertex_gain_[w];
    for (const auto& [part, share] : sides_at_vertex(w)) {
      if (parts_.is_flat(part)) continue;
      more_[part] = lack * share;
      vertex_told_[w] = lack;
    }
  }

  void add_for_face(std::uint32_t t, const std::vector<double>& of_vertices) {
    const Near& near = near_[t];
    const auto& corners = surface_.triangles[t];
    Vec3d point(0.0);
    std::map<std::uint32_t, double> shares;  // of each part that can go farther
    std::vector<std::uint32_t> around{t};
    std::uint32_t vertex = kNone;
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = near.share[static_cast<int>(k)];
      const std::uint32_t part = parts_.of(t)[k];
      point += positions_[corners[k]] * share;
      if (share < kOnEdge) around.push_back(surface_.next_around_edge[3 * t + (k + 1) % 3] / 3);
      else vertex = corners[k];
      if (part != kNone && !stuck_[corners[k]]) shares[part] += share;
    }
    const bool is_at_vertex = around.size() == 3;
    if (is_at_vertex && !parts_.is_flat(parts_.at(t, vertex))) return;  // the vertex has gone for it
    const std::map<std::uint32_t, double> sides =
        is_at_vertex ? sides_at_vertex(vertex) : sides_at(point, near.gap, vertex, around);
    const auto side = sides.find(parts_.at(t, vertex));
    double squared = 0;
    for (const auto& [part, share] : shares) squared += share * share;
    const double lack = (wanted_ - near.gap) / gain_[t] - sum_at(t, of_vertices);
    if (side == sides.end() || !(squared > 0 && lack > 0)) return;
    for (const auto& [part, share] : shares)
      more_[part] = std::max(more_[part], of_vertices[part] + lack * side->second * share / squared);
  }

  /// Marks vertices that did not get as far as they were to go: nothing goes farther for them.
  void find_stuck(const OffsetResult& result) {
    for (std::size_t w = 0; w < stuck_.size(); ++w)
      if (falls_short(result.states[surface_.representative[w]])) stuck_[w] = 1;
  }

  void finish(OffsetResult& best, FitFacts& facts) const {
    for (std::size_t v = 0; v < best.positions.size(); ++v) {
      if (best.positions[v] == mesh_.positions[v]) continue;
      ++facts.moved;
      facts.deepest = std::max(facts.deepest, (best.positions[v] - mesh_.positions[v]).length());
    }
    facts.gap = least_gap(best.positions);
    facts.enclosed = count_enclosed(best.positions);
    best.statistics.fit = facts;
    report_share(options_.progress, Stage::Measure, 1);
  }

  Vec3d as_written(std::span<const Vec3d> positions, std::uint32_t w) const {
    const auto v = surface_.representative[w];
    return Rounding(options_.precision)(mesh_.positions[v], positions[v]);
  }

  /// The least gap of all, even if it is above the clearance.
  double least_gap(std::span<const Vec3d> positions) const {
    double least = std::numeric_limits<double>::infinity();
    const auto at = [&](std::uint32_t w) { return as_written(positions, w); };
    for (std::uint32_t w = 0; w < surface_.vertices.size(); ++w) least = std::min(least, other_.gap_at(at(w)));
    if (least < 0) return least;
    for (const auto& [a, b, c] : surface_.triangles)
      least = std::min(least, other_.near({at(a), at(b), at(c)}, {0, 0, 0}, least).gap);
    return least;
  }

  /// Counts the components of the other mesh that lie in the result's solid, by one vertex of each.
  std::size_t count_enclosed(std::span<const Vec3d> positions) const {
    const Surface result = placed(
        build_surface({positions, mesh_.corners, mesh_.face_begin, mesh_.triangles}, options_.weld, options_.orient));
    if (!result.facts.closed() || !result.facts.oriented()) return 0;
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

  std::vector<std::array<std::uint32_t, 3>> triangles_;  // of the mesh's faces, at its own positions
  PolygonView mesh_;
  double clearance_, wanted_ = 0;
  OffsetOptions options_;
  Surface surface_;
  Other other_;
  FitParts parts_;
  std::vector<double> depth_, more_;  // of each part: the distance that it goes inward, and what is added in a round
  std::vector<std::uint8_t> stuck_;   // of each vertex: 1 if it cannot go any farther
  std::vector<Near> near_;            // of each triangle
  std::map<std::uint32_t, std::map<std::uint32_t, double>> at_vertex_;  // of a round, as sides_at() of vertices
  std::vector<double> told_, gain_;  // of each triangle: how far its nearest point was to go, and its share of that
  std::vector<double> vertex_gap_, vertex_told_, vertex_gain_;  // of each vertex: its gap, and these two
  std::vector<Vec3d> positions_;                                // of each vertex
  std::size_t short_ = 0;                                       // triangles that are too near
  double gap_ = 0;  // the least gap of a triangle, but no more than what was wanted
};

void require_usable(PolygonView other, double clearance) {
  if (!(clearance > 0) || !std::isfinite(clearance))
    throw InvalidInput("fit: expected a clearance above 0, got " + std::to_string(clearance));
  if (other.face_count() == 0) throw InvalidInput("fit: expected another mesh with faces, found none");
}

}  // namespace

OffsetResult fit(PolygonView mesh, PolygonView other, double clearance, const OffsetOptions& options) {
  require_usable(other, clearance);
  return Fitting(mesh, other, clearance, options).run();
}

OffsetStatistics plan_fit(PolygonView mesh, PolygonView other, double clearance, const OffsetOptions& options) {
  require_usable(other, clearance);
  return Fitting(mesh, other, clearance, options).plan();
}

}  // namespace vdb_offset
