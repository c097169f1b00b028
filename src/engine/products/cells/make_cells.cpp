// SPDX-License-Identifier: Apache-2.0
// Makes the volume mesh of layers whose cells have been numbered and measured. All arrays get their size at once;
// points are filled in block by block through all layers, and cells column by column, each thread at places that the
// numbers give. The faces of the boundary follow: the wall by its names, the outer side, and the open sides, of which
// those with common points belong to one opening and to one patch; of very many openings the smallest share the last
// patch. Each face that a single cell has is in one patch. The order of all of this does not depend on the number of
// threads. Positions are taken from the stacks as they are, and nothing is measured here (see measure_cells.cpp).
#include "products/cells/make_cells.h"

#include "ground/numbers/disjoint_sets.h"
#include "vdb_offset/cells.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <span>
#include <string>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/cells/side_planes.h"
#include "products/layers/column_cells.h"
#include "products/volume/free_name.h"
#include "products/volume/periodic_patches.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

/// The distance of a vertex in a layer: as measured in the first and the last layer; in between, its height times the
/// share that it keeps.
double achieved(const LayersResult& layers, std::size_t layer, Index v) {
  if (layer == 0) return 0;
  if (layer == layers.count()) return layers.achieved[v];
  return layer == 1 ? layers.first_achieved[v] : layers.share[v] * std::abs(layers.heights[layer - 1][v]);
}

/// Fills in the points and their fields, in blocks whose stacks stay in the cache from layer to layer.
void fill_points(const LayersResult& layers, const LayerCells& cells, VolumeMesh& volume) {
  // Points of the wall in a block. For speed alone; not measured.
  constexpr std::size_t kBlock = 512;
  const LayerPoints& points = cells.points;
  volume.point_fields = {{"layer", {}}, {"share", {}}, {"height", {}}, {"achieved", {}}, {"state", {}}};
  // The first touch of this memory by one thread would take as long as filling it.
  tbb::parallel_invoke([&] { volume.points.resize(cells.point_count()); },
                       [&] {
                         for (VolumeField& field : volume.point_fields) field.values.resize(cells.point_count());
                       });
  const auto fill = [&](Index p, std::size_t layer) {
    const Index at = points.at(p, layer), v = points.vertex[p];
    volume.points[at] = layers.stacks.of(v)[layer];
    const double height = layer > 0 ? layers.heights[layer - 1][v] : 0;
    const double values[] = {static_cast<double>(layer), layers.share[v], height, achieved(layers, layer, v),
                             static_cast<double>(layers.states[v])};
    for (std::size_t i = 0; i < std::size(values); ++i)
      volume.point_fields[i].values[at] = static_cast<float>(values[i]);
  };
  for_each_index((points.stacks() + kBlock - 1) / kBlock,
                 [&](std::size_t b) {
                   const auto begin = static_cast<Index>(b * kBlock),
                              end = std::min<Index>(points.stacks(), begin + kBlock);
                   for (std::size_t layer = 0; layer <= layers.count(); ++layer)
                     for (Index p = begin; p < end; ++p)
                       if (layer == 0 ? p < points.wall() : !points.flat(p)) fill(p, layer);
                 },
                 1);
}

/// Fills in the points in the middle of cells beside fans, and their fields: the means of the cells' corners.
void fill_middles(const LayerCells& cells, VolumeMesh& volume) {
  const NumberedColumns& columns = cells.columns;
  for (std::size_t c = 0; c < columns.middle.size(); ++c) {
    const Index middle = columns.middle[c];
    if (middle == kNone) continue;
    std::vector<Index> corners;
    const ColumnCells column = columns.column(cells.points, c, 0);
    column.for_each_point([&](Index point) { corners.push_back(point); });
    const auto mean = [&](auto&& values) {
      auto sum = values[corners[0]];
      for (std::size_t i = 1; i < corners.size(); ++i) sum += values[corners[i]];
      return sum / static_cast<float>(corners.size());
    };
    volume.points[middle] = column.middle([&](Index point) -> const Vec3d& { return volume.points[point]; });
    for (VolumeField& field : volume.point_fields) field.values[middle] = mean(field.values);
    volume.point_fields[4].values[middle] = static_cast<float>(VertexState::Reached);
  }
}

void fill_cells(const LayerCells& cells, const WallNames& names, VolumeMesh& volume) {
  const NumberedColumns& columns = cells.columns;
  const std::uint64_t upper = columns.upper.size.back();
  const auto size_before = [&](std::size_t layer) {
    return layer == 0 ? 0 : columns.in(0).size.back() + (layer - 1) * upper;
  };
  volume.cell_fields = {{"layer", {}}, {"face", {}}, {"patch", {}}};
  tbb::parallel_invoke([&] { volume.corners.resize(size_before(cells.layers)); },
                       [&] {
                         volume.cell_types.resize(cells.count());
                         volume.cell_begin.resize(cells.count() + 1);
                         for (VolumeField& field : volume.cell_fields) field.values.resize(cells.count());
                       });
  for (std::size_t layer = 0; layer < cells.layers; ++layer)
    for_each_index(columns.count(), [&](std::size_t c) {
      std::size_t cell = cells.cell(layer, c);
      std::uint64_t at = size_before(layer) + columns.in(layer).size[c];
      const Index face = columns.face[c];
      const float values[] = {static_cast<float>(layer + 1), static_cast<float>(face),
                              names.of_face.empty() ? 0.0F : static_cast<float>(names.of_face[face])};
      columns.column(cells.points, c, layer)
          .visit_cells(
              [&](CellType type) {
                for (std::size_t i = 0; i < std::size(values); ++i) volume.cell_fields[i].values[cell] = values[i];
                volume.cell_begin[cell] = at;
                volume.cell_types[cell++] = type;
              },
              [&](Index corner) { volume.corners[at++] = corner; });
    });
  volume.cell_begin.back() = size_before(cells.layers);
}

void add_face(std::span<const Index> face, std::size_t cell, BoundaryPatch& patch) {
  patch.corners.insert(patch.corners.end(), face.begin(), face.end());
  patch.face_begin.push_back(static_cast<Index>(patch.corners.size()));
  patch.cell.push_back(static_cast<Index>(cell));
}

void add_walls(const LayerCells& cells, const WallNames& names, VolumeMesh& volume) {
  for (const std::string& name : patch_names(names)) volume.patches.emplace_back().name = name;
  const NumberedColumns& columns = cells.columns;
  std::vector<Index> scratch;
  for (std::size_t c = 0; c < columns.count(); ++c) {
    BoundaryPatch& patch = volume.patches[names.of_face.empty() ? 0 : names.of_face[columns.face[c]]];
    columns.column(cells.points, c, 0).visit_below(scratch, [&](std::span<const Index> face, Index cell) {
      add_face(face, cells.cell(0, c) + cell, patch);
    });
  }
}

void add_outer(const LayerCells& cells, VolumeMesh& volume) {
  const NumberedColumns& columns = cells.columns;
  BoundaryPatch& patch = volume.patches.emplace_back();
  patch.name = "outer";
  patch.kind = BoundaryPatch::Kind::Outer;
  patch.corners.reserve(columns.corners.size());
  patch.face_begin.reserve(columns.upper.cells.back() + 1);
  patch.cell.reserve(columns.upper.cells.back());
  const std::size_t last = cells.layers - 1;
  std::vector<Index> scratch;
  for (std::size_t c = 0; c < columns.count(); ++c)
    columns.column(cells.points, c, last).visit_above(scratch, [&](std::span<const Index> face, Index cell) {
      add_face(face, cells.cell(last, c) + cell, patch);
    });
}

/// A side of a column that is on the boundary.
struct OpenSide {
  std::size_t column;
  Index corner;
  Index opening = 0;
};

/// The stacks at both edges of a side.
std::array<Index, 2> stacks_of(const NumberedColumns& columns, const OpenSide& side) {
  const auto ring = columns.ring(side.column);
  return {ring[side.corner], ring[(side.corner + 1) % ring.size()]};
}

std::vector<OpenSide> find_open_sides(const NumberedColumns& columns) {
  std::vector<OpenSide> sides;
  for (std::size_t c = 0; c < columns.count(); ++c)
    for (Index k = 0; k < columns.ring(c).size(); ++k)
      if (columns.open[columns.begin[c] + k] != 0) sides.push_back({c, k});
  return sides;
}

/// Takes those sides out that a motion takes to others, and these, and returns both.
std::array<std::vector<OpenSide>, 2> take_periodic(const PeriodicPairs& pairs, const LayerCells& cells,
                                                   std::vector<OpenSide>& sides) {
  using Ends = std::array<Index, 2>;
  const auto ends_of = [&](const OpenSide& side) {
    const auto [a, b] = stacks_of(cells.columns, side);
    return Ends{cells.points.vertex[a], cells.points.vertex[b]};
  };
  std::set<Ends> all, images;
  for (const OpenSide& side : sides) all.insert(ends_of(side));
  const auto image_of = [&](const Ends& ends) { return Ends{pairs.image[ends[1]], pairs.image[ends[0]]}; };
  std::array<std::vector<OpenSide>, 2> taken;
  std::erase_if(sides, [&](const OpenSide& side) {
    const Ends image = image_of(ends_of(side));
    if (image[0] == kNone || image[1] == kNone || !all.contains(image)) return false;
    images.insert(image);
    taken[0].push_back(side);
    return true;
  });
  std::erase_if(sides, [&](const OpenSide& side) {
    if (!images.contains(ends_of(side))) return false;
    taken[1].push_back(side);
    return true;
  });
  return taken;
}

/// Finds the opening of the surface that each side belongs to: sides with a common point belong to one. Openings are
/// numbered in the order of columns.
void find_openings(const LayerPoints& points, const NumberedColumns& columns, std::vector<OpenSide>& sides) {
  DisjointSets joined(points.stacks());
  for (const OpenSide& side : sides) {
    const auto [a, b] = stacks_of(columns, side);
    joined.join(a, b);
  }
  std::vector<Index> number(points.stacks(), kNone);
  std::size_t count = 0;
  for (OpenSide& side : sides) {
    Index& opening = number[joined.first(columns.ring(side.column)[side.corner])];
    if (opening == kNone) opening = static_cast<Index>(count++);
    side.opening = opening;
  }
}

/// Joins all openings but the largest few into the last one. Returns the number of openings.
std::size_t keep_largest(std::size_t openings, std::vector<OpenSide>& sides) {
  // The largest number of side patches: a surface that is torn to pieces has thousands of openings, which solvers would
  // are listed one by one. Not measured.
  constexpr std::size_t kMost = 64;
  if (openings <= kMost) return openings;
  std::vector<Index> size(openings, 0), by_size(openings), number(openings, kMost - 1);
  for (const OpenSide& side : sides) ++size[side.opening];
  std::iota(by_size.begin(), by_size.end(), 0);
  std::stable_sort(by_size.begin(), by_size.end(), [&](Index a, Index b) { return size[a] > size[b]; });
  std::sort(by_size.begin(), by_size.begin() + kMost - 1);
  for (Index i = 0; i + 1 < kMost; ++i) number[by_size[i]] = i;
  for (OpenSide& side : sides) side.opening = number[side.opening];
  return kMost;
}

/// The name of an opening's patch: "sides", or "sides_1", "sides_2" ... of several, without those that are taken.
std::string side_name(std::size_t openings, std::set<std::string>& taken) {
  if (openings == 1) return "sides";
  for (std::size_t n = 1;; ++n)
    if (std::string name = "sides_" + std::to_string(n); taken.insert(name).second) return name;
}

/// Parts openings that run over several planes. Returns the number of openings.
std::size_t part_openings(const LayerCells& cells, const VolumeMesh& volume, std::vector<OpenSide>& sides) {
  std::vector<BoundarySide> areas;
  areas.reserve(sides.size());
  for (const OpenSide& side : sides) {
    const auto [a, b] = stacks_of(cells.columns, side);
    const auto corner = [&](Index stack, std::size_t layer) { return volume.points[cells.points.at(stack, layer)]; };
    areas.push_back(
        {{a, b}, {corner(a, 0), corner(b, 0), corner(b, cells.layers), corner(a, cells.layers)}, side.opening});
  }
  const std::size_t count = part_by_planes(areas);
  for (std::size_t i = 0; i < sides.size(); ++i) sides[i].opening = areas[i].opening;
  return count;
}

/// Adds the faces of sides to patches: opening 0 to the patch `first`, and so on.
void add_side_faces(const LayerCells& cells, std::span<const OpenSide> sides, std::size_t first, VolumeMesh& volume) {
  for (std::size_t layer = 0; layer < cells.layers; ++layer)
    for (const auto& [c, k, opening] : sides) {
      const ColumnCells column = cells.columns.column(cells.points, c, layer);
      std::array<Index, 4> face;
      const Index size = column.side(k, face);
      add_face(std::span(face).first(size), cells.cell(layer, c) + column.cell_at_side(k),
               volume.patches[first + opening]);
    }
}

void add_periodic(const PeriodicPairs& pairs, const LayerCells& cells, std::vector<OpenSide>& sides,
                  VolumeMesh& volume) {
  const auto taken = take_periodic(pairs, cells, sides);
  if (taken[0].empty()) return;
  for (const std::vector<OpenSide>& each : taken) {
    const std::string name = fmt::format("periodic_{}", &each - taken.data() + 1);
    volume.patches.push_back({.name = free_name(volume, name), .kind = BoundaryPatch::Kind::Periodic});
    add_side_faces(cells, each, volume.patches.size() - 1, volume);
  }
  volume.motion = pairs.motion;
}

void add_sides(const LayerCells& cells, const LayersResult& layers, VolumeMesh& volume) {
  std::vector<OpenSide> sides = find_open_sides(cells.columns);
  if (layers.periodic) add_periodic(*layers.periodic, cells, sides, volume);
  find_openings(cells.points, cells.columns, sides);
  const std::size_t openings = sides.empty() ? 0 : keep_largest(part_openings(cells, volume, sides), sides);
  std::set<std::string> taken;
  for (const BoundaryPatch& patch : volume.patches) taken.insert(patch.name);
  const std::size_t first = volume.patches.size();
  for (std::size_t i = 0; i < openings; ++i) {
    BoundaryPatch& patch = volume.patches.emplace_back();
    patch.name = side_name(openings, taken);
    patch.kind = BoundaryPatch::Kind::Side;
  }
  add_side_faces(cells, sides, first, volume);
}

void add_patches(const LayerCells& cells, const LayersResult& layers, const WallNames& names, VolumeMesh& volume) {
  add_walls(cells, names, volume);
  add_outer(cells, volume);
  add_sides(cells, layers, volume);
}

}  // namespace

VolumeMesh make_cells(const LayersResult& layers, const LayerCells& cells, const WallNames& names,
                      LayerQuality quality) {
  VDB_OFFSET_ASSERT(cells.layers == layers.count());
  VDB_OFFSET_ASSERT(quality.scaled_jacobian.size() == cells.count() && quality.aspect_ratio.size() == cells.count());
  require_names(names, cells.facts.role.size());
  VolumeMesh volume;
  fill_points(layers, cells, volume);
  fill_middles(cells, volume);
  tbb::parallel_invoke([&] { fill_cells(cells, names, volume); },
                       [&] {
                         if (layers.count() > 0) add_patches(cells, layers, names, volume);
                       });
  match_periodic_patches(volume);
  volume.cell_fields.push_back({"scaled_jacobian", std::move(quality.scaled_jacobian)});
  volume.cell_fields.push_back({"aspect_ratio", std::move(quality.aspect_ratio)});
  return volume;
}

VolumeMesh make_cells(PolygonView mesh, const LayersResult& layers, const WallNames& names, LayerCellFacts* facts) {
  LayerCells cells = number_cells(mesh, layers);
  VolumeMesh volume = make_cells(layers, cells, names, measure_cells(layers, cells));
  if (facts != nullptr) *facts = std::move(cells.facts);
  return volume;
}

MeasuredCells::MeasuredCells(PolygonView mesh, const LayersResult& layers)
    : layers_(&layers),
      cells_(std::make_unique<LayerCells>(number_cells(mesh, layers))),
      quality_(measure_cells(layers, *cells_)) {}

MeasuredCells::MeasuredCells(MeasuredCells&&) noexcept = default;
MeasuredCells& MeasuredCells::operator=(MeasuredCells&&) noexcept = default;
MeasuredCells::~MeasuredCells() = default;

const LayerCellFacts& MeasuredCells::facts() const { return cells_->facts; }

VolumeMesh MeasuredCells::make(const WallNames& names) && {
  return make_cells(*layers_, *cells_, names, std::move(quality_));
}

}  // namespace vdb_offset
