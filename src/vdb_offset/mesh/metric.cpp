#include "vdb_offset/mesh/metric.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "vdb_offset/base/error.h"
#include "vdb_offset/base/parallel.h"
#include "vdb_offset/iso/iso_surface.h"

namespace vdb_offset {
namespace {

/// The source as it is in the file, its triangles in the same order: all of it, for what comes along from there.
std::shared_ptr<const CaptureSource> unscaled(const Surface& scaled, const Metric& metric, Orient orient) {
  Surface surface = scaled;
  for (Vec3d& v : surface.vertices) v = metric.from(v + scaled.origin);
  place_in_frame(surface, metric.from(scaled.origin));
  return std::make_shared<const CaptureSource>(std::move(surface), std::nullopt, 0.0, orient);
}

}  // namespace

InMetric::InMetric(PolygonView mesh, const Metric& metric) : file_(mesh), metric_(metric) {
  for (int k = 0; k < 3; ++k)
    if (!(metric.scale[k] > 0) || !std::isfinite(metric.scale[k]))
      throw InvalidInput("metric: expected scales above 0, got " + std::to_string(metric.scale[k]));
  if (metric.even()) return;
  scaled_.resize(mesh.positions.size());
  for_each_index(scaled_.size(), [&](std::size_t v) { scaled_[v] = metric.to(mesh.positions[v]); });
}

CaptureResult capture_in_metric(PolygonView mesh, const CaptureOptions& options, const Metric& metric) {
  if (metric.even()) return capture(mesh, options);
  const InMetric scaled(mesh, metric);
  CaptureOptions inner = options;
  inner.precision.scale = metric.scale;
  CaptureResult result = capture(scaled.view(), inner);
  for_each_index(result.polygons.positions.size(), [&](std::size_t v) {
    Vec3d &place = result.polygons.positions[v], &normal = result.normals[v];
    place = inner.precision.in_file(place);
    normal = metric.to(normal);  // a gradient
    if (const double length = normal.length(); length > 0) normal /= length;
  });
  result.statistics.source = build_surface(mesh, options.weld, options.orient).facts;
  result.source = unscaled(result.source->surface, metric, options.orient);
  return result;
}

}  // namespace vdb_offset
