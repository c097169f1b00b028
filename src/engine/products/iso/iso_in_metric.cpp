// SPDX-License-Identifier: Apache-2.0
#include "ground/distances/in_metric.h"
#include "ground/numbers/rounding.h"
#include "ground/system/parallel.h"
#include "products/iso/iso_source.h"
#include "vdb_offset/iso_surface.h"

namespace vdb_offset {
namespace {

/// The source as it is in the file, with its triangles in their order, for attributes that come from there.
std::shared_ptr<const IsoSource> unscaled(const Surface& scaled, const Metric& metric, Orient orient) {
  Surface surface = scaled;
  for (Vec3d& v : surface.vertices) v = metric.from(v + scaled.origin);
  to_frame(surface, metric.from(scaled.origin));
  return std::make_shared<const IsoSource>(std::move(surface), std::nullopt, 0.0, orient);
}

}  // namespace

IsoResult make_iso_surface_in_metric(PolygonView mesh, const IsoOptions& options, const Metric& metric) {
  if (metric.even()) return make_iso_surface(mesh, options);
  const InMetric scaled(mesh, metric);
  IsoOptions inner = options;
  inner.precision.scale = metric.scale;
  IsoResult result = make_iso_surface(scaled.view(), inner);
  for_each_index(result.polygons.positions.size(), [&](std::size_t v) {
    Vec3d &position = result.polygons.positions[v], &normal = result.normals[v];
    position = Rounding(inner.precision).in_file(position);
    normal = metric.to(normal);  // a gradient
    if (const double length = normal.length(); length > 0) normal /= length;
  });
  result.statistics.source = build_surface(mesh, options.weld.without_joins(), options.orient).facts;
  result.source = unscaled(result.source->surface, metric, options.orient);
  return result;
}

IsoStatistics plan_iso_surface_in_metric(PolygonView mesh, const IsoOptions& options, const Metric& metric) {
  IsoStatistics statistics = plan_iso_surface(InMetric(mesh, metric).view(), options);
  // Facts of the mesh are those of the mesh in the file.
  if (!metric.even()) statistics.source = build_surface(mesh, options.weld.without_joins(), options.orient).facts;
  return statistics;
}

}  // namespace vdb_offset
