// SPDX-License-Identifier: Apache-2.0
// Fills layers over curves with plane cells, measures these, and makes structured blocks. Points are numbered layer by
// layer, one for each position that the curves use; a flat one has its number on the wall alone. Over each segment
// stands a quadrilateral in each layer, a triangle where one end is flat, and nothing where both are. Cells run
// counterclockwise, whichever side the layers are on. Edges that one cell has are collected on the way, in patches for
// wall, outer side, and sides where curves end. A block takes the points of one curve that does not branch in their
// order, and repeats the first one of a closed curve at its end. Layers are taken as they are: no position is judged or
// changed.
#include "vdb_offset/curve_offset.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "ground/system/assert.h"
#include "products/volume/cell_quality.h"
#include "space/curve/ribbon.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

CurveChains join(CurvesView curves, const PlaneFrame& frame) {
  std::vector<Vec2d> points;
  points.reserve(curves.positions.size());
  for (const Vec3d& p : curves.positions) points.push_back(frame.to_plane(p));
  return join_curves(curves, points);
}

bool goes_inward(const LayersResult& layers) { return layers.heights.back().farthest() < 0; }

float height_at(const LayersResult& layers, std::size_t layer, std::uint32_t point) {
  return static_cast<float>(layer == 0 ? 0 : layers.heights[layer - 1][point]);
}

class CurveCellMaker {
 public:
  CurveCellMaker(CurvesView curves, const LayersResult& layers)
      : layers_(layers), frame_(plane_of(curves)), chains_(join(curves, frame_)), inward_(goes_inward(layers)) {
    result_.segments.positions.assign(curves.positions.begin(), curves.positions.end());
    for (const auto& [a, b] : chains_.segments) result_.segments.add_face({a, b});
  }

  CurveCells make() {
    result_.mesh.normal = frame_.u.cross(frame_.v).unit();
    add_points();
    settle_roles();
    add_patches();
    for (std::size_t k = 1; k <= layers_.count(); ++k) add_layer(k);
    for (VolumeField& field : quality_fields(result_.mesh)) result_.mesh.cell_fields.push_back(std::move(field));
    return std::move(result_);
  }

 private:
  bool is_flat(std::uint32_t p) const { return layers_.stacks.is_flat(p); }
  /// The point of the wall that a point shares with other copies of a corner.
  std::uint32_t foot(std::uint32_t p) const { return layers_.foot.empty() ? p : layers_.foot[p]; }
  std::uint32_t number(std::size_t layer, std::uint32_t p) const {
    return layer == 0 || is_flat(p) ? numbers_[0][foot(p)] : numbers_[layer][p];
  }

  void add_points() {
    VolumeMesh& mesh = result_.mesh;
    mesh.point_fields = {{"layer", {}}, {"share", {}}, {"height", {}}, {"state", {}}};
    numbers_.assign(layers_.count() + 1, std::vector<std::uint32_t>(chains_.welded_to.size(), kNone));
    for (std::size_t k = 0; k < numbers_.size(); ++k)
      for (std::uint32_t p = 0; p < chains_.welded_to.size(); ++p) {
        if (chains_.welded_to[p] != p || (k > 0 ? is_flat(p) : foot(p) != p)) continue;
        numbers_[k][p] = static_cast<std::uint32_t>(mesh.points.size());
        mesh.points.push_back(layers_.stacks.of(p)[k]);
        mesh.point_fields[0].values.push_back(static_cast<float>(k));
        mesh.point_fields[1].values.push_back(static_cast<float>(layers_.share[p]));
        mesh.point_fields[2].values.push_back(height_at(layers_, k, p));
        mesh.point_fields[3].values.push_back(static_cast<float>(layers_.states[p]));
      }
  }

  void settle_roles() {
    const Distances& asked = layers_.heights.back();
    sides_of_.assign(chains_.welded_to.size(), 0);
    for (const auto& [a, b] : chains_.segments) {
      const int flat = is_flat(a) + is_flat(b);
      result_.facts.role.push_back(asked[a] == 0 && asked[b] == 0 ? FaceRole::Bare
                                   : flat == 0                    ? FaceRole::Full
                                   : flat == 1                    ? FaceRole::Transition
                                                                  : FaceRole::Flat);
      result_.facts.cells.push_back(flat < 2);
      for (const auto p : {a, b}) sides_of_[p] += flat < 2 && !is_flat(p);
    }
    result_.facts.border_sides = static_cast<std::size_t>(std::count(sides_of_.begin(), sides_of_.end(), 1));
  }

  void add_patches() {
    result_.mesh.patches = {{.name = "wall", .kind = BoundaryPatch::Kind::Wall},
                            {.name = "outer", .kind = BoundaryPatch::Kind::Outer}};
    if (result_.facts.border_sides > 0)
      result_.mesh.patches.push_back({.name = "sides", .kind = BoundaryPatch::Kind::Side});
    result_.mesh.cell_fields = {{"layer", {}}, {"face", {}}, {"patch", {}}};
  }

  /// Adds the cells of a layer, ccw. Outward is to the right of a segment, so that it runs backward as the lower side
  /// of its cells.
  void add_layer(std::size_t k) {
    VolumeMesh& mesh = result_.mesh;
    for (std::size_t s = 0; s < chains_.segments.size(); ++s) {
      if (result_.facts.cells[s] == 0) continue;
      auto [a, b] = chains_.segments[s];
      if (!inward_) std::swap(a, b);
      const auto cell = static_cast<std::uint32_t>(mesh.cell_count());
      std::vector<std::uint32_t> corners = {number(k - 1, a), number(k - 1, b), number(k, b), number(k, a)};
      const bool in_fan = corners[0] == corners[1];
      if (k == 1 && !in_fan) add_edge(mesh.patches[0], corners[0], corners[1], cell);
      if (k == layers_.count()) add_edge(mesh.patches[1], corners[2], corners[3], cell);
      if (sides_of_[b] == 1 && !is_flat(b)) add_edge(mesh.patches[2], corners[1], corners[2], cell);
      if (sides_of_[a] == 1 && !is_flat(a)) add_edge(mesh.patches[2], corners[3], corners[0], cell);
      if (is_flat(a)) corners.pop_back();
      else if (is_flat(b) || in_fan) corners.erase(corners.begin() + 1);
      mesh.cell_types.push_back(corners.size() == 4 ? CellType::Quadrilateral : CellType::Triangle);
      mesh.corners.insert(mesh.corners.end(), corners.begin(), corners.end());
      mesh.cell_begin.push_back(mesh.corners.size());
      mesh.cell_fields[0].values.push_back(static_cast<float>(k));
      mesh.cell_fields[1].values.push_back(static_cast<float>(s));
      mesh.cell_fields[2].values.push_back(0);
    }
  }

  static void add_edge(BoundaryPatch& patch, std::uint32_t from, std::uint32_t to, std::uint32_t cell) {
    patch.corners.insert(patch.corners.end(), {from, to});
    patch.face_begin.push_back(static_cast<std::uint32_t>(patch.corners.size()));
    patch.cell.push_back(cell);
  }

  const LayersResult& layers_;
  PlaneFrame frame_;
  CurveChains chains_;
  bool inward_;
  CurveCells result_;
  std::vector<std::vector<std::uint32_t>> numbers_;  // by layer and point of the curves: the mesh's point
  std::vector<std::uint8_t> sides_of_;               // of each point: the number of segments with cells there
};

}  // namespace

CurveCells make_curve_cells(CurvesView curves, const LayersResult& layers) {
  return CurveCellMaker(curves, layers).make();
}

LayerQuality measure_curve_cells(const CurveCells& cells, const LayersResult& layers) {
  VDB_OFFSET_ASSERT(layers.count() > 0 && cells.mesh.cell_count() % layers.count() == 0);
  auto [jacobian, aspect] = quality_fields(cells.mesh);
  LayerQuality quality{.scaled_jacobian = std::move(jacobian.values),
                       .aspect_ratio = std::move(aspect.values),
                       .volume = enclosed_volume(cells.mesh),
                       .points = cells.mesh.points.size(),
                       .plane = true};
  const std::size_t in_layer = cells.mesh.cell_count() / layers.count();
  const auto first = cells.mesh.cell_types.begin(), second = first + static_cast<std::ptrdiff_t>(in_layer);
  quality.types.assign(first, second);
  if (!layers.foot.empty() && layers.count() > 1)
    quality.upper_types.assign(second, second + static_cast<std::ptrdiff_t>(in_layer));
  for (std::size_t s = 0; s < cells.segments.view().face_count(); ++s) {
    if (cells.facts.cells[s] == 0) continue;
    const auto segment = cells.segments.view().face(s);
    const auto a = layers.stacks.of(segment[0]), b = layers.stacks.of(segment[1]);
    if (a[0] == b[0]) {  // of a fan
      quality.wall_angle.push_back(std::numeric_limits<float>::quiet_NaN());
      continue;
    }
    quality.wall_angle.push_back(static_cast<float>(wall_angle(std::array{a[0], b[0]}, std::array{a[1], b[1]})));
    for (std::size_t k = 1; k < a.size(); ++k)
      quality.least_segment = std::min(quality.least_segment, (b[k] - a[k]).length() / (b[0] - a[0]).length());
  }
  return quality;
}

StructuredBlock make_curve_block(CurvesView curves, const LayersResult& layers) {
  const CurveChains chains = join(curves, plane_of(curves));
  if (chains.chains != 1 || chains.branchings > 0)
    throw InvalidInput("structured block: expected one curve that does not branch, got " +
                       std::to_string(chains.chains) + " with " + std::to_string(chains.branchings) + " branchings");
  std::vector<std::uint32_t> along{chains.segments.front()[0]};
  for (const Segment& segment : chains.segments) along.push_back(segment[1]);
  if (!goes_inward(layers)) std::reverse(along.begin(), along.end());
  StructuredBlock block;
  block.ni = static_cast<std::uint32_t>(along.size());
  block.nj = static_cast<std::uint32_t>(layers.count() + 1);
  block.nk = 1;
  block.point_fields = {{"share", {}}, {"height", {}}, {"state", {}}};
  for (std::size_t j = 0; j < block.nj; ++j)
    for (const auto p : along) {
      block.points.push_back(layers.stacks.of(p)[j]);
      block.point_fields[0].values.push_back(static_cast<float>(layers.share[p]));
      block.point_fields[1].values.push_back(height_at(layers, j, p));
      block.point_fields[2].values.push_back(static_cast<float>(layers.states[p]));
    }
  return block;
}

}  // namespace vdb_offset
