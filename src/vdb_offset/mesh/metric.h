#pragma once

#include <span>
#include <vector>

#include "vdb_offset/base/precision.h"
#include "vdb_offset/mesh/polygons.h"

namespace vdb_offset {

struct CaptureOptions;
struct CaptureResult;

/// How lengths count along the axes: distances are those of a space in which coordinates are so many times as large.
/// A ball of radius d is an ellipsoid of half axes d / scale in the file's units.
struct Metric {
  Vec3d scale{1.0};  ///< Each above 0.

  /// Half axes xy, xy and z, of one sign and not 0: distances are measured as those in the plane.
  static Metric of_half_axes(double xy, double z) { return {Vec3d(1, 1, xy / z)}; }

  bool even() const { return scale == Vec3d(1.0); }
  Vec3d to(const Vec3d& p) const { return even() ? p : p * scale; }
  Vec3d from(const Vec3d& q) const { return even() ? q : q / scale; }
};

/// A mesh, or curves, in the space of a metric. Refers to them.
class InMetric {
 public:
  /// \throw InvalidInput for a scale that is not above 0 and finite
  InMetric(PolygonView mesh, const Metric& metric);

  PolygonView view() const { return metric_.even() ? file_ : PolygonView{scaled_, file_.corners, file_.face_begin}; }
  /// As it is.
  PolygonView file() const { return file_; }
  const Metric& metric() const { return metric_; }

  /// Where something is in the file that has moved from one place to another, in this space: what has not moved along
  /// an axis keeps that coordinate's bits. `file` is where it was.
  Vec3d moved(const Vec3d& file, const Vec3d& from, const Vec3d& to) const {
    return metric_.even() ? to : to == from ? file : file + metric_.from(to - from);
  }

 private:
  PolygonView file_;
  Metric metric_;
  std::vector<Vec3d> scaled_;
};

/// capture() with distances in a metric. Validity is checked on coordinates as they will be written; distances and what
/// they tell are the metric's. \throw as capture()
CaptureResult capture_in_metric(PolygonView mesh, const CaptureOptions& options, const Metric& metric);

}  // namespace vdb_offset
