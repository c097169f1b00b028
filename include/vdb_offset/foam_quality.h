#pragma once

#include <cstddef>

namespace vdb_offset {

/// What is told of a mesh in OpenFOAM's terms.
struct FoamQuality {
  static constexpr double kMostDegrees = 70, kMostSkewness = 4;  ///< checkMesh warns above these.

  std::size_t wrong_faces = 0;        ///< Whose pyramid, towards a cell that has them, is not above 0.
  double non_orthogonality = 0;       ///< Degrees, most: between a face's normal and the way between cells' centres.
  double mean_non_orthogonality = 0;  ///< The angle of the mean cosine over the faces between two cells.
  double skewness = 0;  ///< Most: of the way between the centres that misses a face's centre, by the face's size there.
  std::size_t non_orthogonal_faces = 0, skew_faces = 0;  ///< Beyond the limits.
};

}  // namespace vdb_offset
