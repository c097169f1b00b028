// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ground/distances/mean_distances.h"
#include "motion/paths/propagate.h"
#include "products/offset/field_stage.h"
#include "space/curve/curve_line.h"
#include "space/curve/curve_query.h"
#include "space/field/field_grids.h"
#include "space/surface/surface.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Curves joined in their plane, and what a run on them will need.
struct CurvePlan {
  PlaneChains plane;
  Surface ribbon;               ///< Not placed. Empty if no point moves.
  GridPlan grid;                ///< Of the ribbon's field, then.
  OffsetStatistics statistics;  ///< Facts, threads, and the plan of the grid if any point moves.
};
/// \param farthest how far points go on each side, world units
/// \throw InvalidInput for curves that do not lie in one plane or options that cannot be used, OutOfBudget if the run
/// would not fit
CurvePlan plan_ribbon(CurvesView curves, const OffsetOptions& options, int threads, const Reach& farthest,
                      const Yield& yield);

/// The points of curves, as an InputVertices of the polyline that is offset.
struct CurvePoints {
  CurvesView curves;
  std::span<const std::uint32_t> vertex;  ///< Of each point; kNone if it is on no curve.
  const PlaneFrame& frame;
  std::span<const std::uint32_t> first =
      {};  ///< Of each vertex: its first point, which gives its place. Empty: each does.

  std::span<const Vec3d> positions() const { return curves.positions; }
  std::uint32_t shape_vertex(std::size_t p) const { return vertex[p]; }
  Vec3d start(std::size_t p) const { return curves.positions[first.empty() ? p : first[vertex[p]]]; }
  /// From the plane to space.
  Vec3d to_input(const Vec3d& displacement) const { return frame.to_space({displacement[0], displacement[1]}); }
};

/// Curves that are ready to be offset: the stages that all results of a run share, and that offset_curves() and
/// grow_curve_layers() have in common.
class PreparedCurves {
 public:
  /// Makes the field of the ribbon, and draws the line that moves half way up it. Keeps references to `curves` and
  /// `options`. \pre the plan is one for a run in which some point moves
  PreparedCurves(CurvesView curves, const OffsetOptions& options, CurvePlan plan);
  PreparedCurves(const PreparedCurves&) = delete;
  PreparedCurves& operator=(const PreparedCurves&) = delete;

  CurvesView curves() const { return curves_; }
  const OffsetOptions& options() const { return options_; }
  const PlaneChains& plane() const { return plane_; }
  const Polyline& line() const { return drawn_.line; }
  /// Where the line's vertices are in the plane.
  const std::vector<Vec2d>& source() const { return drawn_.source; }
  CurvePoints points() const { return {curves_, drawn_.vertex, plane_.frame, first_point_}; }
  const CurveQuery& query() const { return *query_; }
  DistanceField& field() { return field_; }
  /// Figures of what has been done so far, which those of each result begin with.
  const OffsetStatistics& statistics() const { return statistics_; }

  /// The mean distances of the line's vertices. `disagreeing` is set to how many points have another distance than the
  /// first point at their position.
  Distances distances_of_line(const Distances& of_points, std::size_t& disagreeing) const;
  /// Marches once for several sets of distances of the line's vertices.
  std::vector<Paths> march(std::span<const Distances> distances, Ridges ridges);
  /// Room on either side of open curves where much falls short. Paths and distances are those of the line's vertices.
  SideRoom room(const Paths& paths, const Distances& distances) const;

 private:
  bool is_open() const;

  CurvesView curves_;
  const OffsetOptions& options_;
  PlaneChains plane_;
  OffsetStatistics statistics_;
  Surface ribbon_;
  DistanceField field_;
  DrawnLine drawn_;
  std::vector<std::uint32_t> first_point_;  // of each vertex of the line: the first at its position
  std::optional<CurveQuery> query_;
};

/// \throw InvalidInput for distances that are not one for each point
void require_one_for_each_point(CurvesView curves, std::span<const Distances> distances);

}  // namespace vdb_offset
