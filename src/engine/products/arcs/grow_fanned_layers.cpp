// SPDX-License-Identifier: Apache-2.0
// Grows layers on a mesh whose sharp edges are opened (see opened_source.h). The march shows where vertices go that are
// not opened; then layers are grown on the opened mesh as on any other, which stands a tiny share of the way off the
// source. Heights are asked for less that share, and the wall's ends of all stacks are put back where they belong.
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ground/distances/layer_heights.h"
#include "ground/mesh/count_states.h"
#include "ground/numbers/index_set.h"
#include "ground/system/call_progress.h"
#include "products/arcs/opened_mesh.h"
#include "products/arcs/opened_source.h"
#include "products/offset/field_stage.h"
#include "products/offset/grow_layers.h"
#include "products/offset/stand_off.h"
#include "valid/faults/fault_finder.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// Rounds in which fans are closed that would be faulty. Not measured.
constexpr int kMostClosings = 8;
// How near to fans vertices go straight, in distances; and how long ridges with fans are at least, in median edges for
// each of their ends. Measured: see docs/dev/tuning.md.
constexpr double kStraightWithin = 1, kEdgesForEnd = 8;

/// Of each vertex of an opened mesh the first one on its point of the wall.
std::vector<std::uint32_t> feet_of(const OpenedSource::Faces& faces, std::size_t surface_vertices) {
  std::vector<std::uint32_t> first(surface_vertices, kNone), feet(faces.vertex.size());
  for (std::uint32_t v = 0; v < feet.size(); ++v) {
    feet[v] = v;
    if (faces.vertex[v] == kNone) continue;
    std::uint32_t& of_vertex = first[faces.vertex[v]];
    if (of_vertex == kNone) of_vertex = v;
    feet[v] = of_vertex;
  }
  return feet;
}

Opening opening_of_fans(double degrees, const OffsetOptions& options) {
  const double angle = degrees * std::numbers::pi / 180;
  Opening opening{.least_bend = angle, .step = angle, .farthest_plane = {}, .longest = options.miter_limit};
  opening.straight_within = kStraightWithin;
  opening.edges_for_end = kEdgesForEnd;
  opening.at_borders = opening.quads = true;
  if (options.corners == Corners::Miter) opening.farthest_plane = options.miter_limit;
  return opening;
}

/// The vertices of the source, sorted, whose fans have faulty faces at the ends of their paths.
Indices faulty_fans(const PreparedMesh& mesh, const PreparedMesh::Marched& marched, const Distances& outer,
                    const OpenedSource::Faces& faces) {
  const ConstrainedSurface constrained = mesh.constrained(marched, true);
  FaultFinder faults(constrained, mesh.source(), outer, mesh.options().precision, mesh.known_crossings());
  faults.move_to_ends(marched.paths);
  Indices vertices;
  faults.for_each_faulty_corner([&](std::uint32_t corner) {
    const std::uint32_t v = mesh.surface().representative[corner];
    if (v != kNone && v < faces.vertex.size() && faces.is_opened[v]) vertices.push_back(faces.vertex[v]);
  });
  sort_unique(vertices);
  return vertices;
}

/// One call of grow_fanned_layers().
class FanRun {
 public:
  /// \pre `prepared` has its field
  FanRun(PreparedMesh& prepared, std::span<const Distances> heights, CellRules rules, int threads)
      : prepared_(prepared),
        heights_(heights),
        off_source_(less_stand_off(heights)),
        rules_(rules),
        threads_(threads),
        asked_(ask_heights(prepared, heights)),
        marched_(std::move(prepared.march({&asked_.of_all.back(), 1}, Ridges::Smooth).front())) {
    prepared_.field() = {};
  }

  FannedLayers grow(double angle) {
    if (angle == 0) return grow_plain();
    OpenedSource opened(prepared_, asked_.of_all.back(), marched_.paths, opening_of_fans(angle, prepared_.options()));
    FannedLayers best = grow_on(opened);
    // Fans may have less room than what they take the place of.
    const auto try_out = [&](FannedLayers layers) {
      if (layers.layers.statistics.faces.mean < best.layers.statistics.faces.mean) best = std::move(layers);
    };
    if (!are_fans_short(opened)) return best;
    opened.close(opened.connected(short_fans_));
    try_out(grow_on(opened));
    if (are_fans_short(opened)) try_out(grow_plain());
    return best;
  }

 private:
  FannedLayers grow_plain() const { return {{}, grow_marched(prepared_, asked_, marched_, rules_)}; }

  /// Whether fans that keep less than all of their heights, and those on ridges that lead to them, are more than a few.
  bool are_fans_short(const OpenedSource& opened) const {
    // Share of all vertices. Reasoned: the faces around fewer make no difference that is worth the time.
    constexpr double kFew = 1e-3;
    return static_cast<double>(opened.connected(short_fans_).size()) >
           kFew * static_cast<double>(prepared_.surface().vertices.size());
  }

  /// Grows layers on the opened source, whose fans are closed where they would be faulty.
  FannedLayers grow_on(OpenedSource& opened) {
    short_fans_.clear();
    OpenedSource::Faces faces;
    for (int closings = 0;; ++closings) {
      const std::unique_ptr<OpenedMesh> mesh =
          open_without_tangles(prepared_, opened, off_source_,
                               {.layers = heights_.size(), .has_targets = true, .by_corner = true}, threads_, faces);
      if (!mesh) return grow_plain();
      const AskedHeights asked = ask_heights(mesh->prepared(), mesh->distances());
      PreparedMesh::Marched targets = mesh->prepared().marched_to(asked.of_all.back(), mesh->targets());
      const Indices faulty =
          closings < kMostClosings ? faulty_fans(mesh->prepared(), targets, asked.of_all.back(), faces) : Indices();
      if (!faulty.empty()) {
        opened.close(faulty);
        continue;
      }
      std::vector<std::uint32_t> feet = feet_of(faces, prepared_.surface().vertices.size());
      LayersResult layers = grow_marched(mesh->prepared(), asked, std::move(targets), rules_, feet);
      return on_source(std::move(faces), std::move(feet), std::move(layers));
    }
  }

  /// Hands out the layers of an opened mesh as those of its faces on the source.
  FannedLayers on_source(OpenedSource::Faces faces, std::vector<std::uint32_t> feet, LayersResult layers) {
    const Refinement& refinement = faces.refinement;
    layers.stacks.put_on_wall(refinement.polygons.positions);
    layers.foot = std::move(feet);
    layers.heights = copied_to(heights_, origins_of(refinement));
    const Distances& outer = layers.heights.back();
    for (std::size_t v = 0; v < layers.share.size(); ++v) {
      if (faces.is_opened[v] && layers.share[v] < 1) short_fans_.push_back(faces.vertex[v]);
      if (layers.share[v] == 0) continue;
      layers.achieved[v] += kStandOff * std::abs(outer[v]);
      layers.first_achieved[v] += kStandOff * std::abs(outer[v]);
    }
    sort_unique(short_fans_);
    OffsetStatistics& statistics = layers.statistics;
    for (std::size_t s = 0; s < kStageCount; ++s) statistics.seconds[s] += prepared_.statistics().seconds[s];
    // What is said of the mesh is said of the one that was given.
    statistics.facts = prepared_.statistics().facts;
    if (statistics.limit.source_crossings > 0 && !prepared_.surroundings())
      statistics.limit.source_crossings = CrossingFinder(prepared_.surface(), prepared_.source()).listed().count();
    return {std::move(faces.refinement), std::move(layers)};
  }

  PreparedMesh& prepared_;
  std::span<const Distances> heights_;
  std::vector<Distances> off_source_;
  CellRules rules_;
  int threads_;
  AskedHeights asked_;
  PreparedMesh::Marched marched_;
  Indices short_fans_;  // vertices of the source whose fans keep less than all of their heights
};

}  // namespace

FannedLayers grow_fanned_layers(PolygonView mesh, std::span<const Distances> heights, const OffsetOptions& options,
                                double angle, CellRules rules) {
  require_layers(mesh, heights, options);
  require_fan_angle(angle);
  const OffsetOptions of_stages = with_call_progress(options);
  FannedLayers result = in_arena(options.threads, [&](int threads) {
    const InMetric space(mesh, options.metric);
    PreparedMesh prepared(space, of_stages, threads, farthest_of(heights.last(1)), {.layers = heights.size()});
    return FanRun(prepared, heights, rules, threads).grow(angle);
  });
  // Those of the mesh's vertices, which come first; copies have the states of theirs.
  count_states(std::span(result.layers.states).first(mesh.positions.size()), result.layers.statistics);
  report_share(of_stages.progress, Stage::Measure, 1);
  return result;
}

}  // namespace vdb_offset
