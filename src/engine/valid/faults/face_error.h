// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "motion/parts/constrained_surface.h"
#include "motion/paths/own_distances.h"
#include "space/query/closest_query.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// The mean error beyond which its causes are found. Not measured.
inline constexpr double kWorthTelling = 0.01;

/// The error up to which area counts as being at the distance. Told by name.
inline constexpr double kAtDistance = 0.01;

/// Share of its distance up to which a vertex that falls short has not moved at all. Not measured: it is 0 where there
/// is no room.
inline constexpr double kStuck = 1e-3;

/// What faces are measured against.
struct MeasuredFaces {
  const ConstrainedSurface& constrained;
  std::span<const Vec3d> positions;  ///< Of the constrained surface's vertices, world coordinates.
  const Distances& distances;        ///< Of these vertices.
  /// Of the vertices in the source, world coordinates; empty where the faces are not those of the source, moved.
  std::span<const Vec3d> source;
  std::span<const VertexState> states;  ///< Of the vertices; empty: none falls short.
  const OwnDistances* own = nullptr;    ///< Of the triangles of the constrained surface, if faces have their own.
};

/// Measures how far the faces of the moving part are off their distance: at points evenly spread over the area that
/// they have in the offset, where the distance asked for is that of the corners, interpolated. A point is at its
/// distance if the moving part is as far, or where it is farther, as beside a miter, if the plane of its own face in
/// the source is. Of a triangle with a vertex at which faces have distances of their own, that plane counts alone.
/// Where nearly nothing is asked for, nothing is measured. The result does not depend on the number of threads.
FaceError measure_faces(const MeasuredFaces& faces);

/// Measures each of the input's `count` faces by itself: the mean error of a few points of it, as a share of the
/// distance that is asked there. NaN for faces that are not of the moving part, have no area or are asked to stay.
std::vector<float> measure_each_face(const MeasuredFaces& faces, std::size_t count);

/// How much of the error of a point comes of a wall or gap that has no room for the distance: how far the point would
/// be off if it were in its face's own plane at the distance, `in_plane`, where a face that looks the other way is
/// nearer. Neither a miter nor a finer mesh helps there. \param closest of `in_plane`, where the surface's pseudonormal
/// is `opposite`
double lack_of_room(const Vec3d& in_plane, const Vec3d& normal, double asked, const Closest& closest,
                    const Vec3d& opposite, double error);

/// How far a point is off its distance, relative to that.
struct PointError {
  double off = 0;      ///< Above 0: too far away. Of its face's plane, where that is less than a point is too far away.
  double farther = 0;  ///< How much farther away than that the point itself is.
};

/// \param off, off_plane how far a point, and the plane of its face, are off `wanted`, above 0: too far away
PointError point_error(double off, double off_plane, double wanted);

/// Sums up errors, each of the same share of the area or length; none: it was not measured.
FaceError sum_up_errors(std::span<const std::optional<PointError>> errors);

}  // namespace vdb_offset
