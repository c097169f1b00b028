// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <numbers>

#include "ground/numbers/double_lanes.h"

namespace vdb_offset {

/// Scaled Jacobian and aspect ratio of a cell: see cell_quality.h.
template <class Real>
struct QualityOf {
  Real jacobian, aspect;
};
using CellQuality = QualityOf<double>;

/// The square, with its sign, of the triple product of unit vectors.
/// \param triple the product of the vectors themselves
/// \param squares the product of their squared lengths; where it is 0, so is the result
template <class Real>
Real unit_square(const Real& triple, const Real& squares) {
  const Real size = greater(triple, -triple), least = Real{} + std::numeric_limits<double>::min();
  return triple * size / greater(squares, least);
}

/// Squares that a cell's quality follows from: the least square of a triple product over its corners, and the squared
/// lengths of its shortest and its longest edge.
template <class Real>
struct QualitySquares {
  Real triple, shortest, longest;
};
template <class Real>
QualityOf<Real> quality_of(const QualitySquares<Real>& squares) {
  const auto& [triple, shortest, longest] = squares;
  const Real one = Real{} + 1.0, infinite = Real{} + std::numeric_limits<double>::infinity();
  const Real jacobian = root(triple < 0 ? -triple : triple);
  return {triple < 0 ? -jacobian : jacobian, shortest > 0 ? root(longest / (shortest > 0 ? shortest : one)) : infinite};
}

/// A triangle between two prisms, or at the end of one.
template <class Real>
struct PrismLevel {
  PrismLevel() = default;
  explicit PrismLevel(const std::array<Vec3Of<Real>, 3>& corners) : corner(corners) { measure(); }
  /// Measures the corners. To be called after they have been set.
  void measure() {
    Vec3Of<Real> side[3];
    for (std::size_t k = 0; k < 3; ++k) {
      side[k] = corner[(k + 1) % 3] - corner[k];
      square[k] = side[k].dot(side[k]);
    }
    normal = side[2].cross(side[0]);
    for (std::size_t k = 0; k < 3; ++k) product[k] = square[(k + 2) % 3] * square[k];
    shortest = lesser(lesser(square[0], square[1]), square[2]);
    longest = greater(greater(square[0], square[1]), square[2]);
  }

  std::array<Vec3Of<Real>, 3> corner;
  Real square[3], product[3];  // of sides, and of the two at a corner
  Vec3Of<Real> normal;         // the cross product of the sides at each corner
  Real shortest, longest;
};

/// The squares of the prism between two triangles.
template <class Real>
QualitySquares<Real> prism_squares(const PrismLevel<Real>& below, const PrismLevel<Real>& above) {
  QualitySquares<Real> found{Real{} + std::numeric_limits<double>::infinity(), lesser(below.shortest, above.shortest),
                             greater(below.longest, above.longest)};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3Of<Real> up = above.corner[k] - below.corner[k];
    const Real square = up.dot(up);
    found.shortest = lesser(found.shortest, square);
    found.longest = greater(found.longest, square);
    for (const PrismLevel<Real>* level : {&below, &above})
      found.triple = lesser(found.triple, unit_square(level->normal.dot(up), level->product[k] * square));
  }
  return found;
}

/// The quality of a prism: its Jacobian is 1 over a regular triangle.
template <class Real>
QualityOf<Real> prism_quality_of(const QualitySquares<Real>& squares) {
  const QualityOf<Real> quality = quality_of(squares);
  return {2 / std::numbers::sqrt3 * quality.jacobian, quality.aspect};
}

}  // namespace vdb_offset
