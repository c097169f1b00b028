// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/curves.h"
#include "vdb_offset/layers.h"

namespace vdb_offset {

/// Offsets plane curves, open or closed, as offset_several() does surfaces: the points get positions at `distance` from
/// the curves in their plane, or as near to that as their states say. Which side a positive distance leads to: see
/// join_curves().
///
/// The stages are those of surfaces: a ribbon stands on the curves, its field is a slab of leaf nodes, one thick, and
/// the line half way up the ribbon is what moves. For Collision::Limit see limit_curves(). The options `only`,
/// `border`, `obstacles`, `off_source`, `weld` and `orient` have no effect; in the facts of the mesh, "faces" are
/// segments. \throw InvalidInput for curves that do not lie in one plane or an option that cannot be used, OutOfBudget
/// before work that would not fit, Cancelled when the progress callback asks for it.
VDB_OFFSET_API std::vector<OffsetResult> offset_curves(CurvesView curves, std::span<const Distances> distances,
                                                       const OffsetOptions& options);

/// Grows layers on curves, as grow_layers() does on a mesh: one march goes to the outermost layer, which is made valid
/// as with Collision::Limit, and stack_curves() puts the others in between. For their cells see make_curve_cells().
/// \throw InvalidInput as grow_layers() and offset_curves().
VDB_OFFSET_API LayersResult grow_curve_layers(CurvesView curves, std::span<const Distances> heights,
                                              const OffsetOptions& options);

/// Tells what offset_curves() would do, or grow_curve_layers() if there are layers, without doing it. \throw as
/// offset_curves()
VDB_OFFSET_API OffsetStatistics plan_curves(CurvesView curves, std::span<const Distances> distances,
                                            const OffsetOptions& options, std::size_t layers = 0);

}  // namespace vdb_offset
