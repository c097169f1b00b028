// SPDX-License-Identifier: Apache-2.0
#include "products/periodic/repeated_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "ground/numbers/disjoint_sets.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

// How far the number of turns in a circle may be off a whole one. Reasoned: an angle of four digits is taken.
constexpr double kOffWhole = 1e-3;

/// How many periods there are on each side of the mesh, and whether they close a circle.
struct Row {
  int before = 1, after = 1;
  bool is_ring = false;
};

/// The number of turns in a circle.
int turns_of(const PeriodicMotion& motion) {
  const double turns = 360 / std::abs(motion.angle);
  if (!(turns >= 2 - kOffWhole) || std::abs(turns - std::round(turns)) > kOffWhole * turns)
    throw InvalidInput(
        fmt::format("periodic: expected an angle that a whole circle is a multiple of, up to 180 degrees, got {:.10g}",
                    motion.angle));
  return static_cast<int>(std::round(turns));
}

/// The angle by which a point near the axis has to be turned to go so far, degrees; of the nearest point of a mesh.
double angle_that_goes(double reach, PolygonView mesh, const PeriodicMotion& motion) {
  double nearest = std::numeric_limits<double>::infinity();
  Vec3d axis = motion.axis;
  axis.normalize(0.0);
  for (const Index v : mesh.corners) {
    const Vec3d from = mesh.positions[v] - motion.point;
    nearest = std::min(nearest, (from - axis * axis.dot(from)).length());
  }
  if (reach >= 2 * nearest) return 180;
  return 2 * std::asin(reach / (2 * nearest)) * 180 / std::numbers::pi;
}

Row row_of(PolygonView mesh, const PeriodicMotion& motion, double reach) {
  // More copies than this are refused by memory; only the number must not overflow.
  constexpr double kMost = 1e6;
  if (motion.angle == 0) {
    const int side = static_cast<int>(std::clamp(std::ceil(reach / motion.shift.length()), 1.0, kMost));
    return {side, side, false};
  }
  const int turns = turns_of(motion);
  const int side =
      std::max(1, static_cast<int>(std::ceil(angle_that_goes(reach, mesh, motion) / std::abs(motion.angle))));
  if (2 * side + 1 >= turns) return {0, turns - 1, true};
  return {side, side, false};
}

/// The powers of the motion: that of the mesh first.
std::vector<int> powers_of(const Row& row) {
  std::vector<int> powers{0};
  for (int j = 1; j <= row.after; ++j) powers.push_back(j);
  for (int j = 1; j <= row.before; ++j) powers.push_back(-j);
  return powers;
}

/// The copies' vertices, numbered copy by copy, joined where a copy ends and the next one begins.
DisjointSets joined_copies(const PeriodicPairs& pairs, const Row& row, std::span<const int> powers) {
  const std::size_t count = pairs.image.size();
  DisjointSets joined(powers.size() * count);
  for (std::size_t i = 0; i < powers.size(); ++i) {
    const int wanted = row.is_ring && powers[i] == row.after ? 0 : powers[i] + 1;
    const auto next = static_cast<std::size_t>(std::ranges::find(powers, wanted) - powers.begin());
    if (next == powers.size()) continue;
    for (std::size_t v = 0; v < count; ++v)
      if (const Index image = pairs.image[v]; image != kNone)
        joined.join(static_cast<Index>(i * count + image), static_cast<Index>(next * count + v));
  }
  return joined;
}

}  // namespace

RepeatedMesh::RepeatedMesh(PolygonView mesh, const PeriodicPairs& pairs, double reach) {
  const Row row = row_of(mesh, pairs.motion, reach);
  const std::vector<int> powers = powers_of(row);
  copies_ = powers.size();
  const std::size_t count = mesh.positions.size();
  if (copies_ * std::max(count, mesh.corners.size()) >= kNone)
    throw InvalidInput(fmt::format(
        "periodic: expected layers thin enough for fewer copies of the period, got {} copies (ask for thinner layers)",
        copies_));
  const auto at = [&](std::size_t copy, Index v) { return static_cast<Index>(copy * count + v); };
  DisjointSets joined = joined_copies(pairs, row, powers);
  std::vector<Index> number(copies_ * count, kNone);
  for (std::size_t i = 0; i < copies_; ++i) {
    const PeriodicMotion motion = pairs.motion.times(powers[i]);
    // Vertices in no face, and those that others stand for, are left out of copies.
    for (const Index v : mesh.corners) {
      const Index known = joined.first(at(i, v));
      if (i == 0 || number[known] != kNone) continue;
      number[known] = static_cast<Index>(polygons_.positions.size());
      polygons_.positions.push_back(motion(mesh.positions[v]));
      origin_.push_back(v);
    }
    if (i == 0) {
      polygons_.positions.assign(mesh.positions.begin(), mesh.positions.end());
      for (Index v = 0; v < count; ++v) number[v] = v, origin_.push_back(v);
    }
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      for (const Index v : mesh.face(f)) polygons_.corners.push_back(i == 0 ? v : number[joined.first(at(i, v))]);
      polygons_.close_face();
    }
  }
}

}  // namespace vdb_offset
