// SPDX-License-Identifier: Apache-2.0
// Measures the tables of Wang, Guibault, Camarero and Tchon (AIAA 2005) as CSV: the circle and the cube, by their
// method (first-order sweep, stop on interpolated phi) and by this library's. With "circle", where the circle's points
// go. See scripts/paper_tables.
#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>

#include "space/curve/ribbon.h"
#include "space/field/direction_field.h"
#include "space/field/rasterise.h"
#include "space/field/sweep.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

namespace vdb_offset {
namespace {

constexpr double kDistance = 0.1, kTimeStep = 0.01;  // the paper's, inward
constexpr int kRuns = 3;                             // runs, of which the median counts

using Answer = std::function<Vec3d(const Vec3d&)>;

struct Row {
  std::size_t nodes = 0;
  double initialise = 0, sweep = 0, gradient = 0, capture = 0, propagate = 0, rms = 0, worst = 0;
};

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double capture_seconds(const openvdb::FloatGrid& phi) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  return seconds_of([&] { openvdb::tools::volumeToMesh(phi, points, quads, -kDistance); });
}

void measure_errors(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to, const Answer& answer, Row& row) {
  for (std::size_t v = 0; v < from.size(); ++v) {
    const double error = (to[v] - answer(from[v])).length();
    row.worst = std::max(row.worst, error);
    row.rms += error * error / static_cast<double>(from.size());
  }
  row.rms = std::sqrt(row.rms);
}

/// The paper's third step, inward: RK4 with a fixed step along grad phi / |grad phi|, until the interpolated phi is at
/// the distance (the last step cut in proportion) or falls.
class InterpolatedMarch {
 public:
  InterpolatedMarch(const DistanceField& field, const DirectionField& directions)
      : sampler_(directions), phi_(*field.phi), h_(field.voxel_size) {}

  Vec3d operator()(Vec3d x) {
    double here = depth(x);
    constexpr int kMostSteps = 1000;
    for (int i = 0; i < kMostSteps; ++i) {
      const Vec3d next = step(x);
      const double there = depth(next);
      if (there >= kDistance) return x + (next - x) * ((kDistance - here) / (there - here));
      if (there <= here) return x;
      x = next;
      here = there;
    }
    return x;
  }

 private:
  double depth(const Vec3d& x) const {
    return -openvdb::tools::BoxSampler::sample(phi_.tree(), openvdb::Vec3R(x / h_));
  }
  Vec3d velocity(const Vec3d& x) {
    Vec3d gradient(0.0);
    if (!sampler_(x, -1, 0, gradient) || !(gradient.lengthSqr() > 0)) return Vec3d(0.0);
    return -gradient.unit();
  }
  Vec3d step(const Vec3d& x) {
    const Vec3d k1 = velocity(x), k2 = velocity(x + k1 * (kTimeStep / 2)), k3 = velocity(x + k2 * (kTimeStep / 2)),
                k4 = velocity(x + k3 * kTimeStep);
    return x + (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (kTimeStep / 6);
  }

  DirectionSampler sampler_;
  const openvdb::FloatGrid& phi_;
  double h_;
};

/// Removes the nodes outside of the shape, as on a grid that ends at its bounding box.
void cut_at_surface(DistanceField& field) {
  for (auto phi = field.phi->beginValueOn(); phi; ++phi)
    if (*phi > 1e-6f) phi.setValueOff();
}

/// The paper's method for points on a surface, or half way up a ribbon; `tight` with a grid that ends there.
Row paper_method(Surface surface, std::vector<Vec3d> points, double h, bool slab, const Answer& answer,
                 bool tight = false, std::vector<Vec3d>* arrived = nullptr) {
  Row row;
  to_local_frame(surface, h);
  Front front;
  row.initialise = seconds_of([&] { front = rasterise(surface, {h, 1.01 * h, slab}); });
  const Reach reach{kDistance + 3 * h, 1.01 * h};
  DistanceField field;
  row.sweep = seconds_of([&] { field = sweep(std::move(front), surface, {Solver::Eikonal, reach}); });
  if (tight) cut_at_surface(field);
  row.nodes = field.phi->activeVoxelCount() / (slab ? kLeafWidth : 1);
  row.capture = capture_seconds(*field.phi);
  std::vector<Vec3d> ends(points.size());
  DirectionField directions;
  row.gradient = seconds_of([&] { directions = make_directions(field, false); });
  row.propagate = seconds_of([&] {
    InterpolatedMarch march(field, directions);
    for (std::size_t p = 0; p < points.size(); ++p) ends[p] = march(points[p] - surface.origin) + surface.origin;
  });
  for (auto* some : {&points, &ends})
    if (slab)
      for (Vec3d& p : *some) p[2] = 0;
  measure_errors(points, ends, answer, row);
  if (arrived) *arrived = std::move(ends);
  return row;
}

Row our_row(const OffsetResult& result, std::span<const Vec3d> points, const Answer& answer, std::size_t per_node) {
  Row row;
  const auto seconds = [&](Stage stage) { return result.statistics.seconds[static_cast<std::size_t>(stage)]; };
  row.initialise = seconds(Stage::Rasterise);
  row.sweep = seconds(Stage::Sweep);
  row.gradient = seconds(Stage::Gradient);
  row.propagate = seconds(Stage::Propagate);
  row.nodes = result.statistics.active_voxels / per_node;
  row.capture = capture_seconds(*result.field->phi);
  measure_errors({points.begin(), points.end()}, result.positions, answer, row);
  return row;
}

OffsetOptions our_options(double h) {
  OffsetOptions options;
  options.distance = -kDistance;
  options.grid.voxel_size = h;
  options.collision = Collision::Merge;  // the paper's weak solution
  options.keep_field = true;
  return options;
}

/// The row of several runs, with the median of each time. All else is the same in all runs.
Row median_of(const std::function<Row()>& run) {
  std::array<Row, kRuns> rows;
  for (Row& row : rows) row = run();
  Row row = rows.front();
  for (const auto time : {&Row::initialise, &Row::sweep, &Row::gradient, &Row::capture, &Row::propagate}) {
    std::array<double, kRuns> all{};
    std::transform(rows.begin(), rows.end(), all.begin(), [&](const Row& each) { return each.*time; });
    std::sort(all.begin(), all.end());
    row.*time = all[kRuns / 2];
  }
  return row;
}

void print(const char* shape, const char* method, int n, double h, const Row& row) {
  fmt::print("{},{},{},{:.9g},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6e},{:.6e}\n", shape, method, n, h, row.nodes,
             row.initialise, row.sweep, row.gradient, row.capture, row.propagate, row.rms, row.worst);
  std::fflush(stdout);
}

Curves circle_of(int count) {
  Curves circle;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * std::numbers::pi * i / count;
    circle.positions.emplace_back(0.5 * std::cos(a), 0.5 * std::sin(a), 0);
    circle.corners.push_back(static_cast<std::uint32_t>(i));
  }
  circle.corners.push_back(0);
  circle.close_face();
  return circle;
}

Row paper_circle(const Curves& circle, double h, const Answer& answer, std::vector<Vec3d>* arrived = nullptr) {
  std::vector<Vec2d> points;
  std::vector<Vec3d> starts;
  const double height = (kLeafWidth - 1) * h;
  for (const Vec3d& p : circle.positions) {
    points.emplace_back(p[0], p[1]);
    starts.emplace_back(p[0], p[1], height / 2);
  }
  const CurveChains chains = join_curves(circle.view(), points);
  const Polygons ribbon = make_ribbon(chains.segments, points, height);
  return paper_method(build_surface(ribbon.view(), {}), std::move(starts), h, true, answer, false, arrived);
}

Row our_circle(const Curves& circle, double h, const Answer& answer) {
  const Distances distance(-kDistance);
  const OffsetResult result = offset_curves(circle.view(), {&distance, 1}, our_options(h)).front();
  return our_row(result, circle.positions, answer, kLeafWidth);
}

void circle_tables() {
  const Curves coarse = circle_of(40), fine = circle_of(40 * 256);
  const double corner = 0.5 - kDistance / std::cos(std::numbers::pi / 40);
  const Answer of_polygon = [=](const Vec3d&x) { return x.unit() * corner; },
               of_circle = [](const Vec3d&x) { return x.unit() * (0.5 - kDistance); };
  for (const int n : {20, 40, 80, 160, 320}) {
    const double h = 1.0 / n;
    print("circle of 40 points", "paper", n, h, median_of([&] { return paper_circle(coarse, h, of_polygon); }));
    print("circle of 40 points", "ours", n, h, median_of([&] { return our_circle(coarse, h, of_polygon); }));
    print("circle of 10240 points", "paper", n, h, median_of([&] { return paper_circle(fine, h, of_circle); }));
    print("circle of 10240 points", "ours", n, h, median_of([&] { return our_circle(fine, h, of_circle); }));
  }
}

/// Prints the positions of the circle's 40 points: in the source, and by both methods on a grid of n cells across.
void print_circle(int n) {
  const Curves circle = circle_of(40);
  std::vector<Vec3d> by_paper;
  const Answer anywhere = [](const Vec3d& x) { return x; };
  paper_circle(circle, 1.0 / n, anywhere, &by_paper);
  const Distances distance(-kDistance);
  const OffsetResult ours = offset_curves(circle.view(), {&distance, 1}, our_options(1.0 / n)).front();
  for (std::size_t p = 0; p < circle.positions.size(); ++p)
    for (const auto& [name, positions] :
         {std::pair{"source", &circle.positions}, {"paper", &by_paper}, {"ours", &ours.positions}})
      fmt::print("{},{},{},{:.9g},{:.9g}\n", n, name, p, (*positions)[p][0], (*positions)[p][1]);
}

void cube_tables(int finest) {
  const Polygons cube = shapes::box(Vec3d(0.5), 83, true);
  const Answer answer = [](const Vec3d& x) {
    return Vec3d(std::clamp(x[0], -0.15, 0.15), std::clamp(x[1], -0.15, 0.15), std::clamp(x[2], -0.15, 0.15));
  };
  for (int n = 20; n <= finest; n *= 2) {
    const double h = 0.5 / n;
    print("cube", "paper", n, h,
          median_of([&] { return paper_method(build_surface(cube.view(), {}), cube.positions, h, false, answer); }));
    print("cube", "paper (tight grid)", n, h, median_of([&] {
            return paper_method(build_surface(cube.view(), {}), cube.positions, h, false, answer, true);
          }));
    print("cube", "ours", n, h,
          median_of([&] { return our_row(offset(cube.view(), our_options(h)), cube.positions, answer, 1); }));
  }
}

}  // namespace
}  // namespace vdb_offset

int main(int argc, char** argv) {
  using namespace vdb_offset;
  openvdb::initialize();
  if (argc > 1 && std::string_view(argv[1]) == "circle") {
    fmt::print("n,method,point,x,y\n");
    for (const int n : {20, 320}) print_circle(n);
    return 0;
  }
  const int finest = argc > 1 ? std::max(20, std::atoi(argv[1])) : 320;
  fmt::print("shape,method,n,h,nodes,initialise,sweep,gradient,capture,propagate,l2,linf\n");
  circle_tables();
  cube_tables(finest);
}
