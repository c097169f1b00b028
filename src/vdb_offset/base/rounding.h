// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// Rounds coordinates to what a file keeps of them.
struct Rounding : Precision {
  Rounding() = default;
  Rounding(const Precision& precision)
      : Precision(precision) {}  // NOLINT(google-explicit-constructor): no information is lost or added
  Rounding(Kind of, int significant_digits = 17) {  // NOLINT(google-explicit-constructor): a kind is a precision
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
  Vec3d operator()(const Vec3d& source, const Vec3d& position) const {
    return position == source && !rounds_all ? position : (*this)(position);
  }

  /// Whether `stored` is what is written for a vertex that has not moved from `position`.
  bool stays(const Vec3d& position, const Vec3d& stored) const {
    if (!rounds_all) return position == stored;
    if (scale != Vec3d(1.0)) return (*this)(position) == stored;
    return (*this)(position[0]) == stored[0] && (*this)(position[1]) == stored[1] && (*this)(position[2]) == stored[2];
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
