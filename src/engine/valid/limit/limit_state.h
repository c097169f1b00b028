// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ground/numbers/index_set.h"
#include "valid/limit/limit.h"
#include "valid/limit/live_area.h"
#include "valid/untangle/warm_start.h"

namespace vdb_offset {

/// Displacements of all vertices, for telling later which have moved since: 12 bytes a vertex.
using Displacements = std::vector<std::array<float, 3>>;

/// The offset that limit() makes valid, as its steps change it: each vertex goes a share of a whole displacement.
///
/// The steps (PatchUntangler, pull_back(), LetOut, ReturnToFaces, Settling, Contraction) change whole displacements and
/// shares, and then move the vertices by move() or a trial of `faults`, so that `faults` always knows where the
/// vertices stand.
struct LimitState {
  /// `offset` and what it refers to must outlive this. `warm` is null without a warm start.
  LimitState(FaultFinder& fault_finder, const SurfaceOffset& offset, const WarmStart* warm);

  const ConstrainedSurface& constrained;
  const Surface& surface;
  std::span<const Vec3d> source;
  const Distances& distances;
  Paths& paths;           ///< Keeps states and displacements of the beginning; the result is written by limit().
  MiteredPaths* mitered;  ///< Null if no vertex is mitered.
  bool keeps_faces;       ///< See SurfaceOffset.
  std::uint32_t first_over_ridges;  ///< See SurfaceOffset.
  FaultFinder& faults;
  const WarmStart* started_from;  ///< Null without one.

  std::vector<Vec3d> whole;   ///< Of each vertex: the displacement that it goes a share of.
  std::vector<double> share;  ///< Of each vertex: 0 .. 1.
  Indices pulled;             ///< Vertices that have been pulled back at some time.
  LiveArea live_area;
  IndexGatherer gathered;               ///< Of vertices; empty between uses.
  std::vector<std::uint8_t> on_crease;  ///< Of each vertex; empty before find_creases().
  bool many_at_first;  ///< There were more than kManyFaults faults at the beginning, or at that of the warm start.
  LimitStatistics statistics;

  void find_creases();

  std::size_t fault_count() const { return faults.count().total(); }
  /// Whether there are so many faults that as little is tried as kManyFaults says; with a warm start, whether there
  /// were as many there.
  bool has_many_faults() const;

  /// Whether a vertex is nearer to the surface than its distance.
  bool is_short(std::uint32_t v) const {
    const double nearer = constrained.nearer.empty() ? 0 : constrained.nearer[v];
    return faults.distance_of(v) <
           (nearer > 0 ? nearer : std::abs(distances[v])) * (1 - kReachedTolerance) - faults.rounding(v);
  }
  /// Whether a vertex may slide at its distance. A collided one may slide to where there is room; a vertex that stays,
  /// or is bound to its path, may not, nor one that is mitered where faces are to be kept.
  bool may_slide(std::uint32_t v) const;

  /// Whether a vertex may be put elsewhere than on its path; not one that an obstacle may have stopped.
  bool may_leave_path(std::uint32_t v) const;

  /// Whether a vertex of the moving part has to stay in planes.
  bool is_held(std::uint32_t v) const {
    return constrained.moving_part.surface().is_held(constrained.part_vertex_of(v));
  }
  /// What of a displacement lies in the planes that a vertex has to stay in; all of it, if there are none.
  Vec3d in_planes(std::uint32_t v, const Vec3d& displacement) const {
    return is_held(v) ? constrained.moving_part.surface().along_border(constrained.part_vertex_of(v), displacement)
                      : displacement;
  }

  /// The share of a vertex's whole displacement that it goes: along the straight line, but the last tenth of it, at the
  /// surface, on a parabola that meets the surface in the vertex's start direction, as the straight line may dip
  /// through the faces around the vertex.
  Vec3d displacement_of(std::uint32_t v) const;
  /// How far the planes of the faces around a vertex are off where it stands, in distances: the mean by area. Not moved
  /// at all, the vertex would have 1.
  double off_planes(std::uint32_t v) const { return off_planes(v, displacement_of(v)); }
  /// The same with another displacement.
  double off_planes(std::uint32_t v, const Vec3d& displacement) const;
  /// World coordinates.
  Vec3d position_of(std::uint32_t v) const { return source[v] + displacement_of(v); }

  /// Gives those of some vertices that are mitered the whole displacements that they would have with round corners, and
  /// returns them: a share of a miter may end farther off than the distance, where nothing but its end may be.
  Indices take_miters_back(const Indices& vertices);

  /// Moves vertices to position_of() each, and finds the faults around them.
  void move(const Indices& vertices) {
    faults.move(vertices, [&](std::uint32_t v) { return position_of(v); });
  }

  /// Of all vertices, where they stand.
  Displacements displacements() const;
  /// The vertices that do not have these displacements, and those of so many rings around them; all vertices if there
  /// are none.
  Indices moved_since(const Displacements& before, int rings);

  /// Some vertices and those of so many rings around them.
  Indices with_rings(const Indices& vertices, int rings);

 private:
  bool has_sides(std::uint32_t v) const;
};

}  // namespace vdb_offset
