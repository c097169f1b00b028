#include "vdb_offset/base/parallel.h"
#include "vdb_offset/base/rounding.h"
#include "vdb_offset/iso/capture_source.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/mesh/in_metric.h"

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

CaptureResult capture_in_metric(PolygonView mesh, const CaptureOptions& options, const Metric& metric) {
  if (metric.even()) return capture(mesh, options);
  const InMetric scaled(mesh, metric);
  CaptureOptions inner = options;
  inner.precision.scale = metric.scale;
  CaptureResult result = capture(scaled.view(), inner);
  for_each_index(result.polygons.positions.size(), [&](std::size_t v) {
    Vec3d &place = result.polygons.positions[v], &normal = result.normals[v];
    place = Rounding(inner.precision).in_file(place);
    normal = metric.to(normal);  // a gradient
    if (const double length = normal.length(); length > 0) normal /= length;
  });
  result.statistics.source = build_surface(mesh, options.weld, options.orient).facts;
  result.source = unscaled(result.source->surface, metric, options.orient);
  return result;
}

CaptureStatistics plan_capture_in_metric(PolygonView mesh, const CaptureOptions& options, const Metric& metric) {
  CaptureStatistics statistics = plan_capture(InMetric(mesh, metric).view(), options);
  // What is told of the mesh is of the mesh as it is.
  if (!metric.even()) statistics.source = build_surface(mesh, options.weld, options.orient).facts;
  return statistics;
}

}  // namespace vdb_offset
