// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "motion/parts/border_slide.h"
#include "motion/paths/propagate.h"
#include "products/layers/growth_columns.h"
#include "valid/faults/fault_finder.h"
#include "valid/limit/limit.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// Layers over the vertices of a constrained surface, or of a polyline.
struct LayerStack {
  VertexStacks stacks;
  std::vector<double> share;           ///< Of each vertex: the share of its heights that it keeps, 0 .. 1.
  std::vector<double> first_achieved;  ///< Exact distance of the first layer's vertices, world units.
  std::vector<double> stretch;         ///< See AskedLayers; empty if no vertex is mitered.
  LayerStatistics statistics;

  /// The height that the faces beside a vertex have, where the vertex is at a distance.
  double height_at(std::size_t v, double distance) const { return stretch.empty() ? distance : distance / stretch[v]; }
};

/// Stacks layers between a surface and the ends of its vertices' paths.
///
/// The layers of a vertex lie on a curve that leaves the surface in the vertex's own direction, as nearly at right
/// angles as validity allows, and bends towards the end of the path: on it, at the points whose exact distances are the
/// heights. The layers of a bound vertex lie where `slides` lead it, if there are any. Layers are thinned, by one share
/// for all layers of a vertex, until every cell is valid (GrowthColumns) and the outermost surface has no fault; so are
/// those of neighbours, so that no thickness differs by more than half the length of the edge between them. Then they
/// are let out again as far as all that holds. The result does not depend on the number of threads.
/// \param slides how border vertices slide; nullptr if none does
/// \param source positions of the surface's vertices, world coordinates
/// \param heights of the surface's vertices, one set for each layer
/// \param faults of the surface with its vertices at the ends of their paths; receives those that are left
/// \param paths of the surface's vertices; receive what became of the outermost surface
/// \param unspread what paths led to before their ends were spread (spread_ends.h): where that makes a cell invalid,
/// they lead there again. Empty: none is spread
LayerStack stack_layers(const ConstrainedSurface& constrained, const BorderSlides* slides, const GrowthColumns& columns,
                        std::span<const Vec3d> source, std::span<const Distances> heights, FaultFinder& faults,
                        Paths& paths, std::span<const Vec3d> unspread, const ProgressCallback& progress = {});

/// Rounds layers to the coordinates that a file keeps, and measures the distances of the first and the last of them
/// there. The wall stays as it is, and so do vertices that are not written.
/// \param distance_at the exact distance of a vertex at a position, or none if it is not to be measured. Called in
/// parallel.
void round_layers(std::span<const Vec3d> source, const Rounding& precision,
                  const std::function<bool(std::uint32_t)>& is_written,
                  const std::function<std::optional<double>(std::uint32_t, const Vec3d&)>& distance_at,
                  LayerStack& stack, Paths& paths);

/// Counts the vertices of the outermost surface that are held back, once layers are grown, and the thickness that they
/// have lost for that.
/// \param distances_before the distances of all vertices after the march
void count_held_back(const Paths& paths, const Distances& asked, std::span<const double> distances_before,
                     LimitStatistics& statistics);

}  // namespace vdb_offset
