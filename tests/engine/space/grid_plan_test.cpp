// SPDX-License-Identifier: Apache-2.0
#include "space/field/grid_plan.h"

#include <catch2/catch.hpp>
#include <limits>

#include "space/field/rasterise.h"
#include "space/field/sweep.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

Surface surface_of(const Polygons& mesh) { return build_surface(mesh.view(), {}); }

}  // namespace

TEST_CASE("plan: the automatic voxel size is about the distance, between its floor and its ceiling", "[plan]") {
  const Surface sphere = surface_of(shapes::icosphere(1, 5));  // diagonal 3.46, median edge about 0.04
  const double edge = sphere.facts.median_edge, diagonal = sphere.facts.diagonal;
  CHECK(plan_grid(sphere, 0.03, {}, 0, 1).voxel_size == 0.03);
  CHECK(plan_grid(sphere, -0.03, {}, 0, 1).voxel_size == 0.03);
  CHECK(plan_grid(sphere, 1e-9, {}, 0, 1).voxel_size == Approx(edge / 2));
  CHECK(plan_grid(sphere, 0.2, {}, 0, 1).voxel_size == Approx(diagonal / 64));
  CHECK(plan_grid(sphere, 10, {}, 0, 1).voxel_size == Approx(10.0 / 16));
}

TEST_CASE("plan: a given size is taken as it is", "[plan]") {
  const Surface sphere = surface_of(shapes::icosphere(1, 4));
  CHECK(plan_grid(sphere, 0.1, {0.0123, {}}, 0, 1).voxel_size == 0.0123);
  CHECK(plan_grid(sphere, -0.1, {{}, 8}, 0, 1).voxel_size == 0.0125);
  CHECK_THROWS_AS(plan_grid(sphere, 0.1, {0.1, 2}, 0, 1), InvalidInput);
  CHECK_THROWS_AS(plan_grid(sphere, 0.1, {-0.1, {}}, 0, 1), InvalidInput);
  CHECK_THROWS_AS(plan_grid(sphere, 0.1, {{}, std::numeric_limits<double>::infinity()}, 0, 1), InvalidInput);
  CHECK_THROWS_AS(plan_grid(sphere, 0, {}, 0, 1), InvalidInput);
}

TEST_CASE("plan: what does not fit is refused with the size that would", "[plan]") {
  const Surface sphere = surface_of(shapes::icosphere(1, 4));
  const std::size_t budget = 64 << 20;  // of which the process itself takes 17
  CHECK_THROWS_WITH(plan_grid(sphere, 0.5, {1e-3, {}}, budget, 1),
                    Catch::Contains("64 MiB") && Catch::Contains("would fit"));
  CHECK_THROWS_AS(plan_grid(sphere, 0.5, {1e-9, {}}, 0, 1), OutOfBudget);  // too many voxels across for any memory
  CHECK_THROWS_WITH(plan_grid(sphere, 0.5, {}, 1000, 1), Catch::Contains("mesh itself does not fit"));
}

TEST_CASE("plan: voxels far larger than the mesh and its offset are refused", "[plan]") {
  const Surface sphere = surface_of(shapes::icosphere(1, 2));
  const double coarsest = 4 * (sphere.facts.diagonal + 0.1);
  CHECK(plan_grid(sphere, 0.1, {0.999 * coarsest, {}}, 0, 1).voxel_size == 0.999 * coarsest);
  for (const double size : {1.001 * coarsest, 1e21}) {
    CHECK_THROWS_AS(plan_grid(sphere, 0.1, {size, {}}, 0, 1), OutOfBudget);
    CHECK_THROWS_AS(plan_grid(sphere, 0.1, {{}, 0.1 / size}, 0, 1), OutOfBudget);
  }
}

TEST_CASE("plan: an automatic size grows until it fits", "[plan]") {
  const Surface sphere = surface_of(shapes::icosphere(1, 4));
  const GridPlan free = plan_grid(sphere, 0.05, {}, 0, 1), tight = plan_grid(sphere, 0.05, {}, free.bytes - 1, 1);
  CHECK(tight.voxel_size > free.voxel_size);
  CHECK(tight.bytes < free.bytes);
  CHECK_THAT(tight.reason, Catch::Contains("memory"));
}

TEST_CASE("plan: lengths that single precision cannot hold are refused", "[plan]") {
  const Surface sphere = surface_of(shapes::icosphere(1, 2));
  CHECK_THROWS_AS(plan_grid(sphere, 1e160, {}, 0, 1), InvalidInput);
  CHECK_THROWS_AS(plan_grid(sphere, 1e-160, {}, 0, 1), InvalidInput);
  CHECK_THROWS_AS(plan_grid(sphere, 0.1, {1e200, {}}, 0, 1), InvalidInput);
  CHECK_THROWS_AS(plan_grid(sphere, 0.1, {{}, 1e-300}, 0, 1), InvalidInput);
  CHECK_THROWS_AS(plan_grid(surface_of(shapes::icosphere(1e40, 2)), 1e39, {}, 0, 1), InvalidInput);
}

TEST_CASE("plan: a mesh without extent is refused", "[plan]") {
  Polygons point;
  point.positions = {{1, 1, 1}};
  point.add_face({0, 0, 0});
  CHECK_THROWS_AS(plan_grid(surface_of(point), 0.1, {}, 0, 1), InvalidInput);
}

/// Small parts far apart, whose leaf nodes their area says nothing of.
static Polygons debris() {
  Polygons all;
  for (int i = 0; i < 200; ++i) {
    const Polygons part = shapes::icosphere(0.002, 0);
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    const Vec3d shift(i * 37 % 200, i * 91 % 200, i * 53 % 200);
    for (const Vec3d& p : part.positions) all.positions.push_back(p + shift / 100.0);
    for (std::size_t f = 0; f < part.face_count(); ++f)
      all.add_face({first + part.corners[3 * f], first + part.corners[3 * f + 1], first + part.corners[3 * f + 2]});
  }
  return all;
}

TEST_CASE("plan: leaf nodes are estimated within a factor of two", "[plan]") {
  struct Case {
    Polygons mesh;
    double distance;
  };
  for (const Case& c : {Case{shapes::icosphere(1, 4), 0.1},
                        {shapes::icosphere(1, 4), -0.1},
                        {shapes::box(Vec3d(1), 8, true), 0.02},
                        {shapes::plates(1, 0.02, 0.3, 8), 0.05},
                        {shapes::torus(1, 0.3, 64, 32), 0.05},
                        {debris(), 0.004}}) {
    Surface surface = surface_of(c.mesh);
    const GridPlan plan = plan_grid(surface, c.distance, {}, 0, 1);
    to_local_frame(surface, plan.voxel_size);
    const DistanceField field =
        sweep(rasterise(surface, {plan.voxel_size, plan.band}), surface, {Solver::Closest, plan.reach});
    const auto truth = static_cast<double>(field.phi->tree().leafCount());
    CHECK(static_cast<double>(plan.leaf_nodes) > truth / 2);
    CHECK(static_cast<double>(plan.leaf_nodes) < truth * 2.5);
  }
}

TEST_CASE("plan: leaf nodes are estimated as many as there will be, or a third more", "[plan]") {
  const std::pair<const char*, Polygons> shapes[] = {{"cube", shapes::box(Vec3d(1.0), 16, false)},
                                                     {"bumpy sphere", shapes::bumpy_sphere(1, 0.35, 1.2, 7, 4)},
                                                     {"gear", shapes::gear(18, 0.8, 1, 0.3, 0.3, 6)},
                                                     {"torus", shapes::torus(1, 0.4, 160, 64)},
                                                     {"hollow box", shapes::hollow_box(1, 0.02, 32)}};
  for (const auto& [name, shape] : shapes) {
    for (const double share : {0.002, 0.01, 0.05})
      for (const double voxels : {1.0, 3.0}) {
        Surface surface = surface_of(shape);
        const double distance = share * surface.facts.diagonal;
        const GridPlan plan = plan_grid(surface, distance, {distance / voxels, {}}, 0, 1);
        if (plan.leaf_nodes > 20000) continue;
        to_local_frame(surface, plan.voxel_size);
        const DistanceField field = sweep(rasterise(surface, {plan.voxel_size, plan.band}), surface, {{}, plan.reach});
        CAPTURE(name, share, voxels);
        CHECK(plan.leaf_nodes >= field.phi->tree().leafCount());
        CHECK(plan.leaf_nodes <= 4 * field.phi->tree().leafCount() / 3 + 4);  // a few are soon a third
      }
  }
}
