#pragma once

#include <vector>

#include "vdb_offset/layers/cells/number_cells.h"
#include "vdb_offset/volume/volume_mesh.h"

namespace vdb_offset {

/// What is measured of the cells over layers.
struct LayerQuality {
  std::vector<CellType> types;  ///< Of a layer's cells.
  /// Of all cells, layer by layer: see cell_quality.h.
  std::vector<float> scaled_jacobian, aspect_ratio;
  std::vector<float> wall_angle;  ///< Degrees, of a layer's cells, in whose column it is: see cell_quality.h.
  double volume = 0;              ///< Of all cells, world units^3; of those in a plane their area, ^2.
  std::size_t points = 0;
  bool plane = false;
  /// On curves: the shortest segment of any layer, as a share of the one that it stands on.
  double least_segment = 1;
};

/// Measures cells as they follow from their columns, without making them: where prisms stand on each other, each
/// triangle is looked at once for that above and that below it, in four columns at once. The result does not depend on
/// the number of threads. Cost: O(cells). \pre `cells` are those of `layers`.
LayerQuality measure_cells(const LayersResult& layers, const LayerCells& cells);

}  // namespace vdb_offset
