// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motion/parts/constrained_surface.h"
#include "vdb_offset/distances.h"

namespace vdb_offset {

/// What became of a finished offset, for nearer offsets of the same surface to the same side to start from. Where a
/// nearer one folds or meets itself, the farther one does so, too, and much of what frees the one frees the other.
/// Each vector has a value for each vertex of the constrained surface.
struct WarmStart {
  Distances distances;
  std::vector<Vec3d> displacement;      ///< To where the vertex has ended up; world units.
  std::vector<double> achieved;         ///< The distance there, world units.
  std::vector<std::uint8_t> mended;     ///< 1 if that is not where the vertex's path had led.
  std::vector<std::uint8_t> pulled;     ///< 1 if the vertex was pulled back at some time, as part of a fault.
  std::vector<std::uint8_t> held_back;  ///< 1 if the vertex does not go its whole displacement.
  bool many_faults = false;             ///< There were too many faults to try everything (see kManyFaults).
};

/// For each of several sets of distances, the number of the set that its offset starts from: the farthest set that is
/// nowhere nearer and nowhere to another side, no more than four times as far, and has no warm start itself. The set's
/// own number if there is none.
std::vector<std::size_t> find_warm_starts(std::span<const Distances> distances);

/// Shortens a displacement of a vertex of the constrained surface so that the vertex has an exact distance (world
/// units, > 0) from the moving part. The whole displacement if it ends no farther away than that, unless such a
/// position is found before. Should none be found on the displacement, one at the distance on the line from the moving
/// part to the end. Obstacles and crossings on the way are not looked for.
Vec3d displacement_to_distance(const ConstrainedSurface& constrained, std::uint32_t vertex, const Vec3d& displacement,
                               double distance);

}  // namespace vdb_offset
