// SPDX-License-Identifier: Apache-2.0
// Grows layers on one period of a shape: on the mesh with copies of it on both sides, of which the mesh's own are
// taken. Where layers have been thinned, and more on one border than on the other, they are grown again to the lesser
// of both heights; to less where they stand elsewhere. What rounding leaves between both borders is mended by copying
// one to the other.
#include <algorithm>
#include <cmath>

#include "ground/distances/layer_heights.h"
#include "ground/mesh/count_states.h"
#include "ground/system/parallel.h"
#include "products/periodic/repeated_mesh.h"
#include "space/surface/surface.h"
#include "vdb_offset/layers.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

// How far beyond the borders layers feel what is there, in thicknesses: one for what is nearest, two for neighbours
// that are thinned with each other. Not measured beside other numbers.
constexpr double kReach = 4;
// Shares of heights that differ by less are one.
constexpr double kSameShare = 1e-6;
// How far apart the layers of a pair may be for one to take the other's, by their thickness: over sharp edges, where
// vertices may go in many directions, rounding alone makes some percent. Beyond that, cells would not be what they were
// judged as. Not measured.
constexpr double kMostApart = 0.05;
// The share that such pairs keep from one round to the next, and the number of rounds, of which the last takes all.
constexpr double kKeptOfApart = 0.65;
constexpr int kMostLessenings = 6;

class PeriodicGrowth {
 public:
  PeriodicGrowth(PolygonView mesh, std::span<const Distances> heights, const OffsetOptions& options,
                 const PeriodicMotion& motion, CellRules rules)
      : mesh_(mesh),
        heights_(heights),
        pairs_(find_periodic_pairs(mesh, motion)),
        repeated_(mesh, pairs_, kReach * heights.back().scale()),
        options_(options),
        rules_(rules) {
    options_.exact = nullptr;  // it has one period alone
    for (std::size_t copy = 1; copy < repeated_.copies(); ++copy)
      options_.only.insert(options_.only.end(), options.only.begin(), options.only.end());
  }

  LayersResult run() {
    std::vector<double> kept(mesh_.positions.size(), 1);
    LayersResult grown = grow(kept);
    for (int round = 1; round <= kMostLessenings && lessen(grown, round == kMostLessenings, kept); ++round)
      grown = grow(kept);
    take_own(grown);
    copy_borders(grown);
    grown.statistics.vertices_by_state = {};
    count_states(grown.states, grown.statistics);
    tell_of_mesh(grown);
    pairs_.facts.copies = repeated_.copies();
    grown.periodic = std::move(pairs_);
    return grown;
  }

 private:
  /// Grows layers to a share of the heights of each vertex of the mesh, which is counted in theirs.
  LayersResult grow(const std::vector<double>& kept) const {
    std::vector<Distances> lesser;
    const bool is_whole = std::ranges::all_of(kept, [](double share) { return share == 1; });
    for (const Distances& each : heights_) {
      std::vector<double> of_vertices(is_whole ? 0 : kept.size());
      for (std::size_t v = 0; v < of_vertices.size(); ++v) of_vertices[v] = each[v] * kept[v];
      lesser.push_back(is_whole ? each : Distances(std::move(of_vertices)));
    }
    LayersResult grown = grow_layers(repeated_.view(), copied_to(lesser, repeated_.origin()), options_, rules_);
    for (Index v = 0; v < kept.size(); ++v) {
      grown.share[v] *= kept[v];
      if (kept[v] < 1 && !falls_short(grown.states[v]) && grown.states[v] != VertexState::Unused)
        grown.states[v] = VertexState::Limited;
    }
    return grown;
  }

  /// Lessens what vertices keep where layers of a pair differ: to the lesser share of both, and where they stand
  /// elsewhere to less than that, at last to nothing. Returns false if all agree.
  bool lessen(const LayersResult& grown, bool is_last, std::vector<double>& kept) const {
    bool any = false;
    std::vector<double> lesser(grown.share.begin(), grown.share.begin() + static_cast<std::ptrdiff_t>(kept.size()));
    for (Index v = 0; v < kept.size(); ++v) {
      const Index w = pairs_.image[v];
      if (w == kNone || w == v) continue;
      const double least = std::min(grown.share[v], grown.share[w]);
      const bool is_apart = apart(grown, v, w) > kMostApart;
      if (!is_apart && std::abs(grown.share[v] - grown.share[w]) <= kSameShare) continue;
      any = true;
      for (const Index each : {v, w})
        lesser[each] = std::min(lesser[each], is_apart ? least * (is_last ? 0 : kKeptOfApart) : least);
    }
    if (!any) return false;
    for (Index v = 0; v < kept.size(); ++v)
      if (const Index first = grown.welded_to[v]; first != kNone) lesser[first] = std::min(lesser[first], lesser[v]);
    for (Index v = 0; v < kept.size(); ++v)
      kept[v] = grown.welded_to[v] == kNone ? lesser[v] : lesser[grown.welded_to[v]];
    return true;
  }

  /// How far the motion takes a vertex's outermost layer from that of its image, by its thickness.
  double apart(const LayersResult& grown, Index v, Index w) const {
    const auto from = grown.stacks.of(v), to = grown.stacks.of(w);
    const double thickness = (from.back() - from.front()).length();
    return thickness > 0 ? (pairs_.motion(from.back()) - to.back()).length() / thickness : 0;
  }

  /// What is said of the mesh and of planes of its borders is said of the one that was given, and not of its copies.
  void tell_of_mesh(LayersResult& grown) const {
    grown.statistics.facts = build_surface(mesh_, options_.weld, options_.orient).facts;
    const double tolerance = kOffPeriod * used_diagonal(mesh_);
    const auto is_on = [&](const SymmetryPlane& plane, Index v) {
      return grown.welded_to[v] == v && pairs_.image[v] != v && std::abs(plane.height(mesh_.positions[v])) <= tolerance;
    };
    const auto has_none = [&](const SymmetryPlane& plane) {
      for (Index v = 0; v < mesh_.positions.size(); ++v)
        if (is_on(plane, v)) return false;
      return true;
    };
    BorderFacts& borders = grown.statistics.borders;
    std::erase_if(borders.planes, has_none);
    std::erase_if(borders.left, [&](const BorderFacts::LeftPlane& left) { return has_none(left.plane); });
    borders.held_vertices = 0;
    for (Index v = 0; v < mesh_.positions.size(); ++v)
      borders.held_vertices +=
          std::ranges::any_of(borders.planes, [&](const SymmetryPlane& plane) { return is_on(plane, v); });
  }

  /// Leaves what is of the mesh itself.
  void take_own(LayersResult& grown) const {
    const std::size_t count = mesh_.positions.size();
    VertexStacks own(count, heights_.size());
    std::vector<Index> stack(count);
    for (Index v = 0; v < count; ++v) {
      std::ranges::copy(grown.stacks.of(v), own.of(v).begin());
      stack[v] = v;
    }
    grown.stacks = SharedStacks(std::move(own), std::move(stack));
    grown.welded_to.resize(count);
    grown.share.resize(count);
    grown.states.resize(count);
    grown.achieved.resize(count);
    grown.first_achieved.resize(count);
    if (!grown.carries.empty()) grown.carries.resize(mesh_.face_count());
    grown.known.paired = false;  // the mesh has borders
    grown.heights.assign(heights_.begin(), heights_.end());
    LayerStatistics& layers = grown.layer_statistics;
    layers.thinned_vertices = layers.flat_vertices = 0;
    for (Index v = 0; v < count; ++v) {
      if (grown.welded_to[v] != v) continue;
      layers.thinned_vertices += grown.share[v] < 1;
      layers.flat_vertices += grown.share[v] == 0;
    }
  }

  /// Gives the vertices that are images of others the layers of these.
  void copy_borders(LayersResult& grown) {
    std::vector<Index> from(mesh_.positions.size(), kNone);  // of each first vertex at a position
    for (Index v = 0; v < from.size(); ++v) {
      Index& image = pairs_.image[v];
      if (image == kNone) continue;
      image = grown.welded_to[image];
      if (image != grown.welded_to[v]) from[image] = grown.welded_to[v];
    }
    VertexStacks own(from.size(), heights_.size());
    std::vector<Index> stack(from.size());
    for (Index v = 0; v < from.size(); ++v) {
      stack[v] = v;
      const auto had = grown.stacks.of(v);
      const auto to = own.of(v);
      std::ranges::copy(had, to.begin());
      const Index source = grown.welded_to[v] == kNone ? kNone : from[grown.welded_to[v]];
      if (source == kNone) continue;
      const auto other = grown.stacks.of(source);
      const double thickness = (other.back() - other.front()).length();
      for (std::size_t k = 1; k < to.size(); ++k) {
        to[k] = grown.stacks.is_flat(source) ? to[0] : pairs_.motion(other[k]);
        if (thickness > 0) pairs_.facts.apart = std::max(pairs_.facts.apart, (to[k] - had[k]).length() / thickness);
      }
      grown.share[v] = grown.share[source];
      grown.states[v] = grown.states[source];
      grown.achieved[v] = grown.achieved[source];
      grown.first_achieved[v] = grown.first_achieved[source];
    }
    grown.stacks = SharedStacks(std::move(own), std::move(stack));
  }

  PolygonView mesh_;
  std::span<const Distances> heights_;
  PeriodicPairs pairs_;
  RepeatedMesh repeated_;
  OffsetOptions options_;
  CellRules rules_;
};

}  // namespace

LayersResult grow_periodic_layers(PolygonView mesh, std::span<const Distances> heights, const OffsetOptions& options,
                                  const PeriodicMotion& motion, CellRules rules) {
  require_heights(heights, mesh.positions.size());
  return PeriodicGrowth(mesh, heights, options, motion, rules).run();
}

}  // namespace vdb_offset
