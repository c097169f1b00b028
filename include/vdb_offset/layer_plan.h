// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/distances.h"

/// Heights of layers from what is known of them.
namespace vdb_offset {

/// What is asked of layers, each of which is thicker by one factor than that below. Known are the count and two of the
/// others; or the first height, one of `total` and `last`, and the growth, which is then the largest that is allowed.
/// Lengths are in world units, below 0 inward; a vertex where one of them is 0 has no layers.
struct LayerPlan {
  std::optional<std::size_t> count;
  std::optional<double> growth;    ///< Each layer's thickness by that of the one below, above 0.
  std::optional<Distances> first;  ///< Thickness of the first layer.
  std::optional<Distances> total;  ///< Thickness of all layers together.
  std::optional<Distances> last;   ///< Thickness of the outermost layer.
};

/// Planned layers are at most so many, and grow by no more than so much from one to the next.
inline constexpr std::size_t kMostLayers = 1000;
inline constexpr double kMostGrowth = 10;

/// The heights of layers above the wall, from there on. What follows from two lengths follows at each vertex, so that
/// the growth may differ between vertices; the count is the least one with which it is nowhere larger than is allowed.
/// \throw InvalidInput for another number of known ones, lengths of different signs or counts of vertices, or layers
/// that would have to be more than kMostLayers or to grow by more than kMostGrowth
VDB_OFFSET_API std::vector<Distances> plan_layers(const LayerPlan& plan);

/// How many times as thick layers are as those below, to six digits behind the point; both 0 for less than two layers.
struct LayerGrowth {
  double least = 0, largest = 0;
};

/// The growth of layers at all vertices that have any. \param heights above the wall, from there on
VDB_OFFSET_API LayerGrowth growth_of(std::span<const Distances> heights);

/// The height over a wall at which y+ has a value, for the flow along a flat plate at the end of a length, as a share
/// of that length: y / L = y+ / (Re sqrt(c_f / 2)). The coefficient of friction c_f is the larger one of a turbulent
/// layer's, (2 log10 Re - 0.65)^-2.3 (Schlichting, Boundary-Layer Theory, 7th edition, 1979, chapter 21), and a laminar
/// one's, 0.664 / sqrt(Re) (Blasius). \throw InvalidInput unless y+ and the Reynolds number of that length are above 0
/// and finite
VDB_OFFSET_API double height_of_y_plus(double y_plus, double reynolds);

}  // namespace vdb_offset
