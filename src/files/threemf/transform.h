// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// Where an object is placed: a row of coordinates times three rows, plus a fourth (3MF core specification, 3.3).
struct ThreeMfTransform {
  std::array<Vec3d, 4> row{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1), Vec3d(0, 0, 0)};

  bool is_identity() const { return row == ThreeMfTransform().row; }
  /// Keeps the bits of a point that is left where it is.
  Vec3d operator()(const Vec3d& p) const { return is_identity() ? p : linear(p) + row[3]; }
  double determinant() const { return row[0].dot(row[1].cross(row[2])); }
  /// Whether there is a way back.
  bool is_regular() const;
  /// This one, and then that.
  ThreeMfTransform then(const ThreeMfTransform& next) const;
  /// The point that is brought to `p`, as near as coordinates can be: of a transform that only moves or turns by
  /// right angles mostly to the last bit.
  Vec3d source_of(const Vec3d& p) const;

 private:
  Vec3d linear(const Vec3d& p) const { return p[0] * row[0] + p[1] * row[1] + p[2] * row[2]; }
};

}  // namespace vdb_offset::io
