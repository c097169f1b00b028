// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/api.h"
#include "vdb_offset/vec.h"

namespace vdb_offset {

/// How lengths count along the axes: distances are those of a space in which coordinates are so many times as large.
/// A ball of radius d is an ellipsoid of half axes d / scale in the file's units.
struct VDB_OFFSET_API Metric {
  Vec3d scale{1.0};  ///< Each above 0.

  /// Half axes xy, xy and z, of one sign and not 0: distances are measured as those in the plane.
  static Metric of_half_axes(double xy, double z);

  bool even() const;
  /// From a position in the file to the metric's space, and back.
  Vec3d to(const Vec3d& p) const;
  Vec3d from(const Vec3d& q) const;
};

}  // namespace vdb_offset
