#include "vdb_offset/layer_quality.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

#include "vdb_offset/cell_quality.h"
#include "vdb_offset/cell_stack.h"
#include "vdb_offset/error.h"
#include "vdb_offset/parallel.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

/// The cells of one column by themselves: their points are numbered within it, those of the wall first.
class ColumnMesh {
 public:
  void begin(const LayerPoints& points, std::span<const Index> ring) {
    const auto corners = static_cast<Index>(ring.size());
    points_.vertex.resize(corners);
    ring_.resize(corners);
    std::iota(ring_.begin(), ring_.end(), 0);
    points_.in_layer.assign(corners, kNone);
    points_.rising.clear();
    for (Index k = 0; k < corners; ++k) {
      if (points.flat(ring[k])) continue;
      points_.in_layer[k] = points_.risen();
      points_.rising.push_back(k);
    }
    mesh_.points.resize(corners + points_.risen());
    mesh_.cell_types.clear();
    mesh_.corners.clear();
    mesh_.cell_begin.clear();
    CellStack(points_, ring_, 0)
        .visit_cells(
            [&](CellType type) {
              mesh_.cell_types.push_back(type);
              mesh_.cell_begin.push_back(mesh_.corners.size());
            },
            [&](Index corner) { mesh_.corners.push_back(corner); });
    mesh_.cell_begin.push_back(mesh_.corners.size());
  }

  /// `stack(k)` are the places of corner k in all layers, from the wall outward.
  template <class Stack>
  const VolumeMesh& at(std::size_t layer, Stack&& stack) {
    for (Index k = 0; k < ring_.size(); ++k) {
      mesh_.points[k] = stack(k)[points_.flat(k) ? 0 : layer];
      if (!points_.flat(k)) mesh_.points[points_.at(k, 1)] = stack(k)[layer + 1];
    }
    return mesh_;
  }
  const std::vector<CellType>& types() const { return mesh_.cell_types; }

 private:
  LayerPoints points_;
  std::vector<Index> ring_;
  VolumeMesh mesh_;
};

class CellMeasurer {
 public:
  CellMeasurer(const LayersResult& layers, const LayerCells& cells) : layers_(layers), cells_(cells) {}

  LayerQuality measure() {
    result_.points = cells_.point_count();
    if (cells_.count() == 0) return std::move(result_);
    result_.types.resize(cells_.in_layer());
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
          for (std::size_t c = b * kBlock; c < end; c += 2)
            six_volumes[b] += measure_two(c, std::min(c + 1, end - 1), column);
        },
        1);
    result_.volume = std::accumulate(six_volumes.begin(), six_volumes.end(), 0.0) / 6;
    return std::move(result_);
  }

 private:
  static constexpr std::size_t kBlock = 1024;
  // So many columns on, stacks that are far apart in memory are asked for.
  static constexpr std::size_t kAhead = 4;

  const Vec3d* stack(Index point) const { return layers_.stacks.of(cells_.points.vertex[point]).data(); }

  void prefetch(std::size_t c) const {
    constexpr std::size_t kLine = 64;
    if (c >= cells_.columns.count()) return;
    for (const Index p : cells_.columns.ring(c)) {
      const auto places = std::as_bytes(layers_.stacks.of(cells_.points.vertex[p]));
      for (std::size_t at = 0; at < places.size(); at += kLine) __builtin_prefetch(places.data() + at);
      __builtin_prefetch(&places.back());
    }
  }

  /// Six times the volume of both columns' cells.
  double measure_two(std::size_t c, std::size_t other, ColumnMesh& column) {
    prefetch(c + kAhead), prefetch(c + kAhead + 1);
    if (c != other && cells_.is_of_prisms(c) && cells_.is_of_prisms(other)) return measure_prisms(c, other);
    return measure_column(c, column) + (other != c ? measure_column(other, column) : 0);
  }

  void set(std::size_t layer, std::size_t cell, const CellQuality& quality) {
    const std::size_t at = layer * cells_.in_layer() + cell;
    result_.scaled_jacobian[at] = static_cast<float>(quality.jacobian);
    result_.aspect_ratio[at] = static_cast<float>(quality.aspect);
  }

  double measure_prisms(std::size_t c, std::size_t other) {
    const LayerColumns& columns = cells_.columns;
    std::array<const Vec3d*, 3> of, of_other;
    for (std::size_t k = 0; k < 3; ++k) {
      of[k] = stack(columns.ring(c)[k]);
      of_other[k] = stack(columns.ring(other)[k]);
    }
    const auto level = [&](std::size_t layer) {
      std::array<Way<Pair>, 3> corner;
      for (std::size_t k = 0; k < 3; ++k) corner[k] = both(of[k][layer], of_other[k][layer]);
      return PrismLevel<Pair>(corner);
    };
    for (const std::size_t each : {c, other}) result_.types[columns.cells[each]] = CellType::Prism;
    const Way<Pair> origin = both(origin_, origin_);
    // The levels above and below take turns: they are too large to be copied.
    std::array<PrismLevel<Pair>, 2> levels;
    levels[0] = level(0);
    Pair six_volumes = levels[0].normal.dot(origin - levels[0].corner[0]);
    for (std::size_t layer = 0; layer < cells_.layers; ++layer) {
      PrismLevel<Pair>&above = levels[(layer + 1) % 2], &below = levels[layer % 2];
      above = level(layer + 1);
      const QualityOf<Pair> quality = prism_quality_of(prism_squares(below, above));
      set(layer, columns.cells[c], {quality.jacobian[0], quality.aspect[0]});
      set(layer, columns.cells[other], {quality.jacobian[1], quality.aspect[1]});
    }
    const PrismLevel<Pair>& last = levels[cells_.layers % 2];
    six_volumes += last.normal.dot(last.corner[0] - origin);
    return six_volumes[0] + six_volumes[1] + six_volumes_at_sides(c) + six_volumes_at_sides(other);
  }

  double measure_column(std::size_t c, ColumnMesh& column) {
    const auto ring = cells_.columns.ring(c);
    column.begin(cells_.points, ring);
    const std::size_t first = cells_.columns.cells[c];
    std::copy(column.types().begin(), column.types().end(), result_.types.begin() + static_cast<std::ptrdiff_t>(first));
    for (std::size_t layer = 0; layer < cells_.layers; ++layer) {
      const VolumeMesh& mesh = column.at(layer, [&](Index k) { return stack(ring[k]); });
      for (std::size_t i = 0; i < mesh.cell_count(); ++i) set(layer, first + i, cell_quality(mesh, i));
    }
    std::vector<Index> face;
    double six_volumes = six_volumes_at_sides(c);
    const auto add = [&](std::span<const Index> corners, Index) { six_volumes += six_volumes_under(corners); };
    CellStack(cells_.points, ring, 0).visit_below(face, add);
    CellStack(cells_.points, ring, cells_.layers - 1).visit_above(face, add);
    return six_volumes;
  }

  double six_volumes_at_sides(std::size_t c) const {
    const auto ring = cells_.columns.ring(c);
    double sum = 0;
    for (Index k = 0; k < ring.size(); ++k) {
      if (cells_.columns.open[cells_.columns.begin[c] + k] == 0) continue;
      for (std::size_t layer = 0; layer < cells_.layers; ++layer) {
        std::array<Index, 4> face;
        const Index size = CellStack(cells_.points, ring, layer).side(k, face);
        if (size > 0) sum += six_volumes_under(std::span(face).first(size));
      }
    }
    return sum;
  }
  double six_volumes_under(std::span<const Index> face) const {
    return six_volumes_below(face, origin_, [&](Index p) -> const Vec3d& { return place(p); });
  }
  const Vec3d& place(Index point) const {
    const LayerPoints& points = cells_.points;
    if (point < points.wall()) return stack(point)[0];
    const Index above = point - points.wall();
    return stack(points.rising[above % points.risen()])[above / points.risen() + 1];
  }

  const LayersResult& layers_;
  const LayerCells& cells_;
  Vec3d origin_{0.0};  // volumes are those below the boundary's faces from here
  LayerQuality result_;
};

const std::vector<float>& values_of(const VolumeMesh& volume, const char* name) {
  for (const VolumeField& field : volume.cell_fields)
    if (field.name == name) return field.values;
  throw InvalidInput(std::string("layer_quality: expected cells with a field ") + name + ", got none");
}

}  // namespace

LayerQuality measure_cells(const LayersResult& layers, const LayerCells& cells) {
  return CellMeasurer(layers, cells).measure();
}

LayerQuality layer_quality_of(const VolumeMesh& volume, std::size_t layers) {
  LayerQuality quality;
  const std::size_t in_layer = layers > 0 ? volume.cell_count() / layers : 0;
  quality.types.assign(volume.cell_types.begin(), volume.cell_types.begin() + static_cast<std::ptrdiff_t>(in_layer));
  quality.scaled_jacobian = values_of(volume, "scaled_jacobian");
  quality.aspect_ratio = values_of(volume, "aspect_ratio");
  quality.volume = enclosed_volume(volume);
  quality.points = volume.points.size();
  quality.plane = volume.plane();
  return quality;
}

}  // namespace vdb_offset
