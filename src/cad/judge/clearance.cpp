// SPDX-License-Identifier: Apache-2.0
#include "judge/clearance.h"

#include <algorithm>
#include <map>
#include <utility>

#include "ground/numbers/disjoint_sets.h"

namespace vdb_offset::cad {
namespace {

const Soup::Facing kAny{nullptr, gp_Vec(0, 0, 0), 1};

constexpr double kFine = 1e-3;  // of a gap

/// Narrows `most` to the distance of a segment from triangles, to a thousandth of it, or to `fine`: by halves, as the
/// middle of one shows how near its ends may be.
void narrow(const gp_Pnt& from, const gp_Pnt& to, const Soup& other, double fine, double& most) {
  const gp_Pnt middle((from.XYZ() + to.XYZ()) / 2);
  const double half = from.Distance(to) / 2;
  const Soup::Nearest nearest = other.nearest(middle, most + half, kAny);
  if (nearest.triangle < 0) return;
  most = std::min(most, nearest.distance);
  if (half <= std::max(kFine * most, fine)) return;
  narrow(from, middle, other, fine, most);
  narrow(middle, to, other, fine, most);
}

void narrow_by_sides(const Soup& of, const Soup& other, double fine, double& most) {
  for (const Soup::Triangle& t : of.triangles())
    for (int k = 0; k < 3; ++k) narrow(t.points[k], t.points[(k + 1) % 3], other, fine, most);
}

}  // namespace

double gap_between(const Soup& one, const Soup& other, double most) {
  const double fine = kFine * kFine * most;
  narrow_by_sides(one, other, fine, most);
  narrow_by_sides(other, one, fine, most);
  return most;
}

std::vector<Soup> connected_parts(const std::vector<gp_Pnt>& points,
                                  const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::map<std::array<double, 3>, std::uint32_t> numbers;  // of places
  std::vector<std::uint32_t> place;
  for (const gp_Pnt& point : points) {
    const auto at = numbers.emplace(std::array{point.X(), point.Y(), point.Z()}, numbers.size()).first;
    place.push_back(at->second);
  }
  DisjointSets joined(numbers.size());
  for (const auto& triangle : triangles)
    for (const int k : {1, 2}) joined.join(place[triangle[0]], place[triangle[k]]);
  std::map<std::uint32_t, std::vector<std::array<std::uint32_t, 3>>> parts;
  for (const auto& triangle : triangles) parts[joined.first(place[triangle[0]])].push_back(triangle);
  std::vector<Soup> soups;
  soups.reserve(parts.size());
  for (const auto& [first, part] : parts) soups.emplace_back(points, part);
  return soups;
}

}  // namespace vdb_offset::cad
