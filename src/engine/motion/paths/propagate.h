// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "space/curve/curve_query.h"
#include "space/field/direction_field.h"
#include "space/query/obstacles.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/result.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// Where each vertex of a surface goes. Each vector has a value for each vertex.
struct Paths {
  std::vector<Vec3d> displacement;  ///< World units; a multiple of a power of two near 1e-11 of the distance.
  std::vector<double> achieved;     ///< Exact unsigned distance of the end point to the surface.
  std::vector<VertexState> state;
  std::vector<std::uint32_t> closest;  ///< The triangle of the surface that is closest to the end point.
  std::size_t straight = 0;            ///< Vertices of components that moved along their normals alone.
  /// Displacements from the source to the corners of each vertex's path, in order, without the end, which
  /// `displacement` leads to. Empty unless paths are kept.
  std::vector<std::vector<Vec3d>> trace;
};

/// Whether paths are kept as polylines: about ten corners of 24 bytes for each vertex.
enum class KeepPaths : bool { No, Yes };

/// Where fronts meet of a component that lies between planes at an angle. Smooth: its vertices march as those of all
/// other components, and are spread along the ridge. Sharp: they follow the ridge where the distance rises fastest, and
/// merge there.
enum class Ridges : bool { Smooth, Sharp };

struct PathOptions {
  KeepPaths keep = KeepPaths::No;
  Ridges ridges = Ridges::Smooth;
};

/// The unit direction in which a vertex leaves the source, outward: its normal, weighted by angles; where faces turn
/// away from that, a direction that more of them face. Zero for a vertex without any.
Vec3d start_direction(const Surface& surface, std::uint32_t vertex);
Vec3d start_direction(const Polyline& line, std::uint32_t vertex);
/// Whether the faces around a vertex fold so that none of the directions tried by start_direction() is one that all of
/// them face. However little such a vertex moves, a face goes to its own back, and so through the surface.
bool is_folded(const Surface& surface, std::uint32_t vertex);

/// Rounds a displacement to a multiple of a power of two near 1e-11 of the distance `target`. To round displacements,
/// not positions, makes the result independent of where the mesh stands. \pre target > 0
Vec3d round_displacement(const Vec3d& displacement, double target);

/// Makes the ends of paths corners, before anything else moves the vertices, if paths are kept.
void end_traces(Paths& paths);
/// The polyline of a vertex's path, from `start` over the corners of `trace` to `end`, both of which are displacements
/// from there. Positions that repeat are left out.
std::vector<Vec3d> positions_on_path(const Vec3d& start, std::span<const Vec3d> trace, const Vec3d& end);

/// Moves every surface vertex to its distance from the surface (Wang, Guibault, Camarero, Tchon, AIAA 2005:
/// x' = +-grad phi / |grad phi|, stop where phi reaches d or falls). `distances` are those of the surface's vertices;
/// where there are several sets of them, one march serves all that a vertex has on one side, and each set has its own
/// answer.
///
/// Where the straight paths along the normals of all vertices of a component are characteristics of the faces around
/// them, they are the exact offset: one or two exact distances for each vertex prove it, phi being 1-Lipschitz. With
/// Ridges::Sharp, the vertices of another component that lies between planes at an angle follow the ridges of those
/// (see ridge_path.h), unless there are obstacles or borders. The vertices of any other component all march by RK4
/// along the smooth directions, since neighbours of which one goes straight and one follows the field lose their order.
/// Steps are no longer than the exact distance, so that no path can cross the surface; the last step is cut where the
/// exact distance is d; where the distance falls and does not recover, the path ends at its largest distance. Where a
/// path comes as near to an obstacle as it may, it ends, too. The result does not depend on the number of threads.
std::vector<Paths> propagate(const ClosestQuery& query, const DirectionField& directions,
                             std::span<const Distances> distances, const Obstacles* obstacles = nullptr,
                             const ProgressCallback& progress = {}, const PathOptions& options = {});

/// Moves every vertex of plane curves to its distance, in directions from the field of their ribbon (see ribbon.h).
std::vector<Paths> propagate(const CurveQuery& query, const DirectionField& directions,
                             std::span<const Distances> distances, const ProgressCallback& progress = {},
                             const PathOptions& options = {});

}  // namespace vdb_offset
