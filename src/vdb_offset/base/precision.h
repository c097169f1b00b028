#pragma once

#include <cmath>

#include "vdb_offset/mesh/polygons.h"

namespace vdb_offset {

/// What a file keeps of a coordinate. Validity is judged on what is kept.
struct Precision {
  enum class Kind { Double, Single, Digits };

  Kind kind = Kind::Double;
  int digits = 17;  ///< Significant decimal digits; for Kind::Digits, 1 .. 17.
  /// Places are so many times as large as the file has them.
  Vec3d scale{1.0};
  /// What has not moved is written anew as well, as in a file of another format; else it keeps its bytes.
  bool rounds_all = false;

  double operator()(double value) const {
    return kind == Kind::Double   ? value
           : kind == Kind::Single ? static_cast<double>(static_cast<float>(value))
                                  : rounded_to_digits(value);
  }
  Vec3d operator()(const Vec3d& p) const {
    if (scale == Vec3d(1.0)) return {(*this)(p[0]), (*this)(p[1]), (*this)(p[2])};
    return in_file(p) * scale;
  }

  /// What the file has of a place, without the scale.
  Vec3d in_file(const Vec3d& p) const {
    const Vec3d q = p / scale;
    return {(*this)(q[0]), (*this)(q[1]), (*this)(q[2])};
  }

  /// What is kept of a place that something has gone to from `source`.
  Vec3d operator()(const Vec3d& source, const Vec3d& place) const {
    return place == source && !rounds_all ? place : (*this)(place);
  }

  /// Whether `stored` is what is written of a place that has not moved.
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
