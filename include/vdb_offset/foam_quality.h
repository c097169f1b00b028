// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace vdb_offset {

/// The quality of a volume mesh in OpenFOAM's terms.
struct FoamQuality {
  static constexpr double kMostDegrees = 70, kMostSkewness = 4;  ///< checkMesh warns above these.

  std::size_t wrong_faces = 0;  ///< Faces whose pyramid from the centre of a cell has a volume not above 0.
  double non_orthogonality =
      0;  ///< Largest angle between a face's normal and the line between cells' centres, degrees.
  double mean_non_orthogonality = 0;  ///< The angle of the mean cosine over the faces between two cells, degrees.
  double skewness = 0;  ///< Largest distance of a face's centre from that line, as a share of the face's size there.
  std::size_t non_orthogonal_faces = 0, skew_faces = 0;  ///< Faces beyond the limits.
};

}  // namespace vdb_offset
