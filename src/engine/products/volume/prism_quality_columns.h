// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace vdb_offset {

/// Four columns of prisms, one in each layer, whose cells in a layer have consecutive numbers.
struct PrismQualityColumns {
  static constexpr std::size_t kCount = 4;

  /// Of each corner of each column: x, y and z of its positions, from the wall outward.
  const double* stack[3][kCount];
  std::size_t layers, in_layer;
  /// Results of the first column's lowest cell; those of the next layer lie `in_layer` numbers further.
  float *scaled_jacobian, *aspect_ratio;
  float* wall_angle;  ///< Result of the first column.
  const double* origin;
};

using SixVolumes = std::array<double, PrismQualityColumns::kCount>;

/// Measures the quality of four columns (see cell_quality.h), and of each six times the volume between the origin and
/// its lowest and its uppermost triangle. All four columns at once where the machine has registers for that, else two
/// by two, with the same result to the last bit.
SixVolumes measure_prism_columns(const PrismQualityColumns& columns);
/// measure_prism_columns() two by two.
SixVolumes measure_prism_pairs(const PrismQualityColumns& columns);
/// measure_prism_columns() with all four at once. \pre the machine has AVX2
SixVolumes measure_prism_quads(const PrismQualityColumns& columns);

}  // namespace vdb_offset
