// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <iterator>
#include <numbers>

#include "products/volume/prism_quality.h"
#include "products/volume/prism_quality_columns.h"

namespace vdb_offset {

/// The angle in degrees between the first of two perpendicular vectors and their sum, from their lengths, both at least
/// 0: 90 if the first is 0. By a polynomial with a relative error of at most 7e-11, far below what a float can resolve.
template <class Real>
Real degrees_between(const Real& along, const Real& across) {
  // Coefficients of atan(x) / x in x^2, interpolated at the Chebyshev points of 0 .. 1.
  constexpr double kArctangent[] = {0.9999999999293041,    -0.333333312908918,   0.19999901102188253,
                                    -0.14283813255520292,  0.11091922959166298,  -0.0897417192738338,
                                    0.07228278231631463,   -0.05395667806911865, 0.03382621554931744,
                                    -0.015828319941195535, 0.004732482904244949, -0.000663395204223815};
  const Real zero{}, one = zero + 1.0;
  const Real longer = greater(along, across), ratio = lesser(along, across) / (longer > 0 ? longer : one);
  Real sum{};
  for (std::size_t k = std::size(kArctangent); k-- > 0;) sum = sum * (ratio * ratio) + kArctangent[k];
  const Real degrees = sum * ratio * (180 / std::numbers::pi), right = zero + 90.0;
  return along > 0 ? (across > along ? right - degrees : degrees) : right;
}

/// measure_prism_columns() for as many columns as Real has lanes, from column `first` on.
template <class Real>
class PrismLanes {
 public:
  PrismLanes(const PrismQualityColumns& columns, std::size_t first) : columns_(columns), first_(first) {
    const double* origin[kLanes];
    for (std::size_t lane = 0; lane < kLanes; ++lane) origin[lane] = columns.origin;
    origin_ = gather(origin, 0);
  }

  void measure(double* six_volumes) {
    // The levels above and below swap roles instead of being copied, as they are large.
    look_at(0, levels_[0]);
    for (std::size_t layer = 0; layer < columns_.layers; ++layer) {
      PrismLevel<Real>&above = levels_[(layer + 1) % 2], &below = levels_[layer % 2];
      look_at(layer + 1, above);
      if (layer == 0) measure_wall(below, above);
      const QualityOf<Real> quality = prism_quality_of(prism_squares(below, above));
      const std::size_t at = layer * columns_.in_layer;
      put(quality.jacobian, columns_.scaled_jacobian + at);
      put(quality.aspect, columns_.aspect_ratio + at);
    }
    const PrismLevel<Real>& last = levels_[columns_.layers % 2];
    const Real sum = six_volumes_ + last.normal.dot(last.corner[0] - origin_);
    for (std::size_t lane = 0; lane < kLanes; ++lane) six_volumes[first_ + lane] = sum[lane];
  }

 private:
  static constexpr std::size_t kLanes = sizeof(Real) / sizeof(double);

  static Vec3Of<Real> gather(const double* const* stacks, std::size_t layer) {
    Vec3Of<Real> position;
    for (std::size_t lane = 0; lane < kLanes; ++lane) position.set(lane, stacks[lane] + 3 * layer);
    return position;
  }
  void look_at(std::size_t layer, PrismLevel<Real>& level) const {
    for (std::size_t k = 0; k < 3; ++k) level.corner[k] = gather(columns_.stack[k] + first_, layer);
    level.measure();
  }
  void put(const Real& values, float* to) const { store_floats(values, to + first_); }

  void measure_wall(const PrismLevel<Real>& wall, const PrismLevel<Real>& above) {
    six_volumes_ = wall.normal.dot(origin_ - wall.corner[0]);
    Vec3Of<Real> rise = above.corner[0] - wall.corner[0];
    for (std::size_t k = 1; k < 3; ++k) rise = rise + (above.corner[k] - wall.corner[k]);
    const Real along = wall.normal.dot(rise);
    const Vec3Of<Real> across = wall.normal.cross(rise);
    put(degrees_between(greater(along, -along), root(across.dot(across))), columns_.wall_angle);
  }

  const PrismQualityColumns& columns_;
  std::size_t first_;
  Vec3Of<Real> origin_;
  Real six_volumes_;
  PrismLevel<Real> levels_[2];
};

}  // namespace vdb_offset
