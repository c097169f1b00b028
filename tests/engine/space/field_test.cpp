// SPDX-License-Identifier: Apache-2.0
#include <openvdb/io/File.h>
#include <openvdb/tools/Interpolation.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <random>

#include "space/field/direction_field.h"
#include "space/field/rasterise.h"
#include "space/field/sweep.h"
#include "support/oracles.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

struct Fixture {
  Surface surface;
  double h;
  Fixture(const Polygons& mesh, double voxel_size) : surface(build_surface(mesh.view(), {})), h(voxel_size) {
    to_local_frame(surface, h);
  }
  Front front() const { return rasterise(surface, {h, 1.01 * h}); }
  DistanceField field(Reach reach, Solver solver = Solver::Closest) const {
    return sweep(front(), surface, {solver, reach});
  }
};

struct FieldErrors {
  double worst = 0, rms = 0;
  std::size_t voxels = 0, wrong_sign = 0;
};

/// Compares |phi| of every active voxel with a closed form of the world position; the sign too.
template <class Truth>
FieldErrors compare(const FieldGrids& field, Truth&& truth) {
  FieldErrors errors;
  for (auto voxel = field.phi->cbeginValueOn(); voxel; ++voxel) {
    const double exact = truth(field.phi->indexToWorld(voxel.getCoord()));
    const double error = std::abs(std::abs(exact) - std::abs(static_cast<double>(*voxel)));
    errors.worst = std::max(errors.worst, error);
    errors.rms += error * error;
    ++errors.voxels;
    errors.wrong_sign += std::abs(exact) > 1e-6 && (exact < 0) != (*voxel < 0);
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(errors.voxels));
  return errors;
}

/// Signed distance to an axis-aligned cube of half side `half_side` around the origin.
double cube_distance(const Vec3d& x, double half_side) {
  Vec3d q;
  for (int k = 0; k < 3; ++k) q[k] = std::abs(x[k]) - half_side;
  const double inside = std::min(0.0, std::max({q[0], q[1], q[2]}));
  return Vec3d(std::max(q[0], 0.0), std::max(q[1], 0.0), std::max(q[2], 0.0)).length() + inside;
}

template <class GridPtr>
bool same_voxels(const GridPtr& a, const GridPtr& b) {
  if (a->activeVoxelCount() != b->activeVoxelCount()) return false;
  auto other = b->getConstAccessor();
  for (auto voxel = a->cbeginValueOn(); voxel; ++voxel)
    if (!other.isValueOn(voxel.getCoord()) || other.getValue(voxel.getCoord()) != *voxel) return false;
  return true;
}

}  // namespace

TEST_CASE("rasterise: the band is complete and exact, with sign", "[rasterise]") {
  const double h = 0.037, half_side = 0.5;
  const Front front = Fixture(shapes::box(Vec3d(1), 5, true), h).front();
  // phi is stored as float: its rounding is 6e-8 of a band of 0.04.
  const FieldErrors errors = compare(front, [&](const Vec3d& x) { return cube_distance(x, half_side); });
  CHECK(errors.worst < 4e-9);
  CHECK(errors.wrong_sign == 0);
  std::size_t expected = 0;
  for (int i = -20; i <= 40; ++i)
    for (int j = -20; j <= 40; ++j)
      for (int k = -20; k <= 40; ++k)
        expected += std::abs(cube_distance(front.phi->indexToWorld(openvdb::Coord(i, j, k)), half_side)) <= front.band;
  CHECK(errors.voxels == expected);
}

TEST_CASE("rasterise: one large triangle and many small ones give the same distances", "[rasterise]") {
  const double h = 0.02;
  const Front coarse = Fixture(shapes::box(Vec3d(1), 1, true), h).front(),
              fine = Fixture(shapes::box(Vec3d(1), 50, true), h).front();
  REQUIRE(coarse.phi->activeVoxelCount() == fine.phi->activeVoxelCount());
  auto other = fine.phi->getConstAccessor();
  double worst = 0;
  for (auto voxel = coarse.phi->cbeginValueOn(); voxel; ++voxel)
    worst = std::max(worst, std::abs(static_cast<double>(*voxel) - other.getValue(voxel.getCoord())));
  CHECK(worst < 1e-8);
}

TEST_CASE("rasterise: sheets a tenth of a voxel apart are both there", "[rasterise]") {
  const double h = 0.05;
  const Fixture plates(shapes::plates(1, 0.3, 0.005, 4), h);
  const Front front = plates.front();
  for (auto voxel = front.phi->cbeginValueOn(); voxel; ++voxel) {
    const Vec3d x = front.phi->indexToWorld(voxel.getCoord());
    CHECK(std::abs(*voxel) ==
          Approx(test::brute_force_distance(shapes::plates(1, 0.3, 0.005, 4).view(), x)).margin(1e-8));
  }
}

TEST_CASE("sweep: phi of a closest-triangle field is exact out to its reach", "[sweep]") {
  const double h = 0.02, half_side = 0.5;
  const Fixture cube(shapes::box(Vec3d(1), 6, true), h);
  const DistanceField field = cube.field({2.01 * h, 0.3});
  const FieldErrors errors = compare(field, [&](const Vec3d& x) { return cube_distance(x, half_side); });
  CHECK(errors.worst < 1e-7);
  CHECK(errors.wrong_sign == 0);
  // Every voxel within reach is set, on both sides.
  for (auto x = -0.79; x < 0.79; x += 0.0931)
    for (auto y = -0.79; y < 0.79; y += 0.1013) {
      const Vec3d p(x, y, 0.123);
      const double truth =
          cube_distance(field.phi->indexToWorld(openvdb::Coord::round(field.phi->worldToIndex(p))), half_side);
      const bool within = truth < 0.3 - 1e-6 && truth > -2.01 * h + 1e-6;
      if (within || truth > 0.3 + 1e-6 || truth < -2.01 * h - 1e-6)
        CHECK(field.phi->tree().isValueOn(openvdb::Coord::round(field.phi->worldToIndex(p))) == within);
    }
}

TEST_CASE("sweep: curved surfaces stay within a hundredth of a voxel", "[sweep]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.3, 1.5, 11, 4);
  const double h = 0.05;
  const Fixture bumpy(mesh, h);
  const DistanceField field = bumpy.field({2 * h, 0.4});
  double worst = 0, sum = 0;
  std::size_t count = 0, n = 0;
  for (auto voxel = field.phi->cbeginValueOn(); voxel; ++voxel) {
    if (n++ % 97 != 0) continue;
    const double truth = test::brute_force_distance(mesh.view(), field.phi->indexToWorld(voxel.getCoord()));
    const double error = (std::abs(*voxel) - truth) / h;
    REQUIRE(error > -1e-6);  // a distance to some triangle is never below the least
    worst = std::max(worst, error);
    sum += error * error;
    ++count;
  }
  CHECK(count > 300);
  CHECK(std::sqrt(sum / static_cast<double>(count)) < 0.005);
  CHECK(worst < 0.1);
}

TEST_CASE("sweep: walls, gaps and needles thinner than a voxel keep their distances", "[sweep]") {
  Polygons needle;
  needle.positions = {{0, 0, 0}, {0.004, 0, 0}, {0.002, 0.003, 0}, {0.1, 0.2, 2.5}};
  needle.corners = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  needle.face_begin = {0, 3, 6, 9, 12};
  const double h = 0.05;  // the walls are a fifth of it thick, the plates a tenth of it apart
  for (const Polygons& mesh : {shapes::hollow_box(1, 0.01, 3), shapes::plates(1, 0.005, 0.005, 4), needle}) {
    const DistanceField field = Fixture(mesh, h).field({2 * h, 0.3});
    double worst = 0, sum = 0;
    std::size_t count = 0, n = 0;
    for (auto voxel = field.phi->cbeginValueOn(); voxel; ++voxel) {
      if (n++ % 7 != 0) continue;
      const double error =
          std::abs(*voxel) - test::brute_force_distance(mesh.view(), field.phi->indexToWorld(voxel.getCoord()));
      REQUIRE(error > -1e-7);
      worst = std::max(worst, error / h);
      sum += error * error / (h * h);
      ++count;
    }
    CHECK(count > 200);
    CHECK(worst < 0.1);
    CHECK(std::sqrt(sum / static_cast<double>(count)) < 0.005);
  }
}

TEST_CASE("sweep: the same voxels at any scale and position", "[sweep][invariant]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.3, 1.5, 8, 3);
  const double h = 0.0625;
  const DistanceField base = Fixture(mesh, h).field({2 * h, 0.3});
  const auto compare_with_base = [&](double scale, const Vec3d& shift, double tolerance) {
    Polygons other = mesh;
    for (Vec3d& p : other.positions) p = p * scale + shift;
    const DistanceField field = Fixture(other, h * scale).field({2 * h * scale, 0.3 * scale});
    CHECK(field.phi->activeVoxelCount() == base.phi->activeVoxelCount());
    auto values = field.phi->getConstAccessor();
    double worst = 0;
    for (auto voxel = base.phi->cbeginValueOn(); voxel; ++voxel)
      worst = std::max(worst, std::abs(values.getValue(voxel.getCoord()) / scale - *voxel));
    CHECK(worst < tolerance * h);
  };
  compare_with_base(1e-6, Vec3d(0), 1e-5);
  compare_with_base(1e6, Vec3d(0), 1e-5);
  compare_with_base(1, Vec3d(1e6, -1e6, 1e6), 1e-5);  // by whole leaf nodes, which are half a unit wide
}

TEST_CASE("sweep: voxels of the front keep their bits", "[sweep]") {
  const Fixture torus(shapes::torus(1, 0.4, 48, 24), 0.05);
  for (const Solver solver : {Solver::Closest, Solver::Eikonal}) {
    const Front front = torus.front();
    const DistanceField field = torus.field({0.1, 0.3}, solver);
    auto swept = field.phi->getConstAccessor();
    std::size_t changed = 0;
    for (auto voxel = front.phi->cbeginValueOn(); voxel; ++voxel) changed += swept.getValue(voxel.getCoord()) != *voxel;
    CHECK(changed == 0);
    CHECK(field.phi->activeVoxelCount() > front.phi->activeVoxelCount());
  }
}

TEST_CASE("sweep: an eikonal field converges at first order", "[sweep][long]") {
  // Exact values in a band of one voxel, distance 0.1 from a sphere fine enough to stand for the true one.
  const Polygons sphere = shapes::icosphere(0.5, 6);
  std::vector<double> errors;
  for (const double d_over_h : {8.0, 16.0, 32.0}) {
    const double h = 0.1 / d_over_h;
    const DistanceField field = Fixture(sphere, h).field({2 * h, 0.1 + 2 * h}, Solver::Eikonal);
    double sum = 0;
    std::size_t count = 0;
    for (auto voxel = field.phi->cbeginValueOn(); voxel; ++voxel) {
      if (*voxel < 0) continue;
      sum += std::abs(*voxel - (field.phi->indexToWorld(voxel.getCoord()).length() - 0.5));
      ++count;
    }
    errors.push_back(sum / static_cast<double>(count));
  }
  INFO(errors[0] << " " << errors[1] << " " << errors[2]);
  for (const std::size_t i : {0u, 1u}) {
    CHECK(errors[i] / errors[i + 1] > 2 * 0.8);
    CHECK(errors[i] / errors[i + 1] < 2 * 1.2);
  }
}

TEST_CASE("sweep: the eikonal gradient has length 1 away from the medial axis", "[sweep]") {
  const double h = 0.0125;
  DistanceField field = Fixture(shapes::icosphere(0.5, 6), h).field({2 * h, 0.2}, Solver::Eikonal);
  const DirectionField directions = make_directions(field, false);
  std::size_t outside = 0, count = 0;
  for (auto voxel = directions.gradient->cbeginValueOn(); voxel; ++voxel) {
    const double phi = field.phi->tree().getValue(voxel.getCoord());
    if (phi < 2 * h || phi > 0.2 - 2 * h) continue;
    ++count;
    outside += std::abs(openvdb::Vec3d(*voxel).length() - 1) > 0.02;
  }
  CHECK(count > 10000);
  CHECK(outside == 0);
}

TEST_CASE("sweep: grids are the same for any number of threads", "[sweep]") {
  const Fixture bumpy(shapes::bumpy_sphere(1, 0.3, 1.5, 5, 4), 0.04);
  for (const Solver solver : {Solver::Closest, Solver::Eikonal}) {
    const auto with_threads = [&](int threads) {
      tbb::task_arena arena(threads);
      DistanceField field;
      arena.execute([&] { field = bumpy.field({0.1, 0.3}, solver); });
      return field;
    };
    const DistanceField one = with_threads(1), four = with_threads(4);
    CHECK(same_voxels(one.phi, four.phi));
    CHECK(same_voxels(one.closest, four.closest));
  }
}

TEST_CASE("sweep: an empty front and a reach inside the band are refused", "[sweep]") {
  const Fixture cube(shapes::box(Vec3d(1), 2, true), 0.1);
  Front empty;
  static_cast<FieldGrids&>(empty) = make_field_grids(0.1, 0.1, Vec3d(0.0));
  CHECK_THROWS_AS(sweep(empty, cube.surface, {Solver::Closest, {1, 1}}), InvalidInput);
  CHECK_THROWS_AS(cube.field({0.05, 1}), InvalidInput);
  CHECK_THROWS_AS(cube.field({1, 0.05}), InvalidInput);
}

TEST_CASE("field: what is handed out are the grids that vertices are led through", "[field]") {
  DistanceField field = Fixture(shapes::box(Vec3d(1), 4, true), 0.05).field({0.1, 0.2});
  const DirectionField directions = make_directions(field, false);
  const openvdb::FloatGrid* const phi = field.phi.get();
  const openvdb::FloatTree* const tree = &field.phi->tree();
  const openvdb::Int32Grid* const closest = field.closest.get();
  const openvdb::Int32Tree* const closest_tree = &field.closest->tree();
  CHECK(directions.phi.get() == phi);
  CHECK(directions.gradient->tree().hasSameTopology(*tree));
  CHECK(&directions.gradient->transform() == &field.phi->transform());
  const std::shared_ptr<DistanceField> out = hand_out(std::move(field), true);
  CHECK(out->phi.get() == phi);
  CHECK(&out->phi->tree() == tree);
  CHECK(out->closest.get() == closest);
  CHECK(&out->closest->tree() == closest_tree);
  CHECK(out->phi->metaValue<double>("reach_outside") == 0.2);
}

namespace {

/// The largest difference, in voxels, between phi as OpenVDB's sampler interpolates it and the distance to a shape, at
/// 10,000 places of its band; less what interpolation may do at most there: h^2 / 8 times the sum of second derivatives
/// along the axes, which is no more than that of the curvatures of the surface at that distance.
template <class PlaceAt, class Distance, class Curvatures>
double sampled_error(const DistanceField& field, PlaceAt&& place_at, Distance&& distance, Curvatures&& curvatures) {
  const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> sampler(*field.phi);
  std::mt19937 random(17);
  std::uniform_real_distribution<double> share(0, 1);
  double worst = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vec3d x = place_at(share(random), share(random), share(random));
    const double error = std::abs(sampler.wsSample(x) - distance(x)),
                 interpolation = field.voxel_size * field.voxel_size / 8 * curvatures(x);
    worst = std::max(worst, (error - interpolation) / field.voxel_size);
  }
  return worst;
}

constexpr double kFullTurn = 6.283185307179586;

}  // namespace

// A tenth of a voxel is what docs/dev/tuning.md states that the sweep is off at most, beside ridges; here are none. The
// faces of the meshes are within 0.002 of the shapes.
TEST_CASE("field: OpenVDB's sampler finds the distance to a sphere and a torus", "[field]") {
  const double h = 0.02, reach = 8 * h, off = 0.04;
  SECTION("sphere") {
    const DistanceField field = Fixture(shapes::icosphere(1, 6), h).field({reach, reach});
    const double worst = sampled_error(
        field,
        [&](double u, double v, double w) {
          const double z = 2 * u - 1, around = kFullTurn * v, r = 1 + (2 * w - 1) * (reach - 2 * h);
          return Vec3d(std::sqrt(1 - z * z) * std::cos(around), std::sqrt(1 - z * z) * std::sin(around), z) * r;
        },
        [](const Vec3d& x) { return x.length() - 1; }, [&](const Vec3d& x) { return 2 / (x.length() - 2 * h); });
    CHECK(worst < off);
    UNSCOPED_INFO(worst);
  }
  SECTION("torus") {
    const double large = 1, small = 0.4;
    const DistanceField field = Fixture(shapes::torus(large, small, 512, 256), h).field({reach, reach});
    const auto from_ring = [&](const Vec3d& x) { return std::hypot(std::hypot(x[0], x[1]) - large, x[2]); };
    const double worst = sampled_error(
        field,
        [&](double u, double v, double w) {
          const double across = kFullTurn * u, around = kFullTurn * v, r = small + (2 * w - 1) * (reach - 2 * h),
                       from_axis = large + r * std::cos(across);
          return Vec3d(from_axis * std::cos(around), from_axis * std::sin(around), r * std::sin(across));
        },
        [&](const Vec3d& x) { return from_ring(x) - small; },
        [&](const Vec3d& x) { return 1 / (from_ring(x) - 2 * h) + 1 / (std::hypot(x[0], x[1]) - 2 * h); });
    CHECK(worst < off);
    UNSCOPED_INFO(worst);
  }
}

TEST_CASE("field: a saved file opens with its grids, classes and metadata", "[field]") {
  openvdb::initialize();
  const Fixture cube(shapes::box(Vec3d(1), 4, true), 0.05);
  DistanceField made = cube.field({0.1, 0.2});
  const DistanceField field = *hand_out(std::move(made), true);
  const std::string path = (std::filesystem::temp_directory_path() / "vdb_offset_field_test.vdb").string();
  save_vdb(field, path, {{"source", "cube"}});
  openvdb::io::File file(path);
  file.open();
  const auto phi = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("phi"));
  const auto closest = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("closest_primitive"));
  file.close();
  std::filesystem::remove(path);
  CHECK(phi->getGridClass() == openvdb::GRID_LEVEL_SET);
  CHECK(phi->metaValue<std::string>("source") == "cube");
  CHECK(phi->voxelSize()[0] == Approx(0.05));
  CHECK(same_voxels(phi, field.phi));
  CHECK(same_voxels(closest, field.closest));
  CHECK(phi->tree().getValue(openvdb::Coord::round(phi->worldToIndex(Vec3d(0.0)))) < 0);  // flooded inside
  CHECK_THROWS_AS(save_vdb(field, "/nonexistent/folder/f.vdb"), WriteError);
}
