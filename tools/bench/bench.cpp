// SPDX-License-Identifier: Apache-2.0
// Times the library's stages on a mesh file or a scene, from outside, and checks nothing but that they ran.
#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <span>

#include "ground/mesh/triangulate.h"
#include "ground/system/memory.h"
#include "space/field/direction_field.h"
#include "space/field/rasterise.h"
#include "space/field/sweep.h"
#include "space/query/closest_query.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/openmesh.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string input, write, json;
  int subdivide = 0, repeat = 5;
  std::vector<int> threads = {0};
  double voxels_per_diagonal = 512, percent = 1;
  bool eikonal = false;
  std::size_t queries = 100000, brute_force = 0, check = 0;
};

Polygons load(const std::string& path) {
  if (!scene::is_scene(path)) return io::read_mesh(path).polygons;
  scene::Scene scene = scene::read_scene(path);
  return scene.mesh_path.empty() ? std::move(scene.shape) : io::read_mesh(scene.mesh_path).polygons;
}

/// Subdivides a mesh `times` times by Loop's scheme: four triangles for each one, every time.
Polygons subdivide(const Polygons& mesh, int times) {
  if (times == 0) return mesh;
  OpenMesh::TriMesh_ArrayKernelT<MeshTraits> fine;
  for (const Vec3d& p : mesh.positions) fine.add_vertex({p[0], p[1], p[2]});
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) triangulate(mesh.positions, mesh.view().face(f), triangles);
  for (const auto& t : triangles)
    fine.add_face(fine.vertex_handle(t[0]), fine.vertex_handle(t[1]), fine.vertex_handle(t[2]));
  OpenMesh::Subdivider::Uniform::LoopT<decltype(fine), double> loop;
  loop.attach(fine);
  loop(static_cast<std::size_t>(times));
  loop.detach();
  Polygons result;
  for (const auto v : fine.vertices()) {
    const auto& p = fine.point(v);
    result.positions.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : fine.faces()) {
    for (const auto v : fine.fv_range(f)) result.corners.push_back(static_cast<std::uint32_t>(v.idx()));
    result.close_face();
  }
  return result;
}

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Random points within the distance of the surface, each with a triangle near it.
std::vector<std::pair<Vec3d, std::uint32_t>> make_queries(const Surface& surface, double distance, std::size_t count) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<std::pair<Vec3d, std::uint32_t>> queries(count);
  for (auto& [x, triangle] : queries) {
    triangle = static_cast<std::uint32_t>(engine() % surface.triangles.size());
    const Vec3d offset(unit(engine), unit(engine), unit(engine));
    x = surface.vertices[surface.triangles[triangle][0]] + offset * (distance / std::sqrt(3.0));
  }
  return queries;
}

/// The resident memory of the process, bytes.
std::size_t current_memory() {
  std::ifstream statm("/proc/self/statm");
  std::size_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// The largest difference between the distances of `count` queries and those found by trying every triangle.
double check_query(const ClosestQuery& query, std::span<const std::pair<Vec3d, std::uint32_t>> queries) {
  std::vector<double> difference(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t i) {
    const auto& [x, hint] = queries[i];
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < query.surface().triangles.size(); ++t)
      nearest = std::min(nearest, query.surface().closest_on(t, x).squared_distance);
    difference[i] = std::abs(query(x, hint).distance - std::sqrt(nearest));
  });
  return difference.empty() ? 0 : *std::max_element(difference.begin(), difference.end());
}

/// The root mean square and the largest error of |phi| at `count` voxels, in voxels.
std::pair<double, double> check_field(const DistanceField& field, const ClosestQuery& query, std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, field.phi->activeVoxelCount() / count);
  double sum = 0, worst = 0;
  std::size_t n = 0, taken = 0;
  auto closest = field.closest->getConstAccessor();
  for (auto voxel = field.phi->cbeginValueOn(); voxel; ++voxel) {
    if (n++ % stride != 0) continue;
    const Vec3d x = voxel.getCoord().asVec3d() * field.voxel_size;
    const auto hint = static_cast<std::uint32_t>(closest.getValue(voxel.getCoord()));
    const double error = (std::abs(*voxel) - query(x, hint).distance) / field.voxel_size;
    sum += error * error;
    worst = std::max(worst, std::abs(error));
    ++taken;
  }
  return {std::sqrt(sum / static_cast<double>(taken)), worst};
}

/// Seconds for samples of directions along short straight paths, as a march takes them, a quarter of a voxel apart: by
/// the march's own sampler, and by OpenVDB's, which knows neither inactive voxels nor borders.
std::pair<double, double> sample_seconds(const DirectionField& directions, std::span<const Vec3d> from) {
  constexpr int kSamples = 16;  // each
  const double step = directions.voxel_size / 4 / std::sqrt(3.0), per_unit = 1 / directions.voxel_size;
  Vec3d sum(0.0);
  const double ours = seconds_of([&] {
    DirectionSampler sampler(directions);
    for (const Vec3d& x : from)
      for (int i = 0; i < kSamples; ++i)
        if (Vec3d g; sampler(x + Vec3d(i * step), 1, 0, g)) sum += g;
  });
  const double theirs = seconds_of([&] {
    const openvdb::Vec3SGrid::ConstAccessor accessor = directions.gradient->getConstAccessor();
    for (const Vec3d& x : from)
      for (int i = 0; i < kSamples; ++i)
        sum += openvdb::tools::BoxSampler::sample(accessor, (x + Vec3d(i * step)) * per_unit);
  });
  if (!std::isfinite(sum.length())) throw Error("samples: expected finite directions");
  const double count = static_cast<double>(from.size()) * kSamples;
  return {ours / count, theirs / count};
}

Json run(const Polygons& mesh, const Options& options, int threads) {
  std::vector<double> build, raster, swept, direction, tree, query_seconds, batch_seconds, samples, vdb_samples;
  Json row;
  for (int i = 0; i < options.repeat; ++i) {
    Surface surface;
    build.push_back(seconds_of([&] { surface = build_surface(mesh.view(), {}); }));
    const double h = surface.facts.diagonal / options.voxels_per_diagonal,
                 distance = surface.facts.diagonal * options.percent / 100, far = std::abs(distance) + 2 * h;
    build.back() += seconds_of([&] { to_local_frame(surface, h); });
    const std::size_t memory = current_memory();
    Front front;
    raster.push_back(seconds_of([&] { front = rasterise(surface, {h, 1.01 * h}); }));
    const std::size_t band_voxels = front.phi->activeVoxelCount();
    DistanceField field;
    const Reach reach = distance < 0 ? Reach{far, 2 * h} : Reach{2 * h, far};
    swept.push_back(seconds_of([&] {
      field = sweep(std::move(front), surface, {options.eikonal ? Solver::Eikonal : Solver::Closest, reach});
    }));
    const std::size_t field_memory = peak_memory() - memory;
    DirectionField directions;
    direction.push_back(seconds_of([&] { directions = make_directions(field, !surface.facts.closed()); }));
    std::unique_ptr<ClosestQuery> query;
    tree.push_back(seconds_of([&] { query = std::make_unique<ClosestQuery>(surface); }));
    const auto queries = make_queries(surface, std::abs(distance), options.queries);
    double checksum = 0;
    query_seconds.push_back(seconds_of([&] {
      for (const auto& [x, hint] : queries) checksum += (*query)(x, hint).distance;
    }));
    std::vector<Vec3d> points;
    points.reserve(queries.size());
    for (const auto& [x, hint] : queries) points.push_back(x);
    batch_seconds.push_back(seconds_of([&] { closest_points(*query, points); }));
    const auto [sample, vdb_sample] = sample_seconds(directions, points);
    samples.push_back(1e9 * sample);
    vdb_samples.push_back(1e9 * vdb_sample);
    const auto microseconds_each = [&](const std::vector<double>& seconds) {
      return 1e6 * median(seconds) / static_cast<double>(std::max<std::size_t>(1, options.queries));
    };
    const std::size_t voxels = field.phi->activeVoxelCount();
    row = {{"threads", threads},
           {"triangles", surface.triangles.size()},
           {"voxel_size", h},
           {"distance", distance},
           {"leaf_nodes", field.phi->tree().leafCount()},
           {"band_voxels", band_voxels},
           {"voxels", voxels},
           {"field_bytes", field_memory},  // from the first run alone: later runs reuse the memory of the process
           {"build_s", median(build)},
           {"rasterise_s", median(raster)},
           {"sweep_s", median(swept)},
           {"sweep_new_voxels_per_s", static_cast<double>(voxels - band_voxels) / median(swept)},
           {"directions_s", median(direction)},
           {"direction_sample_ns", median(samples)},
           {"direction_sample_by_openvdb_ns", median(vdb_samples)},
           {"tree_s", median(tree)},
           {"query_us", microseconds_each(query_seconds)},
           {"batch_query_us", microseconds_each(batch_seconds)},
           {"query_checksum", checksum}};
    if (options.brute_force > 0 && i + 1 == options.repeat) {
      const auto some = make_queries(surface, std::abs(distance), options.brute_force);
      row["query_worst_difference"] = check_query(*query, some) / surface.facts.diagonal;
    }
    if (options.check > 0 && i + 1 == options.repeat) {
      const auto [rms, worst] = check_field(field, *query, options.check);
      row["error_rms_voxels"] = rms;
      row["error_max_voxels"] = worst;
    }
  }
  row["peak_memory_bytes"] = peak_memory();
  return row;
}

Options parse(int argc, char** argv, CLI::App& app) {
  Options options;
  app.add_option("INPUT", options.input, "Mesh file or scene")->required();
  app.add_option("--subdivide", options.subdivide, "Loop subdivisions first, four triangles for each")
      ->capture_default_str();
  app.add_option("--voxels-per-diagonal", options.voxels_per_diagonal, "Diagonal / voxel size")->capture_default_str();
  app.add_option("--percent", options.percent, "Distance, percent of the diagonal; negative is inward")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Thread counts to run with; 0 is all")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--repeat", options.repeat, "Runs; medians are printed")->capture_default_str();
  app.add_option("--queries", options.queries, "Exact distances at random points, one thread")->capture_default_str();
  app.add_option("--brute-force", options.brute_force, "Exact distances to compare with trying every triangle")
      ->capture_default_str();
  app.add_option("--check", options.check, "Voxels of phi to compare with exact distances")->capture_default_str();
  app.add_flag("--eikonal", options.eikonal, "Sweep with the eikonal solver");
  app.add_option("--write", options.write, "Write the mesh that is used");
  app.add_option("--json", options.json, "Write the rows as JSON too");
  app.parse(argc, argv);
  return options;
}

}  // namespace
}  // namespace vdb_offset::bench

int main(int argc, char** argv) {
  using namespace vdb_offset;
  CLI::App app("Times the stages of vdb_offset", "vdb_offset_bench");
  try {
    const bench::Options options = bench::parse(argc, argv, app);
    const Polygons mesh = bench::subdivide(bench::load(options.input), options.subdivide);
    if (!options.write.empty()) io::write_mesh(options.write, mesh.view());
    bench::Json rows = bench::Json::array();
    for (const int threads : options.threads) {
      tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
      arena.execute([&] { rows.push_back(bench::run(mesh, options, arena.max_concurrency())); });
      fmt::print("{}\n", rows.back().dump());
    }
    if (!options.json.empty()) write_file(options.json, rows.dump(2) + "\n");
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    fmt::print(stderr, "vdb_offset_bench: {}\n", error.what());
    return 2;
  }
}
