#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/layers.h"
#include "vdb_offset/layers/growth_columns.h"
#include "vdb_offset/limit/limit.h"
#include "vdb_offset/parts/border_slide.h"
#include "vdb_offset/paths/propagate.h"
#include "vdb_offset/progress.h"
#include "vdb_offset/validity/fault_finder.h"

namespace vdb_offset {

/// Layers over a body's vertices.
struct LayerStack {
  VertexStacks stacks;
  std::vector<double> share;           ///< Of its heights that each vertex keeps, 0 .. 1.
  std::vector<double> first_achieved;  ///< Exact distance of the first layer's vertices, world units.
  LayerStatistics statistics;
};

/// VertexStacks layers between a body's vertices and where these ended up, of which `paths` tells; what is still wrong
/// with the outermost surface, `faults` does. `heights` are those of the body's vertices, one set for each layer.
///
/// The layers of a vertex lie on a curve that leaves the surface in the vertex's own direction, as nearly at right
/// angles as validity allows, and bends towards its end; there, where the exact distance is what was asked for. Those
/// of a bound vertex lie where `slides`, if there are any, lead it. Layers
/// are thinned by one share for all layers of a vertex until every cell is valid (GrowthColumns) and nothing is wrong
/// with the outermost surface; so are neighbours, so that no thickness differs by more than half the length of the edge
/// between them. Then they are let out again as far as all stays so. `paths` receives what became of the outermost
/// surface. The result does not depend on the number of threads.
LayerStack stack_layers(const ConstrainedSurface& constrained, const BorderSlides* slides, const GrowthColumns& columns,
                        std::span<const Vec3d> source, std::span<const Distances> heights, FaultFinder& faults,
                        Paths& paths, const ProgressCallback& progress = {});

/// Puts layers where a file has them that keeps coordinates so precisely, and tells their first and last distances
/// there, by distance_at(vertex, place), which is called in parallel; not of vertices that it has none for. The wall
/// stays, and what is not written.
void round_layers(std::span<const Vec3d> source, const Rounding& precision,
                  const std::function<bool(std::uint32_t)>& is_written,
                  const std::function<std::optional<double>(std::uint32_t, const Vec3d&)>& distance_at,
                  LayerStack& stack, Paths& paths);

/// Tells once layers are grown how many vertices of their outermost surface are held back, and what was taken from them
/// since they had gone these `distances_before` that.
void count_held_back(const Paths& paths, const Distances& asked, std::span<const double> distances_before,
                     LimitStatistics& statistics);

}  // namespace vdb_offset
