// SPDX-License-Identifier: Apache-2.0
#include "space/surface/orientation.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "support/oracles.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using test::share;

namespace {

OffsetOptions by(double distance, Orient orient) {
  OffsetOptions options;
  options.distance = distance;
  options.orient = orient;
  return options;
}

Polygons reversed(Polygons mesh) {
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    std::reverse(mesh.corners.begin() + mesh.face_begin[f], mesh.corners.begin() + mesh.face_begin[f + 1]);
  return mesh;
}

Polygons moved(Polygons mesh, const Vec3d& by) {
  for (Vec3d& p : mesh.positions) p += by;
  return mesh;
}

void append(Polygons& mesh, const Polygons& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (std::size_t f = 0; f < other.face_count(); ++f) {
    for (const auto v : other.view().face(f)) mesh.corners.push_back(first + v);
    mesh.close_face();
  }
}

/// Spheres around the origin, the largest first; those below zero point inward.
Polygons shells(std::initializer_list<double> radii) {
  Polygons mesh;
  for (const double r : radii) {
    const Polygons sphere = shapes::icosphere(std::abs(r), 2);
    append(mesh, r > 0 ? sphere : reversed(sphere));
  }
  return mesh;
}

std::size_t inside_out(const Polygons& mesh) { return build_surface(mesh.view(), {}).facts.inside_out_components; }

/// Signed volume that the surface's own triangles enclose, times six.
double volume(const Surface& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles)
    sum += surface.vertices[a].dot(surface.vertices[b].cross(surface.vertices[c]));
  return sum;
}

}  // namespace

TEST_CASE("orientation: a sphere that is inside out shrinks as it points, or grows as a solid", "[orientation]") {
  const Polygons sphere = reversed(shapes::icosphere(1, 4));
  const OffsetResult keep = offset(sphere.view(), by(0.1, Orient::Keep)),
                     fixed = offset(sphere.view(), by(0.1, Orient::FixDirectionOnly));
  CHECK(keep.statistics.facts.inside_out_components == 1);
  CHECK(fixed.statistics.facts.inside_out_components == 1);
  CHECK(share(keep, VertexState::Reached) == 1);
  CHECK(share(fixed, VertexState::Reached) == 1);
  for (std::size_t v = 0; v < sphere.positions.size(); ++v) {
    CHECK(keep.positions[v].length() == Approx(0.9).epsilon(1e-3));
    CHECK(fixed.positions[v].length() == Approx(1.1).epsilon(1e-3));
  }
  // As if its faces pointed outward, to the last bit.
  CHECK(fixed.positions == offset(shapes::icosphere(1, 4).view(), by(0.1, Orient::Keep)).positions);
}

TEST_CASE("orientation: check measures on the side that the offset was made on", "[orientation]") {
  const Polygons sphere = reversed(shapes::icosphere(1, 3));
  const OffsetResult fixed = offset(sphere.view(), by(0.1, Orient::FixDirectionOnly));
  CheckOptions options;
  options.distance = 0.1;
  const CheckResult as_pointed = check_offset(sphere.view(), fixed.positions, options);
  CHECK(as_pointed.wrong_side == sphere.positions.size());
  CHECK_FALSE(as_pointed.valid());
  options.orient = Orient::FixDirectionOnly;
  CHECK(check_offset(sphere.view(), fixed.positions, options).valid());
  options.distance.reset();
  CHECK(check_offset(sphere.view(), fixed.positions, options).distance == Approx(0.1));
}

TEST_CASE("orientation: a cavity points inward and is right", "[orientation]") {
  const Polygons box = shapes::hollow_box(1, 0.1, 6);
  CHECK(inside_out(box) == 0);
  CHECK(build_surface(box.view(), {}).facts.closed_components == 2);
  CHECK(offset(box.view(), by(0.03, Orient::FixDirectionOnly)).positions ==
        offset(box.view(), by(0.03, Orient::Keep)).positions);
}

TEST_CASE("orientation: nested components are judged by how deep they lie", "[orientation]") {
  CHECK(inside_out(shells({3, -2, 1})) == 0);   // a hollow ball with a ball in it
  CHECK(inside_out(shells({3, -2, -1})) == 1);  // the ball in it is inside out
  CHECK(inside_out(shells({-3, -2})) == 1);     // the outer wall
  CHECK(inside_out(shells({-3, 2})) == 2);      // a hollow ball turned as a whole: so is its cavity
  CHECK(inside_out(shells({-3, 2, -1})) == 3);
  CHECK(inside_out(shells({3, 2})) == 0);  // a solid of its own inside another
  CHECK(inside_out(shells({4, -3, 2, -1})) == 0);
  CHECK(inside_out(shells({4, -3, -2, -1})) == 1);
}

TEST_CASE("orientation: what lies in a solid and points outward is counted, and is a cavity if that is asked for",
          "[orientation]") {
  const auto enclosed = [](const Polygons& mesh) { return build_surface(mesh.view(), {}).facts.enclosed_components; };
  CHECK(enclosed(shells({3, -2, 1})) == 0);
  CHECK(enclosed(shells({3, 2})) == 1);
  CHECK(enclosed(shells({4, 3, 2})) == 1);  // the innermost one lies in two others
  CHECK(enclosed(shells({-3, 2})) == 0);    // turned as a whole
  const double solid = volume(build_surface(shells({4, -3, 2, -1}).view(), {}));
  for (const auto& radii : {std::initializer_list<double>{4, 3, 2, 1}, {-4, 3, -2, 1}, {4, -3, 2, 1}, {4, -3, 2, -1}}) {
    const Surface right = build_surface(shells(radii).view(), {}, Orient::FixCavities);
    CHECK(volume(right) == Approx(solid));
    CHECK(right.facts.enclosed_components == 0);
  }
}

TEST_CASE("orientation: turned as solids, nested components enclose what they should", "[orientation]") {
  const double solid = volume(build_surface(shells({3, -2, 1}).view(), {}));
  for (const auto& radii : {std::initializer_list<double>{-3, 2, -1}, {3, -2, -1}, {-3, -2, 1}}) {
    const Surface turned = build_surface(shells(radii).view(), {}, Orient::FixDirectionOnly);
    CHECK(volume(turned) == Approx(solid));
    for (std::uint32_t e = 0; e < turned.next_around_edge.size(); ++e)
      CHECK(turned.from(e) == turned.to(turned.next_around_edge[e]));
  }
}

TEST_CASE("orientation: of two components side by side only the one inside out is turned", "[orientation]") {
  const Polygons ball = shapes::icosphere(1, 3);
  Polygons right = ball, mixed = ball;
  append(right, moved(ball, {4, 0.5, 0.25}));
  append(mixed, moved(reversed(ball), {4, 0.5, 0.25}));
  CHECK(inside_out(mixed) == 1);
  CHECK(offset(mixed.view(), by(0.1, Orient::FixDirectionOnly)).positions ==
        offset(right.view(), by(0.1, Orient::Keep)).positions);
  const OffsetResult keep = offset(mixed.view(), by(0.1, Orient::Keep));
  for (std::size_t v = 0; v < ball.positions.size(); ++v) CHECK(keep.positions[v].length() > 1.09);
  for (std::size_t v = ball.positions.size(); v < mixed.positions.size(); ++v)
    CHECK((keep.positions[v] - Vec3d(4, 0.5, 0.25)).length() < 0.91);
}

TEST_CASE("orientation: boxes whose edges line up are told apart", "[orientation]") {
  // Rays along the axes would run through edges and vertices here.
  Polygons mesh = reversed(shapes::box(Vec3d(4), 8, true));
  for (const Vec3d& at : {Vec3d(0), Vec3d(1, 0, 0), Vec3d(-1, 1, 1)})
    append(mesh, moved(shapes::box(Vec3d(0.5), 2, true), at));
  append(mesh, moved(shapes::box(Vec3d(0.5), 2, true), Vec3d(0, 0, 3)));
  CHECK(inside_out(mesh) == 4);  // all but the one above
  CHECK(inside_out(reversed(mesh)) == 1);
}

TEST_CASE("orientation: what is open or encloses nothing is not judged", "[orientation]") {
  CHECK(inside_out(reversed(shapes::patch(1, 0.2, 6))) == 0);
  Polygons open = reversed(shapes::icosphere(1, 2));
  open.corners.resize(open.corners.size() - 3);
  open.face_begin.pop_back();
  CHECK(inside_out(open) == 0);
  CHECK(build_surface(open.view(), {}).facts.closed_components == 0);
  // With an edge of three faces, too.
  Polygons finned = reversed(shapes::icosphere(1, 2));
  finned.positions.push_back({2, 2, 2});
  finned.add_face({finned.corners[0], finned.corners[1], static_cast<std::uint32_t>(finned.positions.size() - 1)});
  CHECK(inside_out(finned) == 0);
}

TEST_CASE("orientation: many nested components, the same for any number of threads", "[orientation][invariant]") {
  Polygons mesh = reversed(shapes::icosphere(20, 4));
  for (int i = 0; i < 200; ++i) {
    const Polygons ball = moved(shapes::icosphere(0.4, 1), Vec3d(i % 6 - 2.5, i / 6 % 6 - 2.5, i / 36 - 2.5) * 2.0);
    append(mesh, i % 3 == 0 ? reversed(ball) : ball);
  }
  CHECK(inside_out(mesh) == 1 + 133);  // the ball around them, and with it those that point outward in it
  OffsetOptions options = by(0.1, Orient::FixDirectionOnly);
  options.threads = 1;
  const OffsetResult one = offset(mesh.view(), options);
  options.threads = 2;
  CHECK(offset(mesh.view(), options).positions == one.positions);
}

TEST_CASE("the side of a point is that of the closest face, edge or vertex", "[orientation]") {
  const Polygons box = shapes::box({2, 2, 2}, 3, false);
  // Over a face, an edge and a corner; inside, and far away.
  for (const Vec3d& outside :
       {Vec3d(0.1, 0.2, 1.5), Vec3d(1.2, 1.3, 0.1), Vec3d(-1.1, -1.2, 1.3), Vec3d(50, -70, 20)}) {
    CHECK(side_of_point(box.view(), outside) == 1);
    CHECK(side_of_point(reversed(box).view(), outside) == -1);
    CHECK(side_of_point(reversed(box).view(), outside, {}, Orient::FixDirectionOnly) == 1);
  }
  CHECK(side_of_point(box.view(), {0.3, 0.1, -0.9}) == -1);
  CHECK(side_of_point(moved(box, {7e5, 0, 0}).view(), {7e5, 0.1, 0.9}) == -1);
  const Polygons sheet = shapes::patch(2, 0, 4);
  CHECK(side_of_point(sheet.view(), {0.1, 0.2, 0.3}) == 1);
  CHECK(side_of_point(sheet.view(), {5, 0.2, -0.1}) == -1);
  CHECK_THROWS_AS(side_of_point(box.view(), {1, 0.2, 0.3}), InvalidInput);
  CHECK_THROWS_AS(side_of_point(Polygons{}.view(), {1, 0.2, 0.3}), InvalidInput);
}
