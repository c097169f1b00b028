#pragma once

#include <optional>
#include <span>

#include "vdb_offset/curve_offset/curve_faults.h"
#include "vdb_offset/paths/propagate.h"

namespace vdb_offset {

// As far from where it came from, in distances, a point may be put when it is spread over the front.
inline constexpr double kFarthestSpread = 8;

/// How near to each other points in order may be.
enum class Spacing { AsItIs, Even };

/// The place at a point's distance that lies straight over or under `x`, if that is on the side asked for and no
/// farther than kFarthestSpread from the point.
std::optional<Vec2d> place_on_front(const PlaneCurves& curves, Vec2d x, std::uint32_t point);

/// Puts points that have overtaken each other back in the order of their curve, to places on the front.
///
/// Where the front turns in on itself, points arrive beyond where those do that come after them. The front runs as the
/// source does that is closest to it, so that what has arrived, sorted by its closest point, is the front itself as a
/// line of points. The places along it that keep the curve's order and move points least, in the sense of least squares
/// (found by pooling adjacent violators: Barlow et al., Statistical Inference under Order Restrictions, 1972), are
/// where they are put, each to its exact distance, and apart by a fifth of what they are on the source: by less where
/// the front has no room for that twice, or where they were nearer already, and in order. All that takes the time of
/// sorting. Points that have not arrived stay where they are, as do those that would have to go too far: the result may
/// have faults.
///
/// With Spacing::Even those in order are treated alike: where the front turns in on itself, and they have crowded at
/// its corner without overtaking each other, they go apart by that share, too.
///
/// `way` leads from each point's source to its place. Curves with points that stay put, or with both signs of distance,
/// are left alone. Returns how many points have been put elsewhere. The result does not depend on the number of
/// threads.
std::size_t put_in_order(const PlaneCurves& curves, const Paths& paths, std::span<Vec2d> way,
                         Spacing spacing = Spacing::AsItIs);

}  // namespace vdb_offset
