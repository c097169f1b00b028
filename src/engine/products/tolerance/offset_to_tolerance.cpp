// SPDX-License-Identifier: Apache-2.0
// Offsets a mesh with its faces split until all points of them are proven to be at the distance. The mesh is offset as
// it is first, and its vertices keep the targets that they reach there. Then faces are split in stages with ever
// tighter tolerances, round by round; after each round, triangles whose pieces would be faulty are kept whole and the
// round is done again. Rounds end when they gain little, or when the limit of faces is met. The refined mesh is offset
// to its targets and made valid like any other, and certified on its coordinates as written against the source before
// splitting. Small triangles that cross others in the source, and edges of faces that are lines, are not split. Shells,
// fields, paths and distances by axis are refused.
#include "vdb_offset/offset.h"

#include <fmt/format.h>

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
#include "products/arcs/offset_with_arcs.h"
#include "products/offset/field_stage.h"
#include "products/offset/make_results.h"
#include "products/offset/prepared_mesh.h"
#include "products/tolerance/interpolated_targets.h"
#include "products/tolerance/refined_mesh.h"
#include "products/tolerance/refined_triangles.h"
#include "products/tolerance/refiner.h"
#include "valid/faults/triangle_crossings.h"
#include "valid/proof/certified_faces.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// The least tolerance, as a share of the distance. Reasoned: ten times as much as vertices may be off.
constexpr double kLeastTolerance = 1e-5;
void require_usable(const OffsetOptions& options, const Tolerance& tolerance) {
  const bool by_share = tolerance.share != 0, by_length = tolerance.length != 0;
  if (by_share == by_length) throw InvalidInput("tolerance: expected a share or a length, got both or none of them");
  if (by_share && !(tolerance.share >= kLeastTolerance && tolerance.share < 1))
    throw InvalidInput(
        fmt::format("tolerance: expected a share from {} to 1, got {}", kLeastTolerance, tolerance.share));
  const double most = options.distance.scale(), least = kLeastTolerance * most;
  if (by_length && most > 0 && !(tolerance.length >= least && tolerance.length < most))
    throw InvalidInput(fmt::format("tolerance: expected a length from {:g} to {:g} (the distance), got {:g}", least,
                                   most, tolerance.length));
  if (!options.metric.even() || options.off_source || options.inner_skin_last || options.keep_field ||
      options.keep_paths)
    throw InvalidInput(
        "tolerance: expected an offset whose distance is the same along all axes, no shell, and neither a field nor "
        "paths to be kept");
}

/// The mesh as it is, where no vertex moves.
RefinedOffset unmoved(PolygonView mesh, const OffsetOptions& options) {
  RefinedOffset result;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) result.refinement.parent.push_back(f);
  result.refinement.polygons = {{mesh.positions.begin(), mesh.positions.end()},
                                {mesh.corners.begin(), mesh.corners.end()},
                                {mesh.face_begin.begin(), mesh.face_begin.end()}};
  result.result = offset(mesh, options);
  return result;
}

/// One call of offset_to_tolerance().
class RefinedRun {
 public:
  RefinedRun(PolygonView mesh, const OffsetOptions& options, const Tolerance& tolerance, int threads)
      : mesh_(mesh),
        progress_(options.progress),
        options_(options_of_coarse(options)),
        tolerance_(tolerance),
        threads_(threads),
        space_(mesh, options.metric),
        prepared_(space_, options_, threads, farthest_of({&options.distance, 1}),
                  {.by_corner = !options.distance.at_corner().empty()}) {}

  RefinedOffset run() {
    const AskedDistances asked = ask(prepared_, {&options_.distance, 1});
    const OffsetResult coarse =
        std::move(make_results(prepared_, asked, prepared_.march(asked.moved, ridges_of(options_))).front());
    prepared_.field() = {};
    seconds_ = coarse.statistics.seconds;
    source_crossings_ = coarse.statistics.limit.source_crossings;
    crosses_nothing_ = options_.collision == Collision::Limit && source_crossings_ == 0;
    find_crossings(coarse);
    options_.progress = {};
    refine(asked.asked.front(), coarse);
    certify_faces();
    return std::move(refined_);
  }

 private:
  const Surface& surface() const { return prepared_.surface(); }
  std::size_t mesh_triangles() const {
    return surface().triangles.size() -
           (prepared_.obstacles() ? prepared_.obstacles()->query.surface().triangles.size() : 0);
  }

  /// The displacement of a vertex of the surface; where it falls short, the direction that it would have gone in, as
  /// long as its distance.
  Vec3d displacement_of(std::uint32_t w, double asked, const OffsetResult& coarse) const {
    const std::uint32_t v = surface().representative[w];
    if (v == kNone || asked == 0) return Vec3d(0.0);
    const Vec3d displacement = coarse.positions[v] - mesh_.positions[v];
    if (!falls_short(coarse.states[v])) return displacement;
    // Not measured: what has gone a good part of its way has a direction.
    constexpr double kTellsDirection = 0.1;
    const double gone = displacement.length();
    if (gone > kTellsDirection * std::abs(asked)) return displacement * (std::abs(asked) / gone);
    const std::uint32_t on_part = prepared_.parts().part_vertex.empty() ? w : prepared_.parts().part_vertex[w];
    return on_part == kNone ? Vec3d(0.0) : start_direction(prepared_.parts().moving_part, on_part) * asked;
  }

  std::vector<RefinedVertex> vertices_of_surface(const Distances& asked, const OffsetResult& coarse) const {
    std::vector<RefinedVertex> vertices(surface().vertices.size());
    for (std::uint32_t w = 0; w < vertices.size(); ++w) {
      const std::uint32_t v = surface().representative[w];
      if (v == kNone) continue;
      vertices[w] = {asked[w], tolerance_.at(asked[w]), {}};
      vertices[w].target.displacement = coarse.positions[v] - mesh_.positions[v];
      vertices[w].target.is_there = asked[w] != 0 && is_there(coarse.states[v]);
      vertices[w].otherwise = coarse.states[v];
      vertices[w].target.is_mitered = coarse.states[v] == VertexState::Mitered;
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
  void find_crossings(const OffsetResult& coarse) {
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
      if (const std::uint32_t v = surface().representative[w]; v != kNone) moved[w] = coarse.positions[v];
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
  void refine(const Distances& asked, const OffsetResult& coarse) {
    std::optional<StageTimer> timer(std::in_place, seconds_, Stage::Refine);
    std::vector<Vec3d> displacement(surface().vertices.size());
    for (std::uint32_t w = 0; w < displacement.size(); ++w) displacement[w] = displacement_of(w, asked[w], coarse);
    std::vector<RefinedVertex> vertices = vertices_of_surface(asked, coarse);
    const InterpolatedTargets targets(prepared_.parts(), prepared_.query(), prepared_.obstacles(), prepared_.corners(),
                                      options_.miter_limit, std::move(displacement));
    triangles_.emplace(surface(), prepared_.source(), mesh_triangles());
    Refiner refiner(prepared_.parts(), prepared_.query(), targets, *triangles_, std::move(vertices),
                    {prepared_.corners(), tolerance_.limit_of_faces(mesh_.face_count()), mesh_.face_count(),
                     tolerance_.precision, edges_left_out(), small_crossing_triangles()});
    const ProgressCallback of_splitting = part_of(progress_, kCoarseShare, kSplitShare);
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
    options_.progress = part_of(progress_, kSplitShare, 1);
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
      RefinedMesh refined(*triangles_, mesh_, options_, tolerance_.precision, threads_, crosses_nothing_, met_);
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
    RefinedMesh refined(*triangles_, mesh_, options_, tolerance_.precision, threads_, crosses_nothing_, met_);
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
                                        tolerance, states, prepared_.corners()});
    certified.share = tolerance_.share;
    certified.length = tolerance_.length;
    certified.source_faces = mesh_.face_count();
    certified.source_vertices = mesh_.positions.size();
    certified.source_crossings = source_crossings_;
    certified.out_of_faces = is_cut_short_ && certified.certified < certified.there;
    result.statistics.certified = certified;
    count_states(result.states, result.statistics);
    report_share(progress_, Stage::Measure, 1);
  }

  static OffsetOptions options_of_coarse(OffsetOptions options) {
    options.progress = part_of(options.progress, 0, kCoarseShare);
    return with_call_progress(options);
  }

  // What of the call is done once the mesh has been offset as it is, and once its faces have been split. Measured: 0.1
  // to 0.4, and 0.6 to 0.9.
  static constexpr double kCoarseShare = 0.25, kSplitShare = 0.8;
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

  PolygonView mesh_;
  ProgressCallback progress_;  // of the whole call; those of its parts are in options_
  OffsetOptions options_;
  const Tolerance& tolerance_;
  int threads_;
  InMetric space_;
  PreparedMesh prepared_;
  std::array<double, kStageCount> seconds_{};
  std::optional<RefinedTriangles> triangles_;
  std::vector<RefinedVertex> vertices_;  // of triangles_
  std::vector<std::uint32_t> numbers_;   // of each of them: its vertex in the refinement
  bool is_cut_short_ = false, crosses_nothing_ = false;
  std::size_t source_crossings_ = 0;     // pairs of the source's triangles that meet
  std::vector<std::uint32_t> crossing_;  // triangles that cross others in the source
  std::vector<FacePair> met_;            // faces that do, and faces that do in the offset before any are split; sorted
  RefinedOffset refined_;
};

}  // namespace

double Tolerance::at(double distance) const { return share > 0 ? share * std::abs(distance) : length; }

std::size_t Tolerance::limit_of_faces(std::size_t mesh_faces) const {
  constexpr std::size_t kFacesForEach = 20, kFacesInAnyCase = 1000000;  // as the declaration says
  return most_faces > 0 ? most_faces : std::max(kFacesForEach * mesh_faces, kFacesInAnyCase);
}

RefinedOffset offset_to_tolerance(PolygonView mesh, const OffsetOptions& given, const Tolerance& tolerance) {
  const bool has_arcs = given.corners == Corners::Arc;
  OffsetOptions options = given;
  if (has_arcs) {
    options.corners = Corners::Miter;
    options.exact = nullptr;
  }
  vdb_offset::require_usable(mesh, {&options.distance, 1}, options);
  require_usable(options, tolerance);
  std::vector<Vec3d> rounded;
  if (tolerance.precision.rounds_all) {
    rounded.assign(mesh.positions.begin(), mesh.positions.end());
    const Rounding precision(tolerance.precision);
    for (Vec3d& position : rounded) position = precision(position);
    mesh.positions = rounded;
  }
  if (!goes_anywhere(farthest_of({&options.distance, 1}))) return unmoved(mesh, options);
  if (has_arcs) return offset_with_arcs(mesh, options, tolerance);
  return in_arena(options.threads, [&](int threads) { return RefinedRun(mesh, options, tolerance, threads).run(); });
}

}  // namespace vdb_offset
