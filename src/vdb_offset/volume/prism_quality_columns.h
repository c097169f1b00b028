#pragma once

#include <array>
#include <cstddef>

namespace vdb_offset {

/// Four columns of prisms, one in each layer, whose cells in a layer have numbers that follow each other.
struct PrismQualityColumns {
  static constexpr std::size_t kCount = 4;

  /// Of each corner of each column the x, y and z of its places, one after another from the wall outward.
  const double* stack[3][kCount];
  std::size_t layers, in_layer;
  /// Of the first column's lowest cell; those of a layer further out lie `in_layer` further on.
  float *scaled_jacobian, *aspect_ratio;
  float* wall_angle;  // of the first column
  const double* origin;
};

using SixVolumes = std::array<double, PrismQualityColumns::kCount>;

/// Finds those columns' quality (see cell_quality.h), and six times the volume of each that lies below its lowest and
/// its uppermost triangle as seen from the origin: all four at once where the machine has registers for that, else by
/// pairs, with the same result to the last bit.
SixVolumes measure_prism_columns(const PrismQualityColumns& columns);
SixVolumes measure_prism_pairs(const PrismQualityColumns& columns);
SixVolumes measure_prism_quads(const PrismQualityColumns& columns);  ///< \pre the machine has AVX2

}  // namespace vdb_offset
