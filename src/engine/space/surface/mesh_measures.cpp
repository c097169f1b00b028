// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/mesh_facts.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "ground/system/parallel.h"
#include "space/surface/surface.h"

namespace vdb_offset {

double used_diagonal(PolygonView mesh) {
  if (mesh.corners.empty()) return 0;
  using openvdb::math::maxComponent, openvdb::math::minComponent;
  struct Box {
    Vec3d lower, upper;
  };
  const Vec3d& first = mesh.positions[mesh.corners[0]];
  const Box box = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.corners.size()), Box{first, first},
      [&](const auto& range, Box part) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const Vec3d& x = mesh.positions[mesh.corners[i]];
          part = {minComponent(part.lower, x), maxComponent(part.upper, x)};
        }
        return part;
      },
      [](const Box& a, const Box& b) {
        return Box{minComponent(a.lower, b.lower), maxComponent(a.upper, b.upper)};
      });
  const Vec3d size = box.upper - box.lower;
  const double largest = openvdb::math::Max(size[0], size[1], size[2]);
  // The squares of tiny and huge lengths would vanish or overflow.
  return largest < 1e-150 || largest > 1e150 ? largest * (largest > 0 ? (size / largest).length() : 0) : size.length();
}

std::vector<Vec3d> vertex_normals(PolygonView polygons, const WeldOptions& weld, Orient orient) {
  Surface surface = build_surface(polygons, weld, orient);
  find_normals(surface);
  std::vector<Vec3d> normals(polygons.positions.size(), Vec3d(0.0));
  for_each_index(normals.size(), [&](std::size_t v) {
    if (surface.welded[v] == kNone) return;
    const Vec3d& sum = surface.vertex_normals[surface.welded[v]];
    if (const double length = sum.length(); length > 0) normals[v] = sum / length;
  });
  return normals;
}

std::vector<double> mean_edges(PolygonView polygons, const WeldOptions& weld) {
  const Surface surface = build_surface(polygons, weld);
  std::vector<double> sum(surface.vertices.size(), 0.0), mean(polygons.positions.size(), 0.0);
  std::vector<std::uint32_t> count(surface.vertices.size(), 0);
  for (std::size_t f = 0; f < polygons.face_count(); ++f) {
    const auto face = polygons.face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % face.size()];
      const double length = (polygons.positions[a] - polygons.positions[b]).length();
      for (const std::uint32_t v : {surface.welded[a], surface.welded[b]}) {
        if (v == kNone) continue;
        sum[v] += length;
        ++count[v];
      }
    }
  }
  for (std::size_t v = 0; v < mean.size(); ++v)
    if (const std::uint32_t w = surface.welded[v]; w != kNone && count[w] > 0) mean[v] = sum[w] / count[w];
  return mean;
}

}  // namespace vdb_offset
