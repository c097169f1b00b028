// SPDX-License-Identifier: Apache-2.0
// Offsets a mesh whose ridges are opened (see opened_source.h). Its vertices march as those of any other, which shows
// where the ones go that are not opened. The opened mesh is then made valid like any other: for that it stands a tiny
// share of the way off the source, as faces without an area say nothing about where they are crossed. Distances are the
// same there to that share.
#include "products/arcs/offset_with_arcs.h"

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
#include "valid/proof/certified_faces.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// One call of offset_with_arcs().
class ArcRun {
 public:
  ArcRun(PolygonView mesh, const OffsetOptions& options, const Tolerance& tolerance, int threads)
      : mesh_(mesh),
        options_(options),
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
    opening.most_faces = tolerance_.limit_of_faces(mesh_.face_count());
    OpenedSource opened(prepared_, asked.moved.front(), marched.front().paths, opening);
    const std::unique_ptr<OpenedMesh> mesh = open_without_tangles(
        prepared_, opened, {&options_.distance, 1}, {.has_targets = true, .by_corner = true}, threads_, made_);
    seconds_ = prepared_.statistics().seconds;
    RefinedOffset result;
    if (mesh) result.result = offset(*mesh);
    else result.result = std::move(make_results(prepared_, asked, std::move(marched)).front());
    result.refinement = std::move(made_.refinement);
    certify_faces(asked.moved.front(), result);
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

  /// Reports what is proven of the result, against the mesh.
  void certify_faces(const Distances& distances, RefinedOffset& made) {
    OffsetResult& result = made.result;
    const std::size_t count = made_.vertex.size();
    const Rounding precision(options_.precision);
    std::vector<Vec3d> source(count), positions(count);
    std::vector<double> asked(count, 0), tolerance(count, 0);
    for (std::size_t v = 0; v < count; ++v) {
      source[v] = made.refinement.polygons.positions[v];
      positions[v] = precision(source[v], result.positions[v]);
      if (made_.vertex[v] == kNone) continue;
      asked[v] = distances[made_.vertex[v]];
      tolerance[v] = tolerance_.at(asked[v]);
    }
    for (std::size_t s = 0; s < kStageCount; ++s) result.statistics.seconds[s] += seconds_[s];
    const StageTimer timer(result.statistics.seconds, Stage::Measure);
    // What is said of the mesh is said of the one that was given, but for the numbers of vertices and faces.
    MeshFacts& facts = result.statistics.facts;
    std::map<std::size_t, std::size_t> faces = std::move(facts.faces_by_corners);
    facts = prepared_.statistics().facts;
    facts.vertices = count;
    facts.faces_by_corners = std::move(faces);
    CertifiedFaces certified = certify({prepared_.query(), prepared_.surface(), made_.triangles, source, positions,
                                        asked, tolerance, result.states, Corners::Round, true});
    certified.share = tolerance_.share;
    certified.length = tolerance_.length;
    certified.source_faces = mesh_.face_count();
    certified.source_vertices = mesh_.positions.size();
    certified.source_crossings = result.statistics.limit.source_crossings;
    result.statistics.certified = certified;
    count_states(result.states, result.statistics);
    report_share(options_.progress, Stage::Measure, 1);
  }

  PolygonView mesh_;
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
  const OffsetOptions of_call = with_call_progress(options);
  return in_arena(options.threads, [&](int threads) { return ArcRun(mesh, of_call, tolerance, threads).run(); });
}

}  // namespace vdb_offset
