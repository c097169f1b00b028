// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "vdb_offset/offset.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

OffsetResult mitered(const Polygons& mesh, double distance) {
  OffsetOptions options;
  options.distance = distance;
  options.corners = Corners::Miter;
  return offset(mesh.view(), options);
}

/// A pyramid over a crooked quad: of its five vertices one has four planes, which no point is on once they have moved.
Polygons crooked_pyramid() {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {2.4, 2, 0}, {0, 1.5, 0}, {0.8, 0.7, 1.5}};
  mesh.add_face({3, 2, 1, 0});
  for (std::uint32_t k = 0; k < 4; ++k) mesh.add_face({k, (k + 1) % 4, 4});
  return mesh;
}

}  // namespace

TEST_CASE("face error: what miters put farther away is told apart", "[faces]") {
  // Each face of the cube reaches 0.2 beyond the edges of the face that it comes from.
  const OffsetResult result = mitered(shapes::box(Vec3d(2, 2, 2), 1, false), 0.2);
  const FaceError& faces = result.statistics.faces;
  CHECK(faces.mean < 1e-9);
  CHECK(faces.at_distance == 1);
  CHECK(faces.beyond == 0);
  constexpr int kSteps = 400;
  double sum = 0;
  const auto over = [](int i) { return std::max(0.0, std::abs(2.4 * (i + 0.5) / kSteps - 1.2) - 1); };
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) sum += std::hypot(0.2, over(i), over(j)) / 0.2 - 1;
  CHECK(faces.farther == Approx(sum / kSteps / kSteps).epsilon(0.02));
  const OffsetOptions round{.distance = 0.2, .corners = Corners::Round};
  CHECK(offset(shapes::box(Vec3d(2, 2, 2), 1, false).view(), round).statistics.faces.farther == 0);
}

TEST_CASE("face error: planes that no point is on are too far away", "[faces]") {
  const Polygons mesh = crooked_pyramid();
  for (const double distance : {0.1, -0.1}) {
    const OffsetResult result = mitered(mesh, distance);
    CAPTURE(distance);
    // By the planes of the four faces: how far the tip is beyond each, and the share of their area that is affected.
    double farthest = 0;
    for (std::size_t f = 1; f < mesh.face_count(); ++f) {
      const auto face = mesh.view().face(f);
      const Vec3d &a = mesh.positions[face[0]], &b = mesh.positions[face[1]], &tip = mesh.positions[4];
      const Vec3d normal = (b - a).cross(tip - a).unit();
      farthest = std::max(farthest, normal.dot(result.positions[4] - tip) / distance - 1);
    }
    const FaceError& faces = result.statistics.faces;
    CHECK(faces.most_beyond <= farthest);
    CHECK(faces.most_beyond > 0.85 * farthest);
    CHECK(faces.beyond > 0.2);
    CHECK(faces.beyond <= 1 - faces.at_distance);
    CHECK(faces.corners == Approx(1).epsilon(1e-6));
    const CheckResult check =
        check_offset(mesh.view(), result.positions, {.distance = distance, .corners = Corners::Miter});
    CHECK(check.faces.beyond == faces.beyond);
    CHECK(check.faces.farther == Approx(faces.farther));
  }
}

TEST_CASE("face error: faces at a wall without room are off for that", "[faces]") {
  // A square tube with two walls of 0.45, which have no room for two distances, and two of 1.85.
  Polygons frame;
  for (const double z : {0.0, 5.5})
    for (const auto& [x, y] : {std::pair{0.0, 0.0},
                               {6.0, 0.0},
                               {6.0, 18.0},
                               {0.0, 18.0},
                               {0.45, 1.85},
                               {5.55, 1.85},
                               {5.55, 16.15},
                               {0.45, 16.15}})
      frame.positions.emplace_back(x, y, z);
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    frame.add_face({k, next, next + 8, k + 8});
    frame.add_face({next + 4, k + 4, k + 12, next + 12});
    frame.add_face({next, k, k + 4, next + 4});
    frame.add_face({k + 8, next + 8, next + 12, k + 12});
  }
  for (const Corners corners : {Corners::Round, Corners::Miter}) {
    OffsetOptions options;
    options.distance = -0.25;
    options.corners = corners;
    const FaceError faces = offset(frame.view(), options).statistics.faces;
    CHECK(faces.mean > 0.1);
    CHECK(faces.no_room == Approx(1).epsilon(1e-3));
    CHECK(faces.beyond == 0);
    options.distance = -0.2;
    CHECK(offset(frame.view(), options).statistics.faces.mean < 1e-9);
  }
}
