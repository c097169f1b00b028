// SPDX-License-Identifier: Apache-2.0
#include "hold/held_field.h"

#include <algorithm>
#include <cmath>

namespace vdb_offset::cad {
namespace {

/// The four cubic B-splines that count at a place, by its share of the way from one node to the next.
std::array<double, 4> cubic_weights(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
}

}  // namespace

std::size_t HeldField::Hash::operator()(const Node& node) const {
  std::size_t hash = 0;
  for (const std::int64_t index : node) hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x9e3779b97f4a7c15U;
  return hash ^ (hash >> 29);
}

HeldField::Reach HeldField::reach_of(const gp_Pnt& point) const {
  Reach reach;
  for (int k = 0; k < 3; ++k) {
    const double at = point.Coord(k + 1) / spacing_;
    reach.first[k] = static_cast<std::int64_t>(std::ceil(at - kReach));
    reach.last[k] = static_cast<std::int64_t>(std::floor(at + kReach));
  }
  return reach;
}

void HeldField::lower(const gp_Pnt& point, double share) {
  if (share >= 1) return;
  const auto [first, last] = reach_of(point);
  Node node;
  for (node[0] = first[0]; node[0] <= last[0]; ++node[0])
    for (node[1] = first[1]; node[1] <= last[1]; ++node[1])
      for (node[2] = first[2]; node[2] <= last[2]; ++node[2]) {
        double& coefficient = coefficients_.emplace(node, 1).first->second;
        coefficient = std::min(coefficient, share);
      }
}

bool HeldField::is_even_around(const gp_Pnt& point, double share) const {
  const auto [first, last] = reach_of(point);
  Node node;
  for (node[0] = first[0]; node[0] <= last[0]; ++node[0])
    for (node[1] = first[1]; node[1] <= last[1]; ++node[1])
      for (node[2] = first[2]; node[2] <= last[2]; ++node[2]) {
        const auto at = coefficients_.find(node);
        if ((at == coefficients_.end() ? 1 : at->second) != share) return false;
      }
  return true;
}

double HeldField::operator()(const gp_Pnt& point) const {
  Node first;
  std::array<std::array<double, 4>, 3> weights;
  for (int k = 0; k < 3; ++k) {
    const double at = point.Coord(k + 1) / spacing_, below = std::floor(at);
    first[k] = static_cast<std::int64_t>(below) - 1;
    weights[k] = cubic_weights(at - below);
  }
  double held = 0;  // by how much it is less than 1
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        const auto at = coefficients_.find({first[0] + i, first[1] + j, first[2] + k});
        if (at != coefficients_.end()) held += weights[0][i] * weights[1][j] * weights[2][k] * (1 - at->second);
      }
  return 1 - held;
}

}  // namespace vdb_offset::cad
