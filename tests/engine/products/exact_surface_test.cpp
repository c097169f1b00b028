// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/polygons.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "vdb_offset/offset.h"

namespace vdb_offset {
namespace {

constexpr double kRadius = 2, kTube = 0.7, kHalf = 1.5;

/// A surface whose pieces are each told by a distance, with its gradient.
class Implicit : public ExactSurface {
 public:
  std::span<const Vec3d> corner_normals() const override { return normals; }
  std::span<const std::uint32_t> piece_of_face() const override { return pieces; }
  double deflection() const override { return most_off; }
  void bring_to_distances(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                          std::span<const double>, std::span<Vec3d> points) const override {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      for (int turn = 0; turn < 5; ++turn)
        for (const int piece : pieces_at[vertices[i]])
          points[i] += gradient(piece, points[i]) * (distances[i] - value(piece, points[i]));
  }
  std::vector<double> distance_errors(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                                      std::span<const double>, std::span<const Vec3d> points) const override {
    std::vector<double> errors(vertices.size(), 0.0);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      for (const int piece : pieces_at[vertices[i]])
        errors[i] = std::max(errors[i], std::abs(value(piece, points[i]) - distances[i]));
    return errors;
  }
  std::vector<double> distance_errors_near(std::span<const std::uint32_t> faces, std::span<const Vec3d>,
                                           std::span<const double> distances,
                                           std::span<const Vec3d> points) const override {
    std::vector<double> errors;
    for (std::size_t i = 0; i < faces.size(); ++i)
      errors.push_back(std::abs(value(static_cast<int>(pieces[faces[i]]), points[i]) - distances[i]));
    return errors;
  }
  virtual double value(int piece, const Vec3d& x) const = 0;
  virtual Vec3d gradient(int piece, const Vec3d& x) const = 0;

  Polygons mesh;
  std::vector<Vec3d> normals;
  std::vector<std::uint32_t> pieces;
  std::vector<std::vector<int>> pieces_at;
  double most_off = 0;

 protected:
  void add(int piece, std::initializer_list<std::uint32_t> face) {
    mesh.add_face(face);
    pieces.push_back(static_cast<std::uint32_t>(piece));
    pieces_at.resize(mesh.positions.size());
    for (const auto v : face) {
      normals.push_back(gradient(piece, mesh.positions[v]));
      auto& at = pieces_at[v];
      if (std::find(at.begin(), at.end(), piece) == at.end()) at.push_back(piece);
    }
  }
};

class Torus : public Implicit {
 public:
  Torus(std::uint32_t around, std::uint32_t across) {
    for (std::uint32_t i = 0; i < around; ++i)
      for (std::uint32_t j = 0; j < across; ++j) {
        const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across,
                     ring = kRadius + kTube * std::cos(v);
        mesh.positions.emplace_back(ring * std::cos(u), ring * std::sin(u), kTube * std::sin(v));
      }
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return (i % around) * across + j % across; };
    for (std::uint32_t i = 0; i < around; ++i)
      for (std::uint32_t j = 0; j < across; ++j) {
        add(0, {at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        add(0, {at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    most_off = (kRadius + kTube) * (1 - std::cos(std::numbers::pi / around)) +
               kTube * (1 - std::cos(std::numbers::pi / across));
  }
  double value(int, const Vec3d& x) const override {
    return std::hypot(std::hypot(x.x(), x.y()) - kRadius, x.z()) - kTube;
  }
  Vec3d gradient(int, const Vec3d& x) const override {
    const double ring = std::hypot(x.x(), x.y());
    const Vec3d centre(x.x() * kRadius / ring, x.y() * kRadius / ring, 0);
    return (x - centre).unit();
  }
};

/// A cylinder along z: its flank is piece 0, its ends are 1 and 2.
class Cylinder : public Implicit {
 public:
  explicit Cylinder(std::uint32_t around) {
    for (const double z : {-kHalf, kHalf})
      for (std::uint32_t i = 0; i < around; ++i) {
        const double u = 2 * std::numbers::pi * i / around;
        mesh.positions.emplace_back(kRadius * std::cos(u), kRadius * std::sin(u), z);
      }
    mesh.positions.emplace_back(0, 0, -kHalf);
    mesh.positions.emplace_back(0, 0, kHalf);
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t next = (i + 1) % around;
      add(0, {i, next, next + around});
      add(0, {i, next + around, i + around});
      add(1, {next, i, 2 * around});
      add(2, {i + around, next + around, 2 * around + 1});
    }
    most_off = kRadius * (1 - std::cos(std::numbers::pi / around));
  }
  double value(int piece, const Vec3d& x) const override {
    if (piece > 0) return (piece == 1 ? -x.z() : x.z()) - kHalf;
    return std::hypot(x.x(), x.y()) - kRadius;
  }
  Vec3d gradient(int piece, const Vec3d& x) const override {
    if (piece > 0) return {0, 0, piece == 1 ? -1.0 : 1.0};
    return Vec3d(x.x(), x.y(), 0).unit();
  }
};

/// The most by which a vertex is off its distance from its pieces of the surface, as a share of the distance.
double most_off(const Implicit& surface, const std::vector<Vec3d>& positions, double distance) {
  double most = 0;
  for (std::size_t v = 0; v < positions.size(); ++v)
    for (const int piece : surface.pieces_at[v])
      most = std::max(most, std::abs(surface.value(piece, positions[v]) - distance) / std::abs(distance));
  return most;
}

std::size_t count(const std::vector<VertexState>& states, VertexState state) {
  return static_cast<std::size_t>(std::count(states.begin(), states.end(), state));
}

OffsetOptions options_for(const Implicit* surface, double distance) {
  OffsetOptions options;
  options.distance = Distances(distance);
  options.exact = surface;
  return options;
}

}  // namespace

TEST_CASE("exact surface: vertices are at the distance from it, on both sides of a bend", "[exact]") {
  const Torus torus(60, 24);
  for (const double distance : {0.2, -0.2}) {
    const OffsetResult result = offset(torus.mesh.view(), options_for(&torus, distance));
    CHECK(count(result.states, VertexState::Reached) == torus.mesh.positions.size());
    CHECK(most_off(torus, result.positions, distance) < 1e-10);
    CHECK(*std::min_element(result.achieved.begin(), result.achieved.end()) >= std::abs(distance) * (1 - 1e-6));
    CheckOptions check;
    check.distance = Distances(distance);
    check.exact = &torus;
    const CheckResult checked = check_offset(torus.mesh.view(), result.positions, check);
    CHECK(checked.valid());
    CHECK(count(checked.states, VertexState::Reached) == torus.mesh.positions.size());
    // Without the surface, the triangles are all there is: inside of a bend they are nearer.
    CHECK(most_off(torus, offset(torus.mesh.view(), options_for(nullptr, distance)).positions, distance) > 1e-3);
  }
}

TEST_CASE("exact surface: miters are those of its faces", "[exact]") {
  const Cylinder cylinder(40);
  OffsetOptions options = options_for(&cylinder, 0.3);
  options.corners = Corners::Miter;
  const OffsetResult result = offset(cylinder.mesh.view(), options);
  CHECK(count(result.states, VertexState::Mitered) == 80);
  CHECK(most_off(cylinder, result.positions, 0.3) < 1e-10);
  options.distance = Distances(-0.3);
  options.corners = Corners::Round;
  const OffsetResult inward = offset(cylinder.mesh.view(), options);
  CHECK(count(inward.states, VertexState::Reached) == 82);
  CHECK(most_off(cylinder, inward.positions, -0.3) < 1e-10);
}

TEST_CASE("exact surface: of a part, its own faces are measured", "[exact]") {
  const Cylinder cylinder(40);
  OffsetOptions options = options_for(&cylinder, 0.3);
  for (const std::uint32_t piece : cylinder.pieces) options.only.push_back(piece == 2);
  const OffsetResult result = offset(cylinder.mesh.view(), options);
  CHECK(result.positions.back().z() == Approx(kHalf + 0.3).epsilon(1e-12));
  REQUIRE(result.statistics.exact);
  CHECK(result.statistics.exact->vertices > 0);
  CHECK(result.statistics.exact->worst < 1e-9);
}

TEST_CASE("exact surface: what something else is nearer to does not count as reached", "[exact]") {
  // The hole of the torus is 1.3 wide from the axis: at 1.4, its vertices meet those from the other side.
  const Torus torus(60, 24);
  const OffsetResult result = offset(torus.mesh.view(), options_for(&torus, 1.4));
  for (std::size_t v = 0; v < result.states.size(); ++v) {
    if (result.states[v] != VertexState::Reached) continue;
    CHECK(std::abs(torus.value(0, result.positions[v]) - 1.4) <= torus.deflection());
  }
  CHECK(count(result.states, VertexState::Reached) < torus.mesh.positions.size());
  CHECK(result.statistics.limit.left.total() == 0);
}

}  // namespace vdb_offset
