// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/foam_quality.h"
#include "vdb_offset/layer_facts.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/patch_names.h"
#include "vdb_offset/spread.h"

namespace vdb_offset {

/// Figures of the layers on a part of the wall, or on all of it. On curves, faces are segments and areas lengths.
struct LayerFigures {
  std::string name;  ///< Of the patch.
  std::array<std::size_t, kFaceRoleCount> faces_by_role{};
  std::array<std::size_t, kCellTypeCount> cells_by_type{};
  std::size_t cells = 0, transition_cells = 0;
  double area = 0;                ///< Of the faces that were asked to carry layers, world units^2.
  double layers_reached = 0;      ///< Number of layers times the share of heights kept, mean over that area.
  double coverage = 0;            ///< Share of that area whose faces have all of their heights at all of their corners.
  Spread asked, reached;          ///< Thickness of all layers, means over faces' corners, by area; world units.
  std::size_t full_vertices = 0;  ///< Vertices that keep all of their heights. Copies of a position count separately.
  /// Relative errors of the first heights of those vertices: the largest, and the 99 % quantile.
  double first_error = 0, first_error_99 = 0;
  Spread scaled_jacobian, aspect_ratio;  ///< Of cells (see cell_quality.h).
  std::size_t inverted_cells = 0;        ///< Cells whose scaled Jacobian is not above 0.
  Spread wall_angle;                     ///< Degrees, of the cells at the wall: 0 is best.
};

struct LayerReport {
  std::size_t layers = 0;
  LayerFigures all;
  std::vector<LayerFigures> patches;  ///< In the order of the walls in VolumeMesh::patches.
  bool plane = false;                 ///< Layers on curves.
  double least_segment = 1;           ///< See LayerQuality.
  double volume = 0;                  ///< Of all cells, world units^3; on curves their area, ^2.
  std::size_t points = 0;
  LayerStatistics growing;
  std::optional<FoamQuality> foam;       ///< If a mesh has been written for OpenFOAM.
  std::size_t inverted_block_cells = 0;  ///< Cells of a structured block that was written, with a Jacobian not above 0.
  std::size_t turned_faces = 0, border_sides = 0, unpaired_sides = 0, split_points = 0, coincident_sides = 0;
};

/// Sums up layers and the cells over them, for each boundary patch and for all.
/// \param names of the faces
/// \throw InvalidInput as require_names()
VDB_OFFSET_API LayerReport report_layers(PolygonView mesh, const LayersResult& layers, const WallNames& names,
                                         const LayerCellFacts& facts, const LayerQuality& quality);

/// A few lines of text for a terminal, each with a line end.
VDB_OFFSET_API std::string summary(const LayerReport& report);

}  // namespace vdb_offset
