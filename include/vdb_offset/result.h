// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/statistics.h"

namespace vdb_offset {

struct DistanceField;

struct OffsetResult {
  std::vector<Vec3d> positions;     ///< One per input vertex, in the input's order.
  std::vector<VertexState> states;  ///< One per input vertex.
  std::vector<double> achieved;     ///< Exact unsigned distance to the input surface, world units.
  Distances distances;              ///< What was asked of each input vertex, in the end.
  /// Faces disagree about the outside, and some of their triangles count as turned round (see orientation.h).
  bool has_turned_faces = false;
  OffsetStatistics statistics;
  std::shared_ptr<DistanceField> field;  ///< Only with keep_field and a distance other than 0.
  /// Only with keep_paths: the positions of each input vertex on its march, from that in the source to the last; and
  /// behind these its final position, if it has been moved to keep the result valid.
  std::vector<std::vector<Vec3d>> paths;
  /// Only with keep_face_errors and a distance other than 0: of each input face the mean error of points of it, as a
  /// share of the distance asked there. NaN for faces that nothing is asked of, or that have no area.
  std::vector<float> face_errors;
  /// Only with keep_face_errors and Collision::Limit: the faults that are left, one for each input face. Empty if there
  /// are none.
  std::vector<FaceFault> face_faults;
};

}  // namespace vdb_offset
