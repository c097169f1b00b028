// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/distances.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "vdb_offset/run.h"

namespace vdb_offset {

Distances::Distances(double uniform) : uniform_(uniform) {
  if (!std::isfinite(uniform)) throw InvalidInput("distance: expected a finite number");
  extend(uniform);
}

Distances::Distances(std::vector<double> each) : each_(std::move(each)) {
  for (std::size_t v = 0; v < each_.size(); ++v) {
    if (!std::isfinite(each_[v]))
      throw InvalidInput("distance: expected a finite number for each vertex, got none for vertex " +
                         std::to_string(v) + " (counted from 0)");
    extend(each_[v]);
  }
}

Distances::Distances(std::vector<double> each, std::vector<double> at_corner) : Distances(std::move(each)) {
  at_corner_ = std::move(at_corner);
  for (const double distance : at_corner_) {
    if (!std::isfinite(distance)) throw InvalidInput("distance: expected a finite number for each corner");
    extend(distance);
  }
}

void Distances::extend(double distance) {
  outward_ = std::max(outward_, distance);
  inward_ = std::max(inward_, -distance);
}

void require_fan_angle(double angle) {
  // Neighbours in a fan that are closer make cells that are longer than any solver likes. Not measured.
  constexpr double kLeast = 5, kMost = 180;
  if (!(angle == 0 || (angle >= kLeast && angle <= kMost)))
    throw InvalidInput("fan angle: expected 0 or 5 .. 180 degrees, got " + std::to_string(angle));
}

std::vector<Distances> copied_to(std::span<const Distances> distances, std::span<const std::uint32_t> origin) {
  std::vector<Distances> copied;
  for (const Distances& of_source : distances) {
    if (of_source.uniform()) {
      copied.push_back(of_source);
      continue;
    }
    std::vector<double> each;
    each.reserve(origin.size());
    for (const std::uint32_t v : origin) each.push_back(of_source[v]);
    copied.emplace_back(std::move(each));
  }
  return copied;
}

void require_heights(std::span<const Distances> heights, std::size_t vertices) {
  if (heights.empty()) throw InvalidInput("layers: expected a height, got none");
  for (const Distances& each : heights) {
    if (each.outward() > 0 && each.inward() > 0)
      throw InvalidInput("layers: expected heights to one side, got some above 0 and some below");
  }
  if (heights.back().scale() == 0) throw InvalidInput("layers: expected a height other than 0");
  const bool uniform = std::all_of(heights.begin(), heights.end(), [](const Distances& d) { return d.uniform(); });
  const bool inward = heights.back().inward() > 0;
  for (std::size_t k = 0; k < heights.size(); ++k)
    for (std::size_t v = 0; v < (uniform ? 1 : vertices); ++v) {
      const double below = k > 0 ? heights[k - 1][v] : 0, here = heights[k][v];
      if (inward ? here < below : here > below) continue;
      if (here == 0 && heights.back()[v] == 0) continue;  // a vertex that stays has height 0 in all layers
      throw InvalidInput("layers: expected heights that rise from the wall on, got " + std::to_string(here) +
                         " behind " + std::to_string(below) +
                         (uniform ? "" : " at vertex " + std::to_string(v) + " (counted from 0)"));
    }
}

}  // namespace vdb_offset
