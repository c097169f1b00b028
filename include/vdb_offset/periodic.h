// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// A motion after which a shape is itself again, as a wheel is after a turn by one of its blades: a turn about an axis,
/// or a shift.
struct VDB_OFFSET_API PeriodicMotion {
  Vec3d axis{0.0};   ///< Any length; not used without a turn.
  Vec3d point{0.0};  ///< On the axis.
  double angle = 0;  ///< Degrees, right-handed about the axis; 0: there is no turn.
  Vec3d shift{0.0};  ///< World units; not used with a turn.

  /// The motion of a position, and that of a vector.
  Vec3d operator()(const Vec3d& x) const;
  Vec3d turned(const Vec3d& way) const;
  /// So many of it, one after the other; below 0 the other way.
  PeriodicMotion times(double count) const;
};

/// How far the motion may put a vertex from its image, by the mesh's diagonal: files keep seven digits. Not measured.
inline constexpr double kOffPeriod = 1e-5;

/// What was found of periodic borders.
struct PeriodicFacts {
  std::size_t pairs = 0;   ///< Positions that have another one for their image.
  std::size_t copies = 0;  ///< Of the mesh that layers were grown on, with the mesh itself.
  double apart = 0;  ///< The most by which layers of pairs differed before one took the other's, by their thickness.
};

/// What a motion makes of the borders of a mesh that is one period of a shape.
struct PeriodicPairs {
  PeriodicMotion motion;
  /// Of each vertex: the first one at the position that the motion takes it to, if both are on borders; else kNone.
  /// Vertices on the axis are their own.
  std::vector<std::uint32_t> image;
  PeriodicFacts facts;
};

/// Finds the pairs of a mesh's borders.
/// \throw InvalidInput for a motion that is none, and where no edge of a border becomes another one of these
VDB_OFFSET_API PeriodicPairs find_periodic_pairs(PolygonView mesh, const PeriodicMotion& motion);

/// A turn about an axis of coordinates, through the origin and by less than half of a circle, that makes one piece of a
/// mesh's border another one: the mesh may be one period of a shape. Pieces that both lie in planes across axes, as
/// those of a quarter of a body, do not count: these are more likely planes of symmetry. \throw InvalidInput for what
/// is no mesh
VDB_OFFSET_API std::optional<PeriodicMotion> likely_turn(PolygonView mesh);

}  // namespace vdb_offset
