// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/mesh/in_metric.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/error.h"

namespace vdb_offset {

Metric Metric::of_half_axes(double xy, double z) { return {Vec3d(1, 1, xy / z)}; }

bool Metric::even() const { return scale == Vec3d(1.0); }

Vec3d Metric::to(const Vec3d& p) const { return even() ? p : p * scale; }

Vec3d Metric::from(const Vec3d& q) const { return even() ? q : q / scale; }

InMetric::InMetric(PolygonView mesh, const Metric& metric) : file_(mesh), metric_(metric) {
  for (int k = 0; k < 3; ++k)
    if (!(metric.scale[k] > 0) || !std::isfinite(metric.scale[k]))
      throw InvalidInput("metric: expected scales above 0, got " + std::to_string(metric.scale[k]));
  if (metric.even()) return;
  scaled_.resize(mesh.positions.size());
  for_each_index(scaled_.size(), [&](std::size_t v) { scaled_[v] = metric.to(mesh.positions[v]); });
}

}  // namespace vdb_offset
