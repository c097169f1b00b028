// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/options.h"
#include "vdb_offset/result.h"
#include "vdb_offset/vertex_stacks.h"

namespace vdb_offset {

/// What cells have to fulfil to be valid.
enum class CellRules : std::uint8_t {
  AnySolver,  ///< Positive volumes and Jacobians (see GrowthColumns).
  OpenFoam,   ///< In addition, OpenFOAM's checkMesh must find no face of a cell oriented wrongly (foam_quality.h).
};

/// What growing layers found and did.
struct LayerStatistics {
  std::size_t wrong_columns = 0;     ///< Columns that had an invalid cell before anything was thinned.
  std::size_t straightened = 0;      ///< Vertices whose layers stand on a straight line, to make such cells valid.
  std::size_t rounds = 0;            ///< Rounds in which layers were thinned or let out again.
  std::size_t thinned_vertices = 0;  ///< Vertices of the surface that keep less than all of their heights.
  std::size_t flat_vertices = 0;     ///< Vertices of the surface that keep no height, although they were asked to.
};

/// What growing knows of the mesh's faces. What it does not know is looked for when cells are numbered.
struct KnownSides {
  /// Each side of a column of cells has one partner, and no column repeats another.
  bool paired = false;
  /// Layers rise from all faces on the side that the heights' sign says.
  bool none_turned = false;
};

/// Layers on a mesh: one surface for each height, of the mesh's vertices and faces.
struct VDB_OFFSET_API LayersResult {
  SharedStacks stacks;  ///< Of the input's vertices: on the wall, which is the mesh itself, and at each height.
  /// Of each input vertex: the first vertex that it moves with; kNone if it is in no face. Empty on curves.
  std::vector<std::uint32_t> welded_to;
  std::vector<Distances> heights;      ///< Asked of each input vertex, one set a layer; all of one sign.
  std::vector<double> share;           ///< Of each input vertex: the share of its heights that it keeps, 0 .. 1.
  std::vector<VertexState> states;     ///< Of the outermost surface's vertices.
  std::vector<double> achieved;        ///< Exact distance of the outermost surface's vertices, world units.
  std::vector<double> first_achieved;  ///< Exact distance of the first layer's vertices, world units.
  /// Of each face of the input: 0 if it carries no layers, since it is not offset or has no area; 1 if it carries
  /// layers; 2 or 3 if it is a quad that carries them as two triangles, on both sides of its diagonal from corner 0
  /// or 1. Empty: all faces carry layers.
  std::vector<std::uint8_t> carries;
  KnownSides known;
  OffsetStatistics statistics;
  LayerStatistics layer_statistics;

  /// Number of layers.
  std::size_t count() const { return heights.size(); }
};

/// Grows layers of cells on a mesh's faces. One march passes all heights, and exact distances are at each of them (1e-6
/// relative) where a vertex keeps all of its heights. The cells over the faces are valid by `rules`, and cross neither
/// each other nor the wall: where they would, all layers of the vertices there are thinned by one share, which changes
/// by no more than a bounded step from neighbour to neighbour. A vertex that cannot move at all has the share 0, and
/// its cells have no height there.
/// \param heights of the layers from the wall outward: all above 0 or all below, in rising order of size at each
/// vertex; 0 in all layers leaves a vertex where it is
/// \param options without effect: `distance`, `collision` and `keep_paths`
/// \throw InvalidInput as offset_several(), and for heights that do not rise, or are of both signs.
VDB_OFFSET_API LayersResult grow_layers(PolygonView mesh, std::span<const Distances> heights,
                                        const OffsetOptions& options, CellRules rules = CellRules::AnySolver);

}  // namespace vdb_offset
