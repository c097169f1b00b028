// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "motion/paths/propagate.h"
#include "products/curves/curve_faults.h"

namespace vdb_offset {

// The largest displacement of a point that is spread over the front, as a multiple of its distance: farther off, its
// segments would run across what lies between. Not measured.
inline constexpr double kFarthestSpread = 8;

/// How near to each other points that are in order may be: as near as they are; no nearer than points out of order; or
/// that, and besides apart by no more than half as much again as their neighbours are.
enum class Spacing { AsItIs, Even, Graded };

/// The position at a point's distance straight over or under `x`, if it is on the side asked for and its distance from
/// the point's source is no more than kFarthestSpread allows.
std::optional<Vec2d> position_on_front(const PlaneCurves& curves, Vec2d x, std::uint32_t point);

/// Puts points that have overtaken each other back in the order of their curve, to positions on the front.
///
/// Where the front turns in on itself, points arrive beyond the points that follow them on the curve. The front runs in
/// the direction of the source that is closest to it: points that have arrived, sorted by their closest points, are the
/// front itself as a line of points. Points are put to the positions along it that keep the curve's order and move them
/// least, in the sense of least squares (found by pooling adjacent violators: Barlow et al., Statistical Inference
/// under Order Restrictions, 1972), each at its exact distance, and apart by a fifth of their spacing on the source; by
/// less where the front has no room for twice of that, or where they were nearer already, and in order. The cost is
/// that of sorting. Points that have not arrived stay where they are, as do points that would have to go too far: the
/// result may have faults.
///
/// With Spacing::Even, points that are in order, but have crowded at a corner of the front, go apart by that share,
/// too.
///
/// With Spacing::Graded, what two neighbours are farther apart than half as much again as others beside them are, or
/// as they are on the source, is spread over those to both sides: each next one takes two thirds of the one before.
///
/// Curves with points that stay, or with both signs of distance, are left alone. Returns the number of points that were
/// moved. The result does not depend on the number of threads.
/// \param displacement from each point's source to its position
std::size_t put_in_order(const PlaneCurves& curves, const Paths& paths, std::span<Vec2d> displacement,
                         Spacing spacing = Spacing::AsItIs);

}  // namespace vdb_offset
