// SPDX-License-Identifier: Apache-2.0
#include "ground/distances/in_metric.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "ground/system/parallel.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

namespace {

/// Whether a mesh has a triangle for each corner of its faces but two. What has not is refused by those who use it.
bool can_be_split(PolygonView mesh) {
  if (mesh.face_begin.empty() || mesh.face_begin.back() != mesh.corners.size()) return false;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.face_begin[f + 1] < mesh.face_begin[f] + 3) return false;
  return std::all_of(mesh.corners.begin(), mesh.corners.end(),
                     [&](std::uint32_t v) { return v < mesh.positions.size() && mesh.positions[v].isFinite(); });
}

}  // namespace

Metric Metric::of_half_axes(double xy, double z) { return {Vec3d(1, 1, xy / z)}; }

bool Metric::even() const { return scale == Vec3d(1.0); }

Vec3d Metric::to(const Vec3d& p) const { return even() ? p : p * scale; }

Vec3d Metric::from(const Vec3d& q) const { return even() ? q : q / scale; }

InMetric::InMetric(PolygonView mesh, const Metric& metric, Of of) : file_(mesh), metric_(metric) {
  for (int k = 0; k < 3; ++k)
    if (!(metric.scale[k] > 0) || !std::isfinite(metric.scale[k]))
      throw InvalidInput("metric: expected scales above 0, got " + std::to_string(metric.scale[k]));
  if (metric.even()) return;
  if (of == Of::Faces && can_be_split(mesh)) triangles_ = split_polygons(mesh);
  scaled_.resize(mesh.positions.size());
  for_each_index(scaled_.size(), [&](std::size_t v) { scaled_[v] = metric.to(mesh.positions[v]); });
}

}  // namespace vdb_offset
