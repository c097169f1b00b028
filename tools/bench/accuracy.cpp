// SPDX-License-Identifier: Apache-2.0
// Prints the tables of accuracy in docs/measured.md: positions of a sphere's and a cube's vertices against closed
// forms.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

namespace vdb_offset {
namespace {

struct Row {
  double worst = 0, rms = 0, off_target = 0, reached = 0, seconds = 0;
};

/// Position errors against `answer`, and the largest |distance - d| / d among the vertices that arrived.
template <class Answer>
Row measure(const Polygons& mesh, double distance, double voxel_size, Answer&& answer) {
  OffsetOptions options;
  options.distance = distance;
  options.grid.voxel_size = voxel_size;
  options.collision = Collision::Merge;  // the closed forms are those of the paper's answer, which merges
  const OffsetResult result = offset(mesh.view(), options);
  Row row;
  const auto count = static_cast<double>(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double error = (result.positions[v] - answer(mesh.positions[v])).length();
    row.worst = std::max(row.worst, error);
    row.rms += error * error / count;
    if (result.states[v] != VertexState::Reached) continue;
    row.reached += 1 / count;
    row.off_target = std::max(row.off_target, std::abs(result.achieved[v] / std::abs(distance) - 1));
  }
  row.rms = std::sqrt(row.rms);
  for (const double seconds : result.statistics.seconds) row.seconds += seconds;
  return row;
}

void print(const char* shape, double distance, double h, const Row& row) {
  fmt::print("| {} | {:+.1f} | {:.4f} | {:.1f} % | {:.1e} | {:.1e} | {:.1e} | {:.2f} |\n", shape, distance, h,
             100 * row.reached, row.worst, row.rms, row.off_target, row.seconds);
}

}  // namespace
}  // namespace vdb_offset

int main() {
  using namespace vdb_offset;
  fmt::print("| shape | d | h | reached | L∞ of position | L2 of position | worst error of distance | seconds |\n");
  fmt::print("|---|---|---|---|---|---|---|---|\n");
  const Polygons sphere = shapes::icosphere(0.5, 6), cube = shapes::box(Vec3d(0.5), 83, true);
  for (const double distance : {0.1, -0.1})
    for (const double h : {0.05, 0.025, 0.0125})
      print("icosphere, 40,962 vertices", distance, h,
            measure(sphere, distance, h, [&](const Vec3d& x) { return x.unit() * (0.5 + distance); }));
  for (const double h : {0.05, 0.025, 0.0125, 0.00625, 0.003125})
    print("cube, 82,668 triangles", -0.1, h, measure(cube, -0.1, h, [](const Vec3d& x) {
            return Vec3d(std::clamp(x[0], -0.15, 0.15), std::clamp(x[1], -0.15, 0.15), std::clamp(x[2], -0.15, 0.15));
          }));
}
