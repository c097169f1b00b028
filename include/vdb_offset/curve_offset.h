#pragma once

#include <span>
#include <vector>

#include "vdb_offset/curves.h"
#include "vdb_offset/layers.h"

namespace vdb_offset {

/// Offsets plane curves, open or closed, as offset() does surfaces: the same points, each at `distance` from the curves
/// in their plane or as near to that as its state says. Which side a positive distance leads to: see join_curves().
///
/// It is the surfaces' own machinery: the curves stand in their plane as a ribbon, whose field is a slab of leaf nodes,
/// one thick, and whose middle line is what moves. With Collision::Limit see limit_curves(). Of the options `only`,
/// `border`, `obstacles`, `off_source`, `weld` and `orient` do not count; of the facts of the mesh, "faces" are
/// segments. \throw InvalidInput for curves that do not lie in one plane or an option that cannot be used, OutOfBudget
/// before work that would not fit, Cancelled when the progress callback asks for it.
std::vector<OffsetResult> offset_curves(CurvesView curves, std::span<const Distances> distances,
                                        const OffsetOptions& options);

/// Grows layers on curves, as grow_layers() does on a mesh: one march goes to the outermost, which is made valid as
/// with Collision::Limit, and stack_curves() stands the others in between; cells are make_curve_cells()'s. \throw
/// InvalidInput as grow_layers() and offset_curves().
LayersResult grow_curve_layers(CurvesView curves, std::span<const Distances> heights, const OffsetOptions& options);

/// What offset_curves() would do, or grow_curve_layers() if there are layers, without doing it. \throw as
/// offset_curves()
OffsetStatistics plan_curves(CurvesView curves, std::span<const Distances> distances, const OffsetOptions& options,
                             std::size_t layers = 0);

}  // namespace vdb_offset
