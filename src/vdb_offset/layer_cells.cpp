#include "vdb_offset/layer_cells.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "vdb_offset/cell_quality.h"
#include "vdb_offset/cell_stack.h"
#include "vdb_offset/error.h"
#include "vdb_offset/layer_columns.h"
#include "vdb_offset/parallel.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

void require_layers_of(PolygonView mesh, const LayersResult& layers, const WallNames& names) {
  const auto require = [](const char* what, std::size_t expected, std::size_t got) {
    if (got != expected)
      throw InvalidInput("layer_cells: expected " + std::to_string(expected) + " " + what + ", got " +
                         std::to_string(got));
  };
  require("surfaces, one more than heights", layers.count() + 1, layers.positions.size());
  for (const auto& positions : layers.positions)
    require("positions in each layer", mesh.positions.size(), positions.size());
  require("shares", mesh.positions.size(), layers.share.size());
  require("states", mesh.positions.size(), layers.states.size());
  require("distances achieved", mesh.positions.size(), layers.achieved.size());
  require("distances of the first layer", mesh.positions.size(), layers.first_achieved.size());
  for (const Distances& heights : layers.heights)
    if (!heights.uniform()) require("heights", mesh.positions.size(), heights.count());
  if (!layers.carries.empty()) require("marks of faces", mesh.face_count(), layers.carries.size());
  if (names.of_face.empty()) return;
  require("names of faces", mesh.face_count(), names.of_face.size());
  for (const Index name : names.of_face)
    if (name >= names.names.size())
      throw InvalidInput("layer_cells: expected names below " + std::to_string(names.names.size()) + ", got " +
                         std::to_string(name));
}

std::vector<std::uint8_t> find_flat(const LayersResult& layers) {
  std::vector<std::uint8_t> flat(layers.positions[0].size());
  for_each_index(flat.size(), [&](std::size_t v) {
    flat[v] = std::all_of(layers.positions.begin() + 1, layers.positions.end(),
                          [&](const auto& positions) { return positions[v] == layers.positions[0][v]; });
  });
  return flat;
}

/// Counts what a layer has, and so where each column's cells are.
void count_cells(const LayerPoints& points, LayerColumns& columns, LayerCellFacts& facts) {
  columns.cells.assign(columns.count() + 1, 0);
  columns.size.assign(columns.count() + 1, 0);
  for_each_index(columns.count(), [&](std::size_t c) {
    CellStack(points, columns.ring(c), 0)
        .visit_cells([&](CellType) { ++columns.cells[c + 1]; }, [&](Index) { ++columns.size[c + 1]; });
  });
  for (std::size_t c = 0; c < columns.count(); ++c)
    facts.cells[columns.face[c]] = static_cast<std::uint8_t>(facts.cells[columns.face[c]] + columns.cells[c + 1]);
  std::partial_sum(columns.cells.begin(), columns.cells.end(), columns.cells.begin());
  std::partial_sum(columns.size.begin(), columns.size.end(), columns.size.begin());
}

void require_countable(const LayerPoints& points, const LayerColumns& columns, std::size_t layers) {
  const std::uint64_t all_points = points.wall() + std::uint64_t{points.risen} * layers;
  const std::uint64_t all_cells = std::uint64_t{columns.cells.back()} * layers;
  if (all_points >= kNone || all_cells >= kNone)
    throw InvalidInput("layer_cells: expected fewer than 2^32 points and cells, got " + std::to_string(all_points) +
                       " and " + std::to_string(all_cells) + " (ask for fewer layers)");
}

/// The distance of a layer's vertex: as measured at the lowest and the outermost, what its share asks for between.
double achieved(const LayersResult& layers, std::size_t layer, Index v) {
  if (layer == 0) return 0;
  if (layer == layers.count()) return layers.achieved[v];
  return layer == 1 ? layers.first_achieved[v] : layers.share[v] * std::abs(layers.heights[layer - 1][v]);
}

void place_points(const LayersResult& layers, const LayerPoints& points, VolumeMesh& volume) {
  const std::size_t count = points.wall() + std::size_t{points.risen} * layers.count();
  volume.point_fields = {{"layer", {}}, {"share", {}}, {"height", {}}, {"achieved", {}}, {"state", {}}};
  // The first touch of so much memory takes as long as filling it, on one thread.
  tbb::parallel_invoke([&] { volume.points.resize(count); },
                       [&] {
                         for (VolumeField& field : volume.point_fields) field.values.resize(count);
                       });
  for (std::size_t layer = 0; layer <= layers.count(); ++layer)
    for_each_index(points.wall(), [&](std::size_t p) {
      if (layer > 0 && points.flat(static_cast<Index>(p))) return;
      const Index at = points.at(static_cast<Index>(p), layer), v = points.vertex[p];
      volume.points[at] = layers.positions[layer][v];
      const double height = layer > 0 ? layers.heights[layer - 1][v] : 0;
      const double values[] = {static_cast<double>(layer), layers.share[v], height, achieved(layers, layer, v),
                               static_cast<double>(layers.states[v])};
      for (std::size_t i = 0; i < std::size(values); ++i)
        volume.point_fields[i].values[at] = static_cast<float>(values[i]);
    });
}

void fill_cells(const LayerPoints& points, const LayerColumns& columns, const WallNames& names, std::size_t layers,
                VolumeMesh& volume) {
  const std::size_t cells = columns.cells.back();
  const std::uint64_t size = columns.size.back();
  volume.cell_fields = {{"layer", {}}, {"face", {}}, {"patch", {}}};
  tbb::parallel_invoke([&] { volume.corners.resize(size * layers); },
                       [&] {
                         volume.cell_types.resize(cells * layers);
                         volume.cell_begin.resize(cells * layers + 1);
                         for (VolumeField& field : volume.cell_fields) field.values.resize(cells * layers);
                       });
  for (std::size_t layer = 0; layer < layers; ++layer)
    for_each_index(columns.count(), [&](std::size_t c) {
      std::size_t cell = layer * cells + columns.cells[c];
      std::uint64_t at = layer * size + columns.size[c];
      const Index face = columns.face[c];
      const float values[] = {static_cast<float>(layer + 1), static_cast<float>(face),
                              names.of_face.empty() ? 0.0F : static_cast<float>(names.of_face[face])};
      CellStack(points, columns.ring(c), layer)
          .visit_cells(
              [&](CellType type) {
                for (std::size_t i = 0; i < std::size(values); ++i) volume.cell_fields[i].values[cell] = values[i];
                volume.cell_begin[cell] = at;
                volume.cell_types[cell++] = type;
              },
              [&](Index corner) { volume.corners[at++] = corner; });
    });
  volume.cell_begin.back() = size * layers;
}

/// The triangles of two columns at once, in the same layer.
PrismLevel<Pair> level_of(const LayerPoints& points, std::span<const Index> ring, std::span<const Index> other,
                          std::size_t layer, const VolumeMesh& volume) {
  std::array<Way<Pair>, 3> corner;
  for (std::size_t k = 0; k < 3; ++k)
    corner[k] = both(volume.points[points.at(ring[k], layer)], volume.points[points.at(other[k], layer)]);
  return PrismLevel<Pair>(corner);
}

/// The fields of all cells' quality: see cell_quality.h. Where prisms stand on each other, each triangle is looked at
/// once for that above and that below it, in two columns at once.
class ColumnQuality {
 public:
  ColumnQuality(const LayerPoints& points, const LayerColumns& columns, std::size_t layers, const VolumeMesh& volume)
      : points_(points), columns_(columns), layers_(layers), volume_(volume) {}

  std::array<VolumeField, 2> fields() {
    for_each_index(
        fields_.size(), [&](std::size_t i) { fields_[i].values.resize(volume_.cell_count()); }, 1);
    for_each_index((columns_.count() + 1) / 2, [&](std::size_t i) {
      const std::size_t c = 2 * i, other = std::min(c + 1, columns_.count() - 1);
      prefetch(c + kAhead), prefetch(c + kAhead + 1);
      if (is_of_prisms(c) && is_of_prisms(other)) return measure_prisms(c, other);
      measure_cells(c);
      if (other != c) measure_cells(other);
    });
    return std::move(fields_);
  }

 private:
  // So many columns on, points that are far apart in memory are asked for.
  static constexpr std::size_t kAhead = 4;
  void prefetch(std::size_t c) const {
    if (c >= columns_.count()) return;
    for (const Index p : columns_.ring(c))
      for (std::size_t layer = 0; layer <= layers_; ++layer) __builtin_prefetch(&volume_.points[points_.at(p, layer)]);
  }

  bool is_of_prisms(std::size_t c) const {
    const auto ring = columns_.ring(c);
    return ring.size() == 3 && std::none_of(ring.begin(), ring.end(), [&](Index p) { return points_.flat(p); });
  }

  void set(std::size_t layer, std::size_t cell, const CellQuality& quality) {
    const std::size_t at = layer * columns_.cells.back() + cell;
    fields_[0].values[at] = static_cast<float>(quality.jacobian);
    fields_[1].values[at] = static_cast<float>(quality.aspect);
  }

  void measure_prisms(std::size_t c, std::size_t other) {
    const auto level = [&](std::size_t layer) {
      return level_of(points_, columns_.ring(c), columns_.ring(other), layer, volume_);
    };
    PrismLevel<Pair> below = level(0);
    for (std::size_t layer = 0; layer < layers_; ++layer) {
      const PrismLevel<Pair> above = level(layer + 1);
      const auto [triple, shortest, longest] = prism_squares(below, above);
      set(layer, columns_.cells[c], prism_quality_of(triple[0], shortest[0], longest[0]));
      set(layer, columns_.cells[other], prism_quality_of(triple[1], shortest[1], longest[1]));
      below = above;
    }
  }

  void measure_cells(std::size_t c) {
    for (std::size_t layer = 0; layer < layers_; ++layer)
      for (std::size_t cell = columns_.cells[c]; cell < columns_.cells[c + 1]; ++cell)
        set(layer, cell, cell_quality(volume_, layer * columns_.cells.back() + cell));
  }

  const LayerPoints& points_;
  const LayerColumns& columns_;
  std::size_t layers_;
  const VolumeMesh& volume_;
  std::array<VolumeField, 2> fields_{VolumeField{"scaled_jacobian", {}}, VolumeField{"aspect_ratio", {}}};
};

void add_face(std::span<const Index> face, std::size_t cell, VolumePatch& patch) {
  patch.corners.insert(patch.corners.end(), face.begin(), face.end());
  patch.face_begin.push_back(static_cast<Index>(patch.corners.size()));
  patch.cell.push_back(static_cast<Index>(cell));
}

void add_walls(const LayerPoints& points, const LayerColumns& columns, const WallNames& names, VolumeMesh& volume) {
  for (const std::string& name : patch_names(names)) volume.patches.emplace_back().name = name;
  std::vector<Index> scratch;
  for (std::size_t c = 0; c < columns.count(); ++c) {
    VolumePatch& patch = volume.patches[names.of_face.empty() ? 0 : names.of_face[columns.face[c]]];
    CellStack(points, columns.ring(c), 0).visit_below(scratch, [&](std::span<const Index> face, Index cell) {
      add_face(face, columns.cells[c] + cell, patch);
    });
  }
}

void add_outer(const LayerPoints& points, const LayerColumns& columns, std::size_t layers, VolumeMesh& volume) {
  VolumePatch& patch = volume.patches.emplace_back();
  patch.name = "outer";
  patch.kind = VolumePatch::Kind::Outer;
  patch.corners.reserve(columns.corners.size());
  patch.face_begin.reserve(columns.cells.back() + 1);
  patch.cell.reserve(columns.cells.back());
  const std::size_t below = (layers - 1) * columns.cells.back();
  std::vector<Index> scratch;
  for (std::size_t c = 0; c < columns.count(); ++c)
    CellStack(points, columns.ring(c), layers - 1).visit_above(scratch, [&](std::span<const Index> face, Index cell) {
      add_face(face, below + columns.cells[c] + cell, patch);
    });
}

void add_sides(const LayerPoints& points, const LayerColumns& columns, std::size_t layers, VolumeMesh& volume) {
  VolumePatch patch;
  patch.name = "sides";
  patch.kind = VolumePatch::Kind::Side;
  std::vector<std::pair<std::size_t, Index>> open;  // columns, and their sides
  for (std::size_t c = 0; c < columns.count(); ++c)
    for (Index k = 0; k < columns.ring(c).size(); ++k)
      if (columns.open[columns.begin[c] + k] != 0) open.emplace_back(c, k);
  for (std::size_t layer = 0; layer < layers; ++layer)
    for (const auto& [c, k] : open) {
      const CellStack stack(points, columns.ring(c), layer);
      std::array<Index, 4> face;
      const Index size = stack.side(k, face);
      add_face(std::span(face).first(size), layer * columns.cells.back() + columns.cells[c] + stack.cell_at_side(k),
               patch);
    }
  if (patch.face_count() > 0) volume.patches.push_back(std::move(patch));
}

void add_patches(const LayerPoints& points, const LayerColumns& columns, const WallNames& names, std::size_t layers,
                 VolumeMesh& volume) {
  add_walls(points, columns, names, volume);
  add_outer(points, columns, layers, volume);
  add_sides(points, columns, layers, volume);
}

}  // namespace

const char* name(FaceRole role) {
  constexpr const char* kNames[kFaceRoleCount] = {"bare", "full", "transition", "flat", "degenerate", "repeated"};
  return kNames[static_cast<std::size_t>(role)];
}

VolumeMesh make_cells(PolygonView mesh, const LayersResult& layers, const WeldOptions& weld, const WallNames& names,
                      LayerCellFacts* facts_out) {
  require_layers_of(mesh, layers, names);
  const std::vector<Index> place = weld_by_position(mesh, weld);
  LayerCellFacts facts;
  facts.role.assign(mesh.face_count(), FaceRole::Bare);
  facts.cells.assign(mesh.face_count(), 0);
  const std::vector<std::uint8_t> flat = find_flat(layers);
  LayerColumns columns = find_columns(mesh, layers, place, flat, facts);
  const LayerPoints points = number_points(flat, columns, facts);
  count_cells(points, columns, facts);
  require_countable(points, columns, layers.count());

  VolumeMesh volume;
  place_points(layers, points, volume);
  fill_cells(points, columns, names, layers.count(), volume);
  std::array<VolumeField, 2> quality;
  tbb::parallel_invoke([&] { quality = ColumnQuality(points, columns, layers.count(), volume).fields(); },
                       [&] {
                         if (layers.count() > 0) add_patches(points, columns, names, layers.count(), volume);
                       });
  for (VolumeField& field : quality) volume.cell_fields.push_back(std::move(field));
  if (facts_out != nullptr) *facts_out = std::move(facts);
  return volume;
}

}  // namespace vdb_offset
