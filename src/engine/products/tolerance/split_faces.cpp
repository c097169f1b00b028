// SPDX-License-Identifier: Apache-2.0
// Splits the faces of a mesh until all points of its offset are proven to be at the distance. The vertices of the mesh
// keep the targets that they reach as it is. Faces are split in stages with ever tighter tolerances, round by round;
// after each round, triangles whose pieces would be faulty are kept whole and the round is done again. Rounds end when
// they gain little, or when the limit of faces is met. The refined mesh is offset to its targets and made valid like
// any other, and certified on its coordinates as written against the mesh before splitting. Small triangles that cross
// others in the source, and edges of faces that are lines, are not split.
#include "products/tolerance/split_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "ground/mesh/count_states.h"
#include "ground/mesh/triangulate.h"
#include "ground/numbers/index_set.h"
#include "ground/numbers/rounding.h"
#include "ground/system/call_progress.h"
#include "ground/system/progress_count.h"
#include "ground/system/stage_timer.h"
#include "products/tolerance/interpolated_targets.h"
#include "products/tolerance/refined_mesh.h"
#include "products/tolerance/refined_triangles.h"
#include "products/tolerance/refiner.h"
#include "valid/faults/triangle_crossings.h"
#include "valid/proof/certified_faces.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// One call of split_faces().
class SplitRun {
 public:
  SplitRun(const PreparedMesh& prepared, const OffsetResult& coarse, const SplitFaces& asked)
      : prepared_(prepared),
        coarse_(coarse),
        mesh_(prepared.mesh()),
        split_(asked),
        options_(prepared.options()),
        corners_(asked.before_arcs ? Corners::Round : prepared.corners()),
        seconds_(coarse.statistics.seconds),
        source_crossings_(coarse.statistics.limit.source_crossings),
        crosses_nothing_(options_.collision == Collision::Limit && source_crossings_ == 0) {
    options_.progress = {};
  }

  RefinedOffset run() {
    find_crossings();
    refine();
    certify_faces();
    return std::move(refined_);
  }

 private:
  const Surface& surface() const { return prepared_.surface(); }
  Yield yield() const {
    Yield yield{.has_targets = true, .by_corner = !options_.distance.at_corner().empty()};
    if (split_.before_arcs) {
      yield.by_corner = true;
      yield.measured_faces = *split_.before_arcs;
    }
    return yield;
  }
  std::size_t mesh_triangles() const {
    return surface().triangles.size() -
           (prepared_.obstacles() ? prepared_.obstacles()->query.surface().triangles.size() : 0);
  }

  /// The displacement of a vertex of the surface; where it falls short, the direction that it would have gone in, as
  /// long as its distance.
  Vec3d displacement_of(std::uint32_t w, double asked) const {
    const std::uint32_t v = surface().representative[w];
    if (v == kNone || asked == 0) return Vec3d(0.0);
    const Vec3d displacement = coarse_.positions[v] - mesh_.positions[v];
    if (!falls_short(coarse_.states[v])) return displacement;
    // Not measured: what has gone a good part of its way has a direction.
    constexpr double kTellsDirection = 0.1;
    const double gone = displacement.length();
    if (gone > kTellsDirection * std::abs(asked)) return displacement * (std::abs(asked) / gone);
    const std::uint32_t on_part = prepared_.parts().part_vertex.empty() ? w : prepared_.parts().part_vertex[w];
    return on_part == kNone ? Vec3d(0.0) : start_direction(prepared_.parts().moving_part, on_part) * asked;
  }

  std::vector<RefinedVertex> vertices_of_surface(const Distances& asked) const {
    std::vector<RefinedVertex> vertices(surface().vertices.size());
    for (std::uint32_t w = 0; w < vertices.size(); ++w) {
      const std::uint32_t v = surface().representative[w];
      if (v == kNone) continue;
      vertices[w] = {asked[w], split_.tolerance.at(asked[w]), {}};
      vertices[w].target.displacement = coarse_.positions[v] - mesh_.positions[v];
      vertices[w].target.is_there = asked[w] != 0 && is_there(coarse_.states[v]);
      vertices[w].otherwise = coarse_.states[v];
      // Between arcs nothing is added in the planes of faces: all is to be at the distance.
      vertices[w].target.is_mitered = !split_.before_arcs && coarse_.states[v] == VertexState::Mitered;
    }
    return vertices;
  }

  /// Calls visit(face, corners) for the triangles of faces that the surface has not, such as are lines; but not of
  /// repeated faces, which are split as those are that they repeat.
  template <class Visit>
  void for_each_left_out(Visit&& visit) const {
    using Corners3 = std::array<std::uint32_t, 3>;
    std::vector<std::uint32_t> count(mesh_.face_count(), 0);
    for (std::size_t t = 0; t < mesh_triangles(); ++t) ++count[surface().face[t]];
    for (const RepeatedFace& repeated : surface().repeated)
      count[repeated.face] = static_cast<std::uint32_t>(mesh_.face(repeated.face).size());
    const auto is_left_out = [&](std::uint32_t f) { return count[f] + 2 < mesh_.face(f).size(); };
    const auto in_order = [](Corners3 corners) {
      std::sort(corners.begin(), corners.end());
      return corners;
    };
    std::vector<std::pair<std::uint32_t, Corners3>> had;  // of those faces
    for (std::size_t t = 0; t < mesh_triangles(); ++t)
      if (const std::uint32_t f = surface().face[t]; is_left_out(f))
        had.emplace_back(f, in_order(surface().triangles[t]));
    std::sort(had.begin(), had.end());
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      if (!is_left_out(f)) continue;
      std::vector<Corners3> triangles;
      append_triangles(mesh_, f, triangles);
      for (Corners3& corners : triangles) {
        for (auto& v : corners) v = surface().welded[v];
        if (!std::binary_search(had.begin(), had.end(), std::pair(f, in_order(corners)))) visit(f, corners);
      }
    }
  }

  std::vector<Edge> edges_left_out() const {
    std::vector<Edge> edges;
    for_each_left_out([&](std::uint32_t, const std::array<std::uint32_t, 3>& v) {
      for (std::size_t k = 0; k < 3; ++k) edges.push_back(edge_between(v[k], v[(k + 1) % 3]));
    });
    return edges;
  }

  /// Finds what crosses in the source, and in its offset before faces are split.
  void find_crossings() {
    if (crosses_nothing_) return;
    const SelfCrossings found = CrossingFinder(surface(), prepared_.source()).listed();
    take_met(found.pairs);
    for (const auto& [s, t] : found.pairs)
      for (const auto one : {s, t})
        if (one < mesh_triangles()) crossing_.push_back(one);
    for (std::uint32_t t = 0; t < found.crossed.size() && t < mesh_triangles(); ++t)
      if (found.crossed[t]) crossing_.push_back(t);
    sort_unique(crossing_);
    std::vector<Vec3d> moved = prepared_.source();
    for (std::uint32_t w = 0; w < moved.size(); ++w)
      if (const std::uint32_t v = surface().representative[w]; v != kNone) moved[w] = coarse_.positions[v];
    take_met(CrossingFinder(surface(), moved).listed().pairs);
    std::sort(met_.begin(), met_.end());
    met_.erase(std::unique(met_.begin(), met_.end()), met_.end());
  }

  void take_met(std::span<const TrianglePair> pairs) {
    for (const auto& [s, t] : pairs) {
      if (s >= mesh_triangles() || t >= mesh_triangles()) continue;
      const auto [first, second] = std::minmax(surface().face[s], surface().face[t]);
      met_.emplace_back(first, second);
    }
  }

  /// Small triangles that cross others in the source: large ones have much beside what crosses.
  std::vector<std::uint32_t> small_crossing_triangles() const {
    std::vector<std::uint32_t> small = crossing_;
    std::erase_if(small, [&](std::uint32_t t) {
      const auto& [a, b, c] = surface().triangles[t];
      const Vec3d &p = surface().vertices[a], &q = surface().vertices[b], &r = surface().vertices[c];
      return std::max({(q - p).length(), (r - q).length(), (p - r).length()}) > options_.distance.scale();
    });
    return small;
  }

  /// Splits the faces, in stages, and makes the offset of what comes of that.
  void refine() {
    std::optional<StageTimer> timer(std::in_place, seconds_, Stage::Refine);
    const Distances asked = ask(prepared_, {&options_.distance, 1}).asked.front();
    std::vector<Vec3d> displacement(surface().vertices.size());
    for (std::uint32_t w = 0; w < displacement.size(); ++w) displacement[w] = displacement_of(w, asked[w]);
    std::vector<RefinedVertex> vertices = vertices_of_surface(asked);
    const InterpolatedTargets targets(prepared_.parts(), prepared_.query(), prepared_.obstacles(), corners_,
                                      options_.miter_limit, std::move(displacement));
    triangles_.emplace(surface(), prepared_.source(), mesh_triangles());
    Refiner refiner(prepared_.parts(), prepared_.query(), targets, *triangles_, std::move(vertices),
                    {corners_, split_.most_faces, mesh_.face_count(), split_.tolerance.precision, edges_left_out(),
                     small_crossing_triangles()});
    const ProgressCallback of_splitting = part_of(split_.progress, 0, kSplitShare);
    Progress progress(of_splitting, Stage::Refine, kProgress);
    std::size_t told = 0;
    const auto tell = [&](double share) {
      const auto now = static_cast<std::size_t>(share * kProgress);
      if (now > told) progress.advance(now - std::exchange(told, now));
    };
    const double stages = 1 + std::ceil(std::log(refiner.loosest()) / std::log(kTightened));
    double stage = 0;
    const auto report_in_stage = [&](double share) { tell((stage + share) / stages); };
    for (double loosened = refiner.loosest();; loosened = std::max(1.0, loosened / kTightened), ++stage) {
      refiner.begin_stage(loosened);
      while (refiner.begin_round(report_in_stage) && split(refiner, loosened > 1 ? kLeastGainBefore : kLeastGain)) {
      }
      if (loosened == 1) break;
    }
    vertices_ = refiner.vertices();
    is_cut_short_ = refiner.is_cut_short();
    timer.reset();
    options_.progress = part_of(split_.progress, kSplitShare, 1);
    options_ = with_call_progress(options_);
    make_valid(refiner);
  }

  /// Splits what a round asks for, but for what would make faults. False if another round would hardly gain anything:
  /// this one has added little, and part of what it tried was faulty.
  /// \param least_gain of triangles, as a share
  bool split(Refiner& refiner, double least_gain) {
    const std::size_t before = triangles_->triangles().size();
    bool any_faulty = false;
    if (!refiner.split()) return false;
    // Where the source crosses itself, many faults stay whatever is whole.
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    for (int attempt = 0; attempt < kMostAttempts && options_.collision == Collision::Limit; ++attempt) {
      RefinedMesh refined(*triangles_, mesh_, options_, split_.tolerance.precision, split_.threads, yield(),
                          crosses_nothing_, met_);
      const std::vector<std::uint32_t> faulty = refined.faulty_triangles(refiner.vertices());
      any_faulty |= !faulty.empty();
      if (faulty.empty() || !refiner.keep_whole(faulty) || !refiner.split()) break;
      if (static_cast<double>(faulty.size()) > kFewer * static_cast<double>(fewest)) break;
      fewest = faulty.size();
    }
    const std::size_t added = triangles_->triangles().size() - before;
    const double least = (crosses_nothing_ ? 1 : kMoreWhereCrossing) * least_gain;
    return !any_faulty || static_cast<double>(added) > least * static_cast<double>(before);
  }

  void make_valid(const Refiner& refiner) {
    RefinedMesh refined(*triangles_, mesh_, options_, split_.tolerance.precision, split_.threads, yield(),
                        crosses_nothing_, met_);
    refined_.result = refined.offset(refiner.vertices());
    refined_.refinement = refined.take_refinement();
    // Where vertices hung, the refined mesh has no more than equal positions.
    SeamFacts& seams = refined_.result.statistics.facts.seams;
    seams.hanging = surface().facts.seams.hanging;
    seams.widest_hanging = surface().facts.seams.widest_hanging;
    numbers_ = refined.numbers();
    for (std::size_t s = 0; s < kStageCount; ++s) seconds_[s] += refined_.result.statistics.seconds[s];
  }

  /// Proves what can be proven of the result, against the mesh before its faces were split.
  void certify_faces() {
    OffsetResult& result = refined_.result;
    result.statistics.seconds = seconds_;
    const StageTimer timer(result.statistics.seconds, Stage::Measure);
    const Rounding precision(options_.precision);
    const std::size_t count = vertices_.size();
    std::vector<Vec3d> positions(triangles_->positions());
    std::vector<double> asked(count), tolerance(count);
    std::vector<VertexState> states(count, VertexState::Unused);
    for (std::size_t i = 0; i < count; ++i) {
      asked[i] = vertices_[i].asked;
      tolerance[i] = vertices_[i].tolerance;
      if (numbers_[i] == kNone) continue;
      positions[i] = precision(positions[i], result.positions[numbers_[i]]);
      states[i] = result.states[numbers_[i]];
    }
    std::vector<OffsetFace> faces;
    for (const auto& [vertex, source] : triangles_->triangles())
      if (prepared_.parts().off_part.empty() || !prepared_.parts().off_part[source]) faces.push_back({vertex, source});
    // What the surface leaves out is part of the result all the same, and nothing is proven of it.
    for_each_left_out([&](std::uint32_t f, const std::array<std::uint32_t, 3>& vertex) {
      if (options_.only.empty() || options_.only[f]) faces.push_back({vertex, kNone});
    });
    CertifiedFaces certified = certify({prepared_.query(), surface(), faces, triangles_->positions(), positions, asked,
                                        tolerance, states, corners_, split_.before_arcs.has_value()});
    certified.share = split_.tolerance.share;
    certified.length = split_.tolerance.length;
    certified.source_faces = mesh_.face_count();
    certified.source_vertices = mesh_.positions.size();
    certified.source_crossings = source_crossings_;
    certified.out_of_faces = is_cut_short_ && certified.certified < certified.there;
    result.statistics.certified = certified;
    count_states(result.states, result.statistics);
    report_share(split_.progress, Stage::Measure, 1);
  }

  // What is done of this once faces have been split. Measured: 0.5 to 0.9.
  static constexpr double kSplitShare = 0.75;
  static constexpr std::size_t kProgress = 1000;  // units of the stage's progress
  static constexpr double kTightened = 10;  // how many times a stage's tolerance is that of the next; not measured
  // Of triangles, for another round of the last stage, and of one before. Not measured beside many.
  static constexpr double kLeastGain = 0.04, kLeastGainBefore = 0.05;
  // How many times that where the source crosses itself: without, extruder_idler_quads at 0.5 % takes twice the time,
  // and less of its area is certified.
  static constexpr double kMoreWhereCrossing = 2;
  static constexpr int kMostAttempts = 12;  // at a round without faults; not measured
  // Share of the faulty triangles of one attempt that are worth another one.
  static constexpr double kFewer = 0.9;

  const PreparedMesh& prepared_;
  const OffsetResult& coarse_;
  PolygonView mesh_;
  const SplitFaces& split_;
  OffsetOptions options_;
  Corners corners_;
  std::array<double, kStageCount> seconds_{};
  std::optional<RefinedTriangles> triangles_;
  std::vector<RefinedVertex> vertices_;  // of triangles_
  std::vector<std::uint32_t> numbers_;   // of each of them: its vertex in the refinement
  std::size_t source_crossings_;         // pairs of the source's triangles that meet
  bool is_cut_short_ = false, crosses_nothing_;
  std::vector<std::uint32_t> crossing_;  // triangles that cross others in the source
  std::vector<FacePair> met_;            // faces that do, and faces that do in the offset before any are split; sorted
  RefinedOffset refined_;
};

}  // namespace

RefinedOffset split_faces(const PreparedMesh& prepared, const OffsetResult& coarse, const SplitFaces& asked) {
  return SplitRun(prepared, coarse, asked).run();
}

}  // namespace vdb_offset
