// SPDX-License-Identifier: Apache-2.0
#include "support/random_scenes.h"

#include <openvdb/math/Quat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>

#include "support/solids.h"
#include "vdb_offset/shapes.h"

namespace vdb_offset::test {
namespace {

// Distributions of the standard library differ from one to the next; this does not.
class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  int pick(int count) { return static_cast<int>(engine_() % static_cast<unsigned>(count)); }

 private:
  std::mt19937 engine_;
};

/// A ring with a chamfer below, of any angle.
Polygons chamfered_ring(Dice& dice) {
  const double wide = dice.between(0.05, 0.3), high = dice.between(0.05, 0.3);
  const std::array<std::array<double, 2>, 5> profile{{{0.4, 0}, {1 - wide, 0}, {1, high}, {1, 0.8}, {0.4, 0.8}}};
  return lathe(profile, static_cast<std::uint32_t>(4 + dice.pick(20)));
}

/// A ring whose hole has a countersink of any angle.
Polygons countersunk_ring(Dice& dice) {
  const double wide = dice.between(0.1, 0.4), deep = dice.between(0.05, 0.5);
  const std::array<std::array<double, 2>, 5> profile{
      {{0.3, 0}, {1, 0}, {1, 0.8}, {0.3 + wide, 0.8}, {0.3, 0.8 - deep}}};
  return lathe(profile, static_cast<std::uint32_t>(4 + dice.pick(20)));
}

Polygons random_shape(Dice& dice, bool& closed) {
  const int kind = dice.pick(14);
  closed = kind < 7 || kind > 10;
  switch (kind) {
    case 0:
      return shapes::box(Vec3d(1, dice.between(0.05, 1), dice.between(0.2, 2)), 3 + dice.pick(8), dice.pick(2) == 0);
    case 1:
      return shapes::torus(1, dice.between(0.1, 0.6), 12 + dice.pick(30), 6 + dice.pick(14));
    case 2:
      return shapes::bumpy_sphere(1, dice.between(0.1, 0.6), dice.between(1, 4), static_cast<unsigned>(dice.pick(1000)),
                                  3);
    case 3:
      return shapes::gear(5 + dice.pick(10), 0.7, dice.between(0.8, 1.2), 0.3, dice.between(0.05, 0.5), 2);
    case 4:
      return shapes::hollow_box(1, dice.between(0.02, 0.3), 4 + dice.pick(5));
    case 5:
      return shapes::plates(1, dice.between(0.02, 0.3), dice.between(0.005, 0.3), 4 + dice.pick(8));
    case 6:
      return shapes::cylinder(dice.between(0.1, 1), 1, 8 + dice.pick(20), 3 + dice.pick(5), 2 + dice.pick(3));
    case 7:
      return shapes::patch(1, dice.between(0, 0.3), 6 + dice.pick(12));
    case 8:
      return shapes::wedge(dice.between(20, 160), 1, 1, 4 + dice.pick(8));
    case 9:
      return shapes::diffuser(dice.between(0.2, 0.6), dice.between(0.6, 1.2), 1, 5 + dice.pick(10));
    case 10:
      return nose_strip(dice.between(0.1, 1), dice.between(0.3, 1), dice.between(1.2, 2.5), dice.between(1, 20), 40);
    case 11:
      return letter_c(static_cast<std::uint32_t>(4 + dice.pick(20)));
    case 12:
      return chamfered_ring(dice);
    default:
      return countersunk_ring(dice);
  }
}

unsigned number_from_environment(const char* name, unsigned otherwise) {
  const char* text = std::getenv(name);
  return text ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : otherwise;
}

}  // namespace

Seeds random_seeds(unsigned count) {
  const unsigned first = number_from_environment("VDB_OFFSET_RANDOM_FIRST", 1);
  const unsigned most = number_from_environment("VDB_OFFSET_RANDOM_MOST", count);
  return {first, first + number_from_environment("VDB_OFFSET_RANDOM_COUNT", std::min(count, most))};
}

Polygons crumpled_box(unsigned seed) {
  constexpr int kDivisions = 4;
  constexpr double kMost = 0.9 / kDivisions;
  Polygons mesh = shapes::box(Vec3d(1), kDivisions, true);
  Dice dice(seed);
  for (Vec3d& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] += dice.between(-kMost, kMost);
  return mesh;
}

RandomScene random_scene(unsigned seed) {
  Dice dice(seed);
  RandomScene scene;
  scene.mesh = random_shape(dice, scene.closed);
  const Vec3d axis(dice.between(-1, 1), dice.between(-1, 1), dice.between(0.1, 1)),
      move(dice.between(-10, 10), dice.between(-10, 10), dice.between(-10, 10));
  const openvdb::math::Quat<double> turn(axis.unit(), dice.between(0, 2 * M_PI));
  const double scale = std::pow(10.0, dice.between(-2, 2)), jitter = dice.pick(2) ? dice.between(0, 0.01) : 0;
  for (Vec3d& p : scene.mesh.positions) {
    for (int k = 0; k < 3; ++k) p[k] += dice.between(-jitter, jitter);
    p = (turn.rotateVector(p) + move) * scale;
  }
  scene.distance = scale * std::pow(10.0, dice.between(-2.5, -0.5)) * (dice.pick(3) == 0 ? -1 : 1);
  return scene;
}

}  // namespace vdb_offset::test
