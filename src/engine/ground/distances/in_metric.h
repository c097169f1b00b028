// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// A mesh, or curves, in the space of a metric. Refers to them.
class InMetric {
 public:
  enum class Of { Faces, Lines };
  /// \throw InvalidInput for a scale that is not above 0 and finite
  InMetric(PolygonView mesh, const Metric& metric, Of of = Of::Faces);

  PolygonView view() const {
    return metric_.even() ? file_ : PolygonView{scaled_, file_.corners, file_.face_begin, triangles_};
  }
  /// The mesh in the file's own coordinates.
  PolygonView file() const { return file_; }
  const Metric& metric() const { return metric_; }

  /// The position in the file of a vertex that has moved from `from` to `to` in this space. `file` is its position
  /// before; a coordinate along which it has not moved keeps its bits.
  Vec3d moved(const Vec3d& file, const Vec3d& from, const Vec3d& to) const {
    return metric_.even() ? to : to == from ? file : file + metric_.from(to - from);
  }

 private:
  PolygonView file_;
  Metric metric_;
  std::vector<Vec3d> scaled_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;  // faces are split as in the file
};

}  // namespace vdb_offset
