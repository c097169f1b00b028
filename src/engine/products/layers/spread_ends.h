// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ground/numbers/index_set.h"
#include "motion/parts/constrained_surface.h"
#include "motion/paths/propagate.h"
#include "products/layers/growth_columns.h"
#include "valid/faults/fault_finder.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/layers.h"

namespace vdb_offset {

/// What is spread, and between what.
struct SpreadInput {
  const ConstrainedSurface& constrained;
  const GrowthColumns& columns;
  std::span<const Vec3d> source;  ///< Of the surface's vertices, world coordinates.
  const Distances& distances;     ///< Of the surface's vertices, to the outermost layer.
};

/// Of vertices whose ends were spread: those beside some vertices, and all that are connected with them. They go back
/// together, as each has made room for the others. Calls each_neighbour(v, visit), and visit(w) with each vertex beside
/// v.
template <class HasMoved, class EachNeighbour>
Indices spread_together(const Indices& some, std::size_t count, HasMoved&& has_moved, EachNeighbour&& each_neighbour) {
  IndexGatherer all(count);
  for (const auto v : some) all.add(v);
  for (std::size_t i = 0; i < all.so_far().size(); ++i)
    each_neighbour(all.so_far()[i], [&](std::uint32_t w) {
      if (has_moved(w)) all.add(w);
    });
  Indices vertices = all.take();
  std::erase_if(vertices, [&](std::uint32_t v) { return !has_moved(v); });
  return vertices;
}

/// Spreads the ends of paths that crowd at a concave edge or corner of the outermost surface over the surface beside
/// it, as curves do (products/curves/restore_order.h).
///
/// Heights are exact: all paths from the flat faces beside a concave edge end where the fronts of these meet. Vertices
/// at edges that are shorter than a fifth of the wall's there, and neighbours of these, ring by ring, until no such
/// edge is left, move to the weighted means of their neighbours: the equilibrium of springs as stiff as the edges of
/// the wall are short, each vertex at its distance. Vertices of sharp edges move along these, and corners, mitered and
/// bound ones stay; those that planes hold stay in these. Vertices that make a fault go back, with all that are spread
/// beside them. The result does not depend on the number of threads.
///
/// \param faults of the vertices at the ends of their paths; receives what is left there
/// \param paths receive the ends
/// \return the displacements of all vertices before that; empty if no vertex has moved
std::vector<Vec3d> spread_ends(const SpreadInput& input, FaultFinder& faults, Paths& paths);

/// Counts the vertices that crowd on the outermost layer.
/// \param paths to that layer
/// \param shares of their heights that the surface's vertices keep
void count_crowded(const SpreadInput& input, const Paths& paths, std::span<const double> shares,
                   LayerStatistics& statistics);

}  // namespace vdb_offset
