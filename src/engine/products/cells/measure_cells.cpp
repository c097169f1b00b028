// SPDX-License-Identifier: Apache-2.0
// Measures the cells over layers from their numbers alone, without making the mesh. Four columns of prisms in a row go
// together, layer by layer, and each triangle serves the prisms below and above it. Any other column is made as a small
// mesh of its own, whose cells are measured one by one. The volume is that between one origin and the faces of the
// boundary: the wall, the outer side and the open sides. Columns are summed up in blocks of a fixed size, and blocks
// are added in order, so that the result does not depend on the number of threads. Measures come in the order of cells
// that make_cells() has. An invalid cell is measured as any other; nothing is refused here.
#include "products/cells/measure_cells.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/layers/column_cells.h"
#include "products/layers/column_mesh.h"
#include "products/volume/cell_quality.h"
#include "products/volume/prism_quality_columns.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

class CellMeasurer {
 public:
  CellMeasurer(const LayersResult& layers, const LayerCells& cells) : layers_(layers), cells_(cells) {}

  LayerQuality measure() {
    result_.points = cells_.point_count();
    if (cells_.count() == 0) return std::move(result_);
    result_.types.resize(cells_.in_layer(0));
    if (!cells_.columns.is_first_alike()) result_.upper_types.resize(cells_.columns.upper.cells.back());
    result_.wall_angle.resize(cells_.in_layer(0));
    origin_ = stack(cells_.columns.corners[0])[0];
    std::vector<float>* const fields[] = {&result_.scaled_jacobian, &result_.aspect_ratio};
    for_each_index(
        2, [&](std::size_t i) { fields[i]->resize(cells_.count()); }, 1);
    const std::size_t columns = cells_.columns.count();
    std::vector<double> six_volumes((columns + kBlock - 1) / kBlock, 0);
    for_each_index(
        six_volumes.size(),
        [&](std::size_t b) {
          ColumnMesh column;
          const std::size_t end = std::min(columns, (b + 1) * kBlock);
          six_volumes[b] = measure_columns(b * kBlock, end, column);
        },
        1);
    result_.volume = std::accumulate(six_volumes.begin(), six_volumes.end(), 0.0) / 6;
    return std::move(result_);
  }

 private:
  // Columns whose volumes are summed up in order by one thread. For speed alone; not measured.
  static constexpr std::size_t kBlock = 1024;

  const Vec3d* stack(Index point) const { return layers_.stacks.of(cells_.points.vertex[point]).data(); }

  /// Measures the columns begin .. end - 1. Returns six times the volume of their cells.
  double measure_columns(std::size_t begin, std::size_t end, ColumnMesh& column) {
    double six_volumes = 0;
    while (begin < end) {
      const std::size_t prisms = begin + PrismQualityColumns::kCount;
      if (prisms <= end && are_of_prisms(begin, prisms)) {
        six_volumes += measure_prisms(begin);
        begin = prisms;
      } else {
        six_volumes += measure_column(begin++, column);
      }
    }
    return six_volumes;
  }
  bool are_of_prisms(std::size_t begin, std::size_t end) const {
    while (begin < end && cells_.is_of_prisms(begin)) ++begin;
    return begin == end;
  }

  void set(std::size_t cell, const CellQuality& quality) {
    result_.scaled_jacobian[cell] = static_cast<float>(quality.jacobian);
    result_.aspect_ratio[cell] = static_cast<float>(quality.aspect);
  }

  double measure_prisms(std::size_t begin) {
    const std::size_t first = cells_.cell(0, begin);
    PrismQualityColumns columns{.layers = cells_.layers,
                                .in_layer = cells_.in_layer(0),
                                .scaled_jacobian = result_.scaled_jacobian.data() + first,
                                .aspect_ratio = result_.aspect_ratio.data() + first,
                                .wall_angle = result_.wall_angle.data() + first,
                                .origin = origin_.asPointer()};
    double sides = 0;
    for (std::size_t i = 0; i < PrismQualityColumns::kCount; ++i) {
      const auto ring = cells_.columns.ring(begin + i);
      for (std::size_t k = 0; k < 3; ++k) columns.stack[k][i] = stack(ring[k])->asPointer();
      result_.types[first + i] = CellType::Prism;
      sides += six_volumes_at_sides(begin + i);
    }
    const SixVolumes six_volumes = measure_prism_columns(columns);
    return std::accumulate(six_volumes.begin(), six_volumes.end(), sides);
  }

  double measure_column(std::size_t c, ColumnMesh& column) {
    const auto ring = cells_.columns.ring(c);
    const std::size_t corners = ring.size();
    std::vector<Index> feet(corners);
    ColumnMesh::Base base{ring};
    if (is_over_ridge_or_beside(c)) {
      for (std::size_t k = 0; k < corners; ++k) feet[k] = cells_.points.foot(ring[k]);
      base.feet = feet;
      if (!cells_.columns.splits.empty())
        base.splits = std::span(cells_.columns.splits).subspan(cells_.columns.begin[c], corners);
    }
    column.begin(base, [&](Index k) { return cells_.points.flat(ring[k]); });
    set_types(c, column);
    for (std::size_t layer = 0; layer < cells_.layers; ++layer) {
      const VolumeMesh& mesh = column.at(layer, [&](Index k) { return stack(ring[k]); });
      for (std::size_t i = 0; i < mesh.cell_count(); ++i) set(cells_.cell(layer, c) + i, cell_quality(mesh, i));
    }
    std::vector<Index> face;
    double six_volumes = six_volumes_at_sides(c);
    const auto add = [&](std::span<const Index> of, Index) { six_volumes += six_volumes_under(of); };
    cells_.columns.column(cells_.points, c, 0).visit_below(face, add);
    cells_.columns.column(cells_.points, c, cells_.layers - 1).visit_above(face, add);
    return six_volumes;
  }

  /// Whether the first cell of a column may differ from the others: its corners share a point of the wall, or a side is
  /// split.
  bool is_over_ridge_or_beside(std::size_t c) const {
    const auto ring = cells_.columns.ring(c);
    if (cells_.columns.is_first_alike()) return false;
    if (!cells_.columns.splits.empty()) return true;
    return std::any_of(ring.begin(), ring.end(), [&](Index p) { return cells_.points.foot(p) != p; });
  }
  void set_types(std::size_t c, ColumnMesh& column) {
    const auto copy = [](const std::vector<CellType>& from, std::vector<CellType>& to, std::size_t at) {
      std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(at));
    };
    copy(column.types(0), result_.types, cells_.cell(0, c));
    if (!result_.upper_types.empty()) copy(column.types(1), result_.upper_types, cells_.columns.upper.cells[c]);
    std::fill_n(result_.wall_angle.begin() + static_cast<std::ptrdiff_t>(cells_.cell(0, c)), column.types(0).size(),
                angle_at_wall(cells_.columns.ring(c)));
  }

  /// Not a number where the column has no face on the wall.
  float angle_at_wall(std::span<const Index> ring) const {
    for (std::size_t k = 0; k < ring.size(); ++k)
      if (cells_.points.foot(ring[k]) == cells_.points.foot(ring[(k + 1) % ring.size()]))
        return std::numeric_limits<float>::quiet_NaN();
    std::vector<Vec3d> wall, first;
    for (const Index p : ring) wall.push_back(stack(p)[0]), first.push_back(stack(p)[1]);
    return static_cast<float>(wall_angle(wall, first));
  }

  double six_volumes_at_sides(std::size_t c) const {
    const auto ring = cells_.columns.ring(c);
    double sum = 0;
    for (Index k = 0; k < ring.size(); ++k) {
      if (cells_.columns.open[cells_.columns.begin[c] + k] == 0) continue;
      for (std::size_t layer = 0; layer < cells_.layers; ++layer) {
        std::array<Index, 4> face;
        const Index size = cells_.columns.column(cells_.points, c, layer).side(k, face);
        if (size > 0) sum += six_volumes_under(std::span(face).first(size));
      }
    }
    return sum;
  }
  double six_volumes_under(std::span<const Index> face) const {
    return six_volumes_below(face, origin_, [&](Index p) -> const Vec3d& { return position(p); });
  }
  const Vec3d& position(Index point) const {
    const LayerPoints& points = cells_.points;
    if (point < points.wall()) return stack(point)[0];  // the first stack on a point of the wall has its number
    const Index above = point - points.wall();
    return stack(points.rising[above % points.risen()])[above / points.risen() + 1];
  }

  const LayersResult& layers_;
  const LayerCells& cells_;
  Vec3d origin_{0.0};  // volumes are summed up between here and the faces of the boundary
  LayerQuality result_;
};

}  // namespace

LayerQuality measure_cells(const LayersResult& layers, const LayerCells& cells) {
  VDB_OFFSET_ASSERT(cells.layers == layers.count());
  return CellMeasurer(layers, cells).measure();
}

}  // namespace vdb_offset
