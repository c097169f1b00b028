#pragma once

#include <openvdb/tree/ValueAccessor.h>

#include "vdb_offset/field.h"
#include "vdb_offset/surface.h"

namespace vdb_offset {

/// grad phi at the voxel centres: the smooth field that says where vertices go.
///
/// Central differences, one-sided where a neighbour is missing; at spacing h they smooth over 2 h, and their
/// trilinear interpolation is Lipschitz, which keeps neighbouring paths in order where the exact gradient jumps.
struct DirectionField {
  openvdb::Vec3SGrid::Ptr gradient;
  openvdb::FloatGrid::ConstPtr phi;
  double voxel_size = 0;
  bool open_surface = false;  ///< Then phi changes sign away from the surface too, beyond its borders.
};

DirectionField make_directions(DistanceField& field, bool open_surface);

/// Samples a direction field; one per thread, as it caches the tree's nodes.
class DirectionSampler {
 public:
  explicit DirectionSampler(const DirectionField& field);

  /// Trilinear sample of grad phi at x (local frame), over those of the eight nodes that are active, for a point on
  /// side `side` (+1 outside, -1 inside) at the given distance from the surface. On open surfaces, nodes whose sign
  /// is another only because they lie beyond a border are turned round. False if no node is active.
  bool operator()(const Vec3d& x, int side, double distance, Vec3d& gradient) const;

 private:
  const DirectionField& field_;
  openvdb::Vec3SGrid::ConstAccessor gradient_;
  openvdb::FloatGrid::ConstAccessor phi_;
};

}  // namespace vdb_offset
