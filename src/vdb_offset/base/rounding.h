// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "vdb_offset/precision.h"

namespace vdb_offset {

/// Rounds coordinates to what a file keeps of them.
struct Rounding : Precision {
  Rounding() = default;
  Rounding(const Precision& precision) : Precision(precision) {}  // NOLINT(google-explicit-constructor): the same thing
  Rounding(Kind of, int significant_digits = 17) {                // NOLINT(google-explicit-constructor): as above
    kind = of;
    digits = significant_digits;
  }

  double operator()(double value) const {
    return kind == Kind::Double   ? value
           : kind == Kind::Single ? static_cast<double>(static_cast<float>(value))
                                  : rounded_to_digits(value);
  }
  Vec3d operator()(const Vec3d& p) const {
    if (scale == Vec3d(1.0)) return {(*this)(p[0]), (*this)(p[1]), (*this)(p[2])};
    return in_file(p) * scale;
  }

  /// The position as the file has it, without the scale.
  Vec3d in_file(const Vec3d& p) const {
    const Vec3d q = p / scale;
    return {(*this)(q[0]), (*this)(q[1]), (*this)(q[2])};
  }

  /// What is kept of the position of a vertex that was at `source` before.
  Vec3d operator()(const Vec3d& source, const Vec3d& place) const {
    return place == source && !rounds_all ? place : (*this)(place);
  }

  /// Whether `stored` is what is written for a vertex that has not moved from `place`.
  bool stays(const Vec3d& place, const Vec3d& stored) const {
    if (!rounds_all) return place == stored;
    if (scale != Vec3d(1.0)) return (*this)(place) == stored;
    return (*this)(place[0]) == stored[0] && (*this)(place[1]) == stored[1] && (*this)(place[2]) == stored[2];
  }

  /// Most that a number may change by as it is kept, relative to itself.
  double half_unit() const {
    return kind == Kind::Double ? 0x1p-53 : kind == Kind::Single ? 0x1p-24 : 5 * std::pow(10.0, -digits);
  }

  /// Most that a number may change by, relative to itself, arithmetic on the way included.
  double epsilon() const {
    return kind == Kind::Double ? 0x1p-51 : kind == Kind::Single ? 0x1p-23 : 0x1p-51 + 5 * std::pow(10.0, -digits);
  }

 private:
  double rounded_to_digits(double value) const;
};

}  // namespace vdb_offset
