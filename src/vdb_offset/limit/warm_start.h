#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/parts/constrained_surface.h"

namespace vdb_offset {

/// What became of an offset that goes farther than another of the same surface, to the same side. Where the nearer one
/// folds or meets itself, that does so, too, and much of what has been found to free the one frees the other.
struct WarmStart {
  Distances distances;               ///< Of the body's vertices, as is all that follows.
  std::vector<Vec3d> way;            ///< To where each has ended up; world units.
  std::vector<double> achieved;      ///< The distance there.
  std::vector<std::uint8_t> mended;  ///< 1 if that is not where its path had led.
  std::vector<std::uint8_t> pulled;  ///< 1 if it was pulled back at some time, as part of what was wrong,
  std::vector<std::uint8_t> held;    ///< 1 if it does not go its whole way.
  bool much_wrong = false;           ///< There was too much wrong to try everything.
};

/// For each of several sets of distances the number of the one that it follows: the farthest that is nowhere nearer nor
/// to another side, and no more than four times as far, of those that follow none. Its own number if there is none.
std::vector<std::size_t> find_precedents(std::span<const Distances> distances);

/// The way of one of the body's vertices to where, on its straight way to another place, it has an exact distance
/// (world units, > 0) from the front; all of it if it ends no farther than that, unless such a place is found before.
/// Should that place not be found, one at the distance on the line from the front to the end. What lies on the way is
/// not looked at.
Vec3d way_to_distance(const ConstrainedSurface& constrained, std::uint32_t vertex, const Vec3d& way, double distance);

}  // namespace vdb_offset
