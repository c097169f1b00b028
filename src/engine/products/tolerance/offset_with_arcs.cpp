// SPDX-License-Identifier: Apache-2.0
// Offsets a mesh whose ridges are opened (see opened_source.h). Its vertices march as those of any other, which shows
// where the ones go that are not opened. The opened mesh is then made valid like any other: for that it stands a tiny
// share of the way off the source, as faces without an area say nothing about where they are crossed. Distances are the
// same there to that share. Then its faces are split like those of any other.
#include "products/tolerance/offset_with_arcs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "ground/mesh/count_states.h"
#include "ground/system/call_progress.h"
#include "ground/system/stage_timer.h"
#include "products/arcs/opened_mesh.h"
#include "products/arcs/opened_source.h"
#include "products/offset/field_stage.h"
#include "products/offset/make_results.h"
#include "products/offset/prepared_mesh.h"
#include "products/tolerance/split_faces.h"
#include "valid/proof/certified_faces.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// The refinement of a source, from that of its opened mesh, which stands off it. \param precision of the vertices that
/// splits added
Refinement on_source(Refinement opened, Refinement split, const Rounding& precision) {
  const std::vector<std::uint32_t> origins = origins_of(opened);
  std::vector<Vec3d> positions = std::move(opened.polygons.positions);
  std::vector<VertexOrigin> added = std::move(opened.added);
  added.reserve(added.size() + split.added.size());
  for (VertexOrigin& origin : split.added) {
    Vec3d position(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      position += positions[origin.vertex[k]] * origin.share[k];
      origin.vertex[k] = origins[origin.vertex[k]];
    }
    origin.face = opened.parent[origin.face];
    positions.push_back(precision(position));
    added.push_back(origin);
  }
  const auto pieces_from = [&](std::size_t face) {
    return static_cast<std::size_t>(split.parent.end() -
                                    std::lower_bound(split.parent.begin(), split.parent.end(), face));
  };
  split.over_ridges = pieces_from(opened.faces_in_place());
  split.over_corners = pieces_from(opened.parent.size() - opened.over_corners);
  for (std::uint32_t& parent : split.parent) parent = opened.parent[parent];
  split.polygons.positions = std::move(positions);
  split.added = std::move(added);
  return split;
}

/// One call of offset_with_arcs().
class ArcRun {
 public:
  ArcRun(PolygonView mesh, const OffsetOptions& options, const Tolerance& tolerance, int threads)
      : mesh_(mesh),
        progress_(options.progress),
        options_(of_opening(options, tolerance)),
        tolerance_(tolerance),
        threads_(threads),
        space_(mesh, options_.metric),
        prepared_(space_, options_, threads, farthest_of({&options_.distance, 1}), {.by_corner = true}) {}

  RefinedOffset run() {
    const AskedDistances asked = ask(prepared_, {&options_.distance, 1});
    std::vector<PreparedMesh::Marched> marched = prepared_.march(asked.moved, ridges_of(options_));
    prepared_.field() = {};
    Opening opening = opening_within(share());
    opening.longest = options_.miter_limit;
    opening.at_borders = true;
    opening.most_faces = tolerance_.limit_of_faces(mesh_.face_count());
    OpenedSource opened(prepared_, asked.moved.front(), marched.front().paths, opening);
    const std::unique_ptr<OpenedMesh> mesh = open_without_tangles(
        prepared_, opened, {&options_.distance, 1}, {.has_targets = true, .by_corner = true}, threads_, made_);
    seconds_ = prepared_.statistics().seconds;
    OffsetResult coarse = mesh ? offset(*mesh) : std::move(make_results(prepared_, asked, std::move(marched)).front());
    RefinedOffset result = tolerance_.ridges_only ? certified(asked.moved.front(), std::move(coarse))
                                                  : split(mesh ? mesh->prepared() : prepared_, coarse);
    report_of_source(result);
    return result;
  }

 private:
  double share() const {
    return tolerance_.share > 0 ? tolerance_.share : tolerance_.length / options_.distance.scale();
  }

  static OffsetResult offset(OpenedMesh& mesh) {
    const AskedDistances asked = ask(mesh.prepared(), mesh.distances());
    std::vector<PreparedMesh::Marched> marched;
    marched.push_back(mesh.prepared().marched_to(asked.moved.front(), mesh.targets()));
    return std::move(make_results(mesh.prepared(), asked, std::move(marched)).front());
  }

  /// Splits the faces of the opened mesh, or of the source if no ridge is opened.
  RefinedOffset split(const PreparedMesh& opened, const OffsetResult& coarse) {
    Tolerance off_source = tolerance_;
    off_source.precision = {};  // vertices stand off the source by less than what files keep of coordinates
    RefinedOffset result = split_faces(opened, coarse,
                                       {.tolerance = off_source,
                                        .most_faces = tolerance_.limit_of_faces(mesh_.face_count()),
                                        .threads = threads_,
                                        .progress = part_of(progress_, kCoarseShare, 1),
                                        .before_arcs = static_cast<std::uint32_t>(made_.refinement.faces_in_place())});
    result.refinement =
        on_source(std::move(made_.refinement), std::move(result.refinement), Rounding(tolerance_.precision));
    return result;
  }

  /// The opened mesh as it is, with what is proven of it against the source.
  RefinedOffset certified(const Distances& distances, OffsetResult result) {
    const StageTimer timer(result.statistics.seconds, Stage::Measure);
    const std::size_t count = made_.vertex.size();
    const Rounding precision(options_.precision);
    const std::vector<Vec3d>& source = made_.refinement.polygons.positions;
    std::vector<Vec3d> positions(count);
    std::vector<double> asked(count, 0), tolerance(count, 0);
    for (std::size_t v = 0; v < count; ++v) {
      positions[v] = precision(source[v], result.positions[v]);
      if (made_.vertex[v] == kNone) continue;
      asked[v] = distances[made_.vertex[v]];
      tolerance[v] = tolerance_.at(asked[v]);
    }
    CertifiedFaces certified = certify({prepared_.query(), prepared_.surface(), made_.triangles, source, positions,
                                        asked, tolerance, result.states, Corners::Round, true});
    certified.share = tolerance_.share;
    certified.length = tolerance_.length;
    certified.source_crossings = result.statistics.limit.source_crossings;
    result.statistics.certified = certified;
    count_states(result.states, result.statistics);
    report_share(options_.progress, Stage::Measure, 1);
    return {std::move(made_.refinement), std::move(result)};
  }

  /// Has the statistics say of the mesh what is so of the one that was given, but for the numbers of vertices and
  /// faces.
  void report_of_source(RefinedOffset& made) const {
    OffsetStatistics& statistics = made.result.statistics;
    for (std::size_t s = 0; s < kStageCount; ++s) statistics.seconds[s] += seconds_[s];
    MeshFacts& facts = statistics.facts;
    std::map<std::size_t, std::size_t> faces = std::move(facts.faces_by_corners);
    facts = prepared_.statistics().facts;
    facts.vertices = made.refinement.polygons.positions.size();
    facts.faces_by_corners = std::move(faces);
    statistics.certified->source_faces = mesh_.face_count();
    statistics.certified->source_vertices = mesh_.positions.size();
  }

  /// The options of what comes before faces are split.
  static OffsetOptions of_opening(OffsetOptions options, const Tolerance& tolerance) {
    if (!tolerance.ridges_only) options.progress = part_of(options.progress, 0, kCoarseShare);
    return with_call_progress(options);
  }

  PolygonView mesh_;
  ProgressCallback progress_;  // of the whole call; that of what comes before faces are split is in options_
  OffsetOptions options_;
  const Tolerance& tolerance_;
  int threads_;
  InMetric space_;
  PreparedMesh prepared_;
  OpenedSource::Faces made_;
  std::array<double, kStageCount> seconds_{};
};

}  // namespace

RefinedOffset offset_with_arcs(PolygonView mesh, const OffsetOptions& options, const Tolerance& tolerance) {
  return in_arena(options.threads, [&](int threads) { return ArcRun(mesh, options, tolerance, threads).run(); });
}

}  // namespace vdb_offset
