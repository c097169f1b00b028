// SPDX-License-Identifier: Apache-2.0
// Offsets a mesh whose ridges are opened (see opened_source.h). Its vertices march as those of any other, which shows
// where the ones go that are not opened. The opened mesh is then made valid like any other: for that it stands a tiny
// share of the way off the source, as faces without an area say nothing about where they are crossed. Distances are the
// same there to that share.
#include "products/arcs/offset_with_arcs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "ground/mesh/count_states.h"
#include "ground/mesh/point_triangle.h"
#include "ground/numbers/index_set.h"
#include "ground/system/call_progress.h"
#include "ground/system/stage_timer.h"
#include "products/arcs/opened_source.h"
#include "products/offset/field_stage.h"
#include "products/offset/make_results.h"
#include "products/offset/prepared_mesh.h"
#include "products/offset/stand_off.h"
#include "valid/faults/triangle_crossings.h"
#include "valid/proof/certified_faces.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using Triangle = std::array<Vec3d, 3>;

/// Adds the point in which a side of one triangle goes through another.
void add_piercing(const Triangle& one, const Triangle& other, Vec3d& sum, int& count) {
  const Vec3d normal = (other[1] - other[0]).cross(other[2] - other[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &a = one[k], &b = one[(k + 1) % 3];
    const double from = normal.dot(a - other[0]), to = normal.dot(b - other[0]);
    if (from * to > 0 || from == to) continue;
    const Vec3d x = a + (b - a) * (from / (from - to));
    if (closest_on_triangle(x, other[0], other[1], other[2]).squared_distance > 1e-12 * normal.length()) continue;
    sum += x;
    ++count;
  }
}
/// About where two triangles meet.
Vec3d meeting_point(const Triangle& s, const Triangle& t) {
  Vec3d sum(0.0);
  int count = 0;
  add_piercing(s, t, sum, count);
  add_piercing(t, s, sum, count);
  if (count > 0) return sum / count;
  return (s[0] + s[1] + s[2] + t[0] + t[1] + t[2]) / 6.0;
}

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
    opened_.emplace(prepared_, asked.moved.front(), marched.front().paths, share(), options_.miter_limit,
                    tolerance_.limit_of_faces(mesh_.face_count()));
    made_ = opened_->faces();
    seconds_ = prepared_.statistics().seconds;
    RefinedOffset result;
    result.result =
        opened_->empty() ? std::move(make_results(prepared_, asked, std::move(marched)).front()) : offset_opened();
    result.refinement = std::move(made_.refinement);
    certify_faces(asked.moved.front(), result);
    return result;
  }

 private:
  double share() const {
    return tolerance_.share > 0 ? tolerance_.share : tolerance_.length / options_.distance.scale();
  }

  /// The opened mesh where it stands off the source, on the way to its targets.
  class OffSource {
   public:
    OffSource(const ArcRun& run, OpenedSource::Faces& faces);
    /// Vertices of the surface, sorted, whose faces meet here: their strips are in each other's way at any distance.
    Indices tangled() const;
    OffsetResult offset() { return std::move(make_results(*prepared_, *asked_, std::move(marched_)).front()); }

   private:
    void add_common(std::uint32_t s, std::uint32_t t, Indices& vertices) const;

    const OpenedSource::Faces& faces_;
    Polygons polygons_;
    OffsetOptions options_;
    std::optional<InMetric> space_;
    std::optional<PreparedMesh> prepared_;
    std::optional<AskedDistances> asked_;
    std::vector<PreparedMesh::Marched> marched_;
  };

  /// Offsets the opened mesh, with ridges left closed where their strips would be in each other's way.
  OffsetResult offset_opened() {
    for (int closings = 0;; ++closings) {
      OffSource off(*this, made_);
      const Indices tangled = closings < kMostClosings ? off.tangled() : Indices{};
      if (tangled.empty()) return off.offset();
      opened_->close(tangled);
      made_ = opened_->faces();
    }
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

  // Rounds in which ridges are closed again. Not measured: one is nearly always enough.
  static constexpr int kMostClosings = 4;

  PolygonView mesh_;
  OffsetOptions options_;
  const Tolerance& tolerance_;
  int threads_;
  InMetric space_;
  PreparedMesh prepared_;
  std::optional<OpenedSource> opened_;
  OpenedSource::Faces made_;
  std::array<double, kStageCount> seconds_{};
};

ArcRun::OffSource::OffSource(const ArcRun& run, OpenedSource::Faces& faces)
    : faces_(faces), polygons_(faces.refinement.polygons), options_(run.options_) {
  const Surface& surface = run.prepared_.surface();
  VertexTargets targets = faces.targets;
  for (std::size_t v = 0; v < polygons_.positions.size(); ++v) {
    const std::uint32_t w = faces.vertex[v];
    if (w == kNone) continue;
    const Vec3d source = run.mesh_.positions[surface.representative[w]];
    polygons_.positions[v] = stand_off(source, targets.displacement[v]);
    targets.displacement[v] = (source + targets.displacement[v]) - polygons_.positions[v];
  }
  options_.weld = {};  // by position alone: copies stand close to each other
  if (!options_.only.empty()) {
    options_.only.clear();
    for (const std::uint32_t f : faces.refinement.parent) options_.only.push_back(run.options_.only[f]);
  }
  if (!options_.distance.uniform()) {
    std::vector<double> each(run.mesh_.positions.size());
    for (std::size_t v = 0; v < each.size(); ++v) each[v] = run.options_.distance[v];
    for (const VertexOrigin& origin : faces.refinement.added) each.push_back(run.options_.distance[origin.vertex[0]]);
    options_.distance = Distances(std::move(each));
  }
  space_.emplace(polygons_.view(), options_.metric);
  prepared_.emplace(*space_, options_, run.threads_, farthest_of({&options_.distance, 1}),
                    Yield{.has_targets = true, .by_corner = true});
  asked_ = ask(*prepared_, {&options_.distance, 1});
  marched_.push_back(prepared_->marched_to(asked_->moved.front(), targets));
}

/// Adds the opened vertex that two triangles are both at, and meet beside.
void ArcRun::OffSource::add_common(std::uint32_t s, std::uint32_t t, Indices& vertices) const {
  const Surface& surface = prepared_->surface();
  const std::span<const Vec3d> positions = prepared_->source();
  const auto at = [&](std::uint32_t triangle) {
    const auto& [a, b, c] = surface.triangles[triangle];
    return std::array{positions[a], positions[b], positions[c]};
  };
  const Vec3d meeting = meeting_point(at(s), at(t));
  double nearest = std::numeric_limits<double>::infinity();
  std::uint32_t vertex = kNone;
  for (const std::uint32_t a : surface.triangles[s])
    for (const std::uint32_t b : surface.triangles[t]) {
      const std::uint32_t v = surface.representative[a], w = surface.representative[b];
      if (v == kNone || w == kNone || faces_.vertex[v] != faces_.vertex[w]) continue;
      if (!faces_.is_opened[v] && !faces_.is_opened[w]) continue;
      const double distance = (positions[a] - meeting).lengthSqr();
      if (distance < nearest) nearest = distance, vertex = faces_.vertex[v];
    }
  if (vertex != kNone) vertices.push_back(vertex);
}

Indices ArcRun::OffSource::tangled() const {
  Indices vertices;
  for (const auto& [s, t] : CrossingFinder(prepared_->surface(), prepared_->source()).listed().pairs)
    add_common(s, t, vertices);
  sort_unique(vertices);
  return vertices;
}

}  // namespace

RefinedOffset offset_with_arcs(PolygonView mesh, const OffsetOptions& options, const Tolerance& tolerance) {
  const OffsetOptions of_call = with_call_progress(options);
  return in_arena(options.threads, [&](int threads) { return ArcRun(mesh, of_call, tolerance, threads).run(); });
}

}  // namespace vdb_offset
