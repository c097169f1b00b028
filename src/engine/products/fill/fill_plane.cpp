// SPDX-License-Identifier: Apache-2.0
// Fills what layers on curves leave open, in their plane: the segments of the layers' outer side and of the wall where
// it has no layers are the border, with a circle or a square far away if they do not enclose what is left. Triangles
// come from the mesher of planes, which keeps all segments; that they are a mesh of the region follows from its sides.
#include "products/fill/openings.h"
#include "vdb_offset/fill.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "ground/numbers/disjoint_sets.h"
#include "ground/numbers/quantiles.h"
#include "ground/plane/plane_mesh.h"
#include "ground/system/call_progress.h"
#include "products/volume/cell_quality.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;
using PlaneEdge = std::array<Index, 2>;

// The segments of a circle far away, whose size is what grows to there at a growth of 1.26; as many on a square.
constexpr int kFarSegments = 24;

class PlaneFilling {
 public:
  PlaneFilling(const CurvesView& segments, const LayersResult& layers, const FillOptions& options, CurveCells cells)
      : segments_(segments),
        layers_(layers),
        options_(options),
        facts_(std::move(cells.facts)),
        volume_(std::move(cells.mesh)),
        axes_(axes_across(volume_.normal)),
        origin_(volume_.points.at(0)) {}

  void fill() {
    layer_cells_ = volume_.cell_count();
    layer_points_ = volume_.points.size();
    take_outer();
    take_bare();
    if (region_.segments.empty()) throw InvalidInput("fill: expected layers, got none");
    front_ = region_.segments.size();
    require_closed();
    if (!is_enclosed()) add_farfield();
    region_.growth = options_.growth;
    region_.longest = options_.longest.value_or(region_.longest);
    join(mesh_plane(region_));
  }

  VolumeMesh finish(FillReport* report) {
    add_fields();
    if (report) make_report(*report);
    return std::move(volume_);
  }

 private:
  Index in_region(Index p) {
    const auto [found, is_new] = number_.try_emplace(p, static_cast<Index>(region_.points.size()));
    if (is_new) {
      const Vec3d from = volume_.points[p] - origin_;
      region_.points.emplace_back(from.dot(axes_[0]), from.dot(axes_[1]));
      of_region_.push_back(p);
    }
    return found->second;
  }
  /// Adds a segment that what is left lies to the left of.
  void add(Index from, Index to, Index patch, Index cell) {
    region_.segments.push_back({in_region(from), in_region(to)});
    patch_.push_back(patch);
    behind_.push_back(cell);
  }

  void take_outer() {
    for (BoundaryPatch& patch : volume_.patches) {
      if (patch.kind != BoundaryPatch::Kind::Outer) continue;
      for (std::size_t f = 0; f < patch.face_count(); ++f)
        add(patch.face(f)[1], patch.face(f)[0], kNone, patch.cell[f]);
    }
    std::erase_if(volume_.patches, [](const BoundaryPatch& patch) { return patch.kind == BoundaryPatch::Kind::Outer; });
  }

  /// Segments of the wall without layers, which what is left lies to the right of if the others' go outward.
  void take_bare() {
    const bool is_inward = layers_.heights.back().farthest() < 0;
    std::map<std::array<double, 3>, Index> known;
    const auto key = [](const Vec3d& x) { return std::array{x[0], x[1], x[2]}; };
    for (Index p = 0; p < layer_points_; ++p)
      if (volume_.point_fields[0].values[p] == 0) known.try_emplace(key(volume_.points[p]), p);
    const auto point = [&](Index v) {
      const Vec3d& x = layers_.stacks.of(v)[0];
      const auto [found, is_new] = known.try_emplace(key(x), static_cast<Index>(volume_.points.size()));
      if (is_new) volume_.points.push_back(x);
      return found->second;
    };
    for (std::size_t s = 0; s < segments_.face_count(); ++s) {
      if (facts_.cells[s] != 0) continue;
      Index from = point(segments_.face(s)[0]), to = point(segments_.face(s)[1]);
      if (from == to) continue;
      if (!is_inward) std::swap(from, to);
      add(from, to, 0, kNone);
    }
  }

  void require_closed() const {
    std::vector<int> surplus(region_.points.size(), 0);
    for (const auto& [a, b] : region_.segments) ++surplus[a], --surplus[b];
    const auto open = std::ranges::find_if(surplus, [](int n) { return n != 0; });
    if (open == surplus.end()) return;
    const Vec3d& place = volume_.points[of_region_[open - surplus.begin()]];
    throw InvalidInput(
        fmt::format("fill: expected closed curves, got one that ends at ({:.6g}, {:.6g}, {:.6g}) (--close)", place[0],
                    place[1], place[2]));
  }

  /// Whether the largest of the curves is around what is left.
  bool is_enclosed() const {
    DisjointSets loops(region_.points.size());
    for (const auto& [a, b] : region_.segments) loops.join(a, b);
    std::vector<double> area(region_.points.size(), 0);
    for (const auto& [a, b] : region_.segments) {
      const Vec2d p = region_.points[a] - region_.points[0], q = region_.points[b] - region_.points[0];
      area[loops.first(a)] += p[0] * q[1] - p[1] * q[0];
    }
    return *std::ranges::max_element(area, {}, [](double a) { return std::abs(a); }) > 0;
  }

  void add_farfield() {
    Vec2d lowest(std::numeric_limits<double>::infinity()), highest = -lowest;
    for (const Vec2d& x : region_.points)
      for (int k = 0; k < 2; ++k) lowest[k] = std::min(lowest[k], x[k]), highest[k] = std::max(highest[k], x[k]);
    const Farfield& far = options_.farfield;
    if (far.shape == Farfield::Shape::Given)
      throw InvalidInput("farfield: expected a sphere or a box around curves, got a surface");
    const Vec2d size = highest - lowest, middle = (lowest + highest) / 2;
    const double reach = far.in_lengths ? far.size * std::max(size[0], size[1]) : far.size;
    const bool is_box = far.shape == Farfield::Shape::Box;
    if (const double least = is_box ? 0.1 * std::max(size[0], size[1]) : 0.6 * size.length(); !(reach >= least))
      throw InvalidInput(fmt::format("farfield: expected {} of at least {:.3g}, to enclose the layers, got {:.3g}",
                                     is_box ? "a box beyond them" : "a radius", least, reach));
    const auto patch = static_cast<Index>(volume_.patches.size());
    volume_.patches.push_back({.name = "farfield", .kind = BoundaryPatch::Kind::Outer});
    const auto first = static_cast<Index>(volume_.points.size());
    for (int i = 0; i < kFarSegments; ++i) {
      const Vec2d x =
          is_box ? on_square(i, lowest - Vec2d(reach), highest + Vec2d(reach)) : middle + on_circle(i) * reach;
      volume_.points.push_back(origin_ + axes_[0] * x[0] + axes_[1] * x[1]);
    }
    for (Index i = 0; i < kFarSegments; ++i) add(first + i, first + (i + 1) % kFarSegments, patch, kNone);
  }
  static Vec2d on_circle(int i) {
    const double angle = 2 * std::numbers::pi * i / kFarSegments;
    return {std::cos(angle), std::sin(angle)};
  }
  static Vec2d on_square(int i, const Vec2d& lowest, const Vec2d& highest) {
    constexpr int kOnSide = kFarSegments / 4;
    const double share = static_cast<double>(i % kOnSide) / kOnSide;
    const Vec2d corner[] = {lowest, {highest[0], lowest[1]}, highest, {lowest[0], highest[1]}};
    const int side = i / kOnSide;
    return corner[side] + (corner[(side + 1) % 4] - corner[side]) * share;
  }

  void join(const PlaneMesh& mesh) {
    const auto first = static_cast<Index>(volume_.points.size()), given = static_cast<Index>(of_region_.size());
    for (const Vec2d& x : mesh.added) volume_.points.push_back(origin_ + axes_[0] * x[0] + axes_[1] * x[1]);
    std::map<PlaneEdge, Index> cells;  // by the sides that they have
    for (const auto& triangle : mesh.triangles) {
      const auto cell = static_cast<Index>(volume_.cell_count());
      for (std::size_t k = 0; k < 3; ++k) {
        const Index p = triangle[k];
        volume_.corners.push_back(p < given ? of_region_[p] : first + p - given);
        if (p < given && triangle[(k + 1) % 3] < given) cells[{p, triangle[(k + 1) % 3]}] = cell;
      }
      volume_.cell_begin.push_back(volume_.corners.size());
      volume_.cell_types.push_back(CellType::Triangle);
    }
    for (std::size_t s = 0; s < region_.segments.size(); ++s) {
      const auto found = cells.find(region_.segments[s]);
      if (found == cells.end())
        throw FillFailed("fill: expected a mesh that keeps all segments, got one that does not");
      on_segment_.push_back(found->second);
      if (patch_[s] == kNone) continue;
      BoundaryPatch& patch = volume_.patches[patch_[s]];
      for (const Index p : region_.segments[s]) patch.corners.push_back(of_region_[p]);
      patch.face_begin.push_back(static_cast<Index>(patch.corners.size()));
      patch.cell.push_back(found->second);
    }
  }

  void add_fields() {
    constexpr float kNoLayer = -1;
    for (VolumeField& field : volume_.point_fields)
      field.values.resize(volume_.points.size(), field.name == "layer" ? kNoLayer : 0.0F);
    std::erase_if(volume_.cell_fields, [](const VolumeField& field) {
      return field.name == "scaled_jacobian" || field.name == "aspect_ratio";
    });
    for (VolumeField& field : volume_.cell_fields)
      field.values.resize(volume_.cell_count(), field.name == "layer" ? 0.0F : kNoLayer);
    for (VolumeField& field : quality_fields(volume_)) volume_.cell_fields.push_back(std::move(field));
  }

  void make_report(FillReport& report) const {
    report.triangles = volume_.cell_count() - layer_cells_;
    report.added_points = volume_.points.size() - layer_points_;
    report.front = front_;
    report.scaled_jacobian =
        spread_of(report.triangles, [&](std::size_t i) { return scaled_jacobian(volume_, layer_cells_ + i); });
    for (std::size_t c = layer_cells_; c < volume_.cell_count(); ++c) report.volume += cell_volume(volume_, c);
    std::vector<double> jumps;
    for (std::size_t s = 0; s < front_; ++s) {
      if (behind_[s] == kNone) continue;
      const double ratio = cell_volume(volume_, on_segment_[s]) / cell_volume(volume_, behind_[s]);
      if (ratio > 0) jumps.push_back(std::max(ratio, 1 / ratio));
    }
    if (!jumps.empty()) report.jump = spread_of(jumps.size(), [&](std::size_t i) { return jumps[i]; });
  }

  const CurvesView& segments_;
  const LayersResult& layers_;
  const FillOptions& options_;
  LayerCellFacts facts_;
  VolumeMesh volume_;
  std::array<Vec3d, 2> axes_;
  Vec3d origin_;
  PlaneRegion region_;
  std::map<Index, Index> number_;                   // of the mesh's points, in the region
  std::vector<Index> of_region_;                    // and the other way round
  std::vector<Index> patch_, behind_, on_segment_;  // of each segment: its patch, the layers' cell, the triangle
  std::size_t layer_cells_ = 0, layer_points_ = 0, front_ = 0;
};

}  // namespace

VolumeMesh fill_plane(CurveCells cells, const LayersResult& layers, const FillOptions& options, FillReport* report) {
  if (!(options.growth > 1)) throw InvalidOption("fill: expected a growth above 1");
  if (cells.mesh.points.empty()) throw InvalidInput("fill: expected layers, got none");
  const Polygons segments = std::move(cells.segments);
  const CurvesView view = segments.view();
  report_share(options.progress, Stage::Fill, 0);
  PlaneFilling filling(view, layers, options, std::move(cells));
  filling.fill();
  report_share(options.progress, Stage::Fill, 1);
  return filling.finish(report);
}

VolumeMesh extruded(const VolumeMesh& plane, double thickness) {
  if (!plane.plane()) throw InvalidInput("extruded: expected a plane mesh, got another");
  VolumeMesh solid;
  const auto count = static_cast<Index>(plane.points.size());
  solid.points = plane.points;
  for (const Vec3d& x : plane.points) solid.points.push_back(x + plane.normal * thickness);
  solid.patches = plane.patches;
  for (BoundaryPatch& patch : solid.patches) {
    std::vector<Index> corners;
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      const auto edge = patch.face(f);
      corners.insert(corners.end(), {edge[0], edge[1], edge[1] + count, edge[0] + count});
      patch.face_begin[f] = static_cast<Index>(corners.size() - 4);
    }
    patch.face_begin.back() = static_cast<Index>(corners.size());
    patch.corners = std::move(corners);
  }
  BoundaryPatch& ends = solid.patches.emplace_back();
  ends.name = "front_and_back";
  ends.kind = BoundaryPatch::Kind::Empty;
  for (std::size_t c = 0; c < plane.cell_count(); ++c) {
    const auto cell = plane.cell(c);
    const auto add_end = [&] {
      ends.face_begin.push_back(static_cast<Index>(ends.corners.size()));
      ends.cell.push_back(static_cast<Index>(c));
    };
    ends.corners.insert(ends.corners.end(), cell.rbegin(), cell.rend());
    add_end();
    for (const Index p : cell) ends.corners.push_back(p + count);
    add_end();
    solid.corners.insert(solid.corners.end(), cell.begin(), cell.end());
    for (const Index p : cell) solid.corners.push_back(p + count);
    solid.cell_begin.push_back(solid.corners.size());
    solid.cell_types.push_back(cell.size() == 3 ? CellType::Prism : CellType::Hexahedron);
  }
  solid.point_fields = plane.point_fields;
  for (VolumeField& field : solid.point_fields) {
    const std::vector<float> values = field.values;
    field.values.insert(field.values.end(), values.begin(), values.end());
  }
  for (const VolumeField& field : plane.cell_fields)
    if (field.name != "scaled_jacobian" && field.name != "aspect_ratio") solid.cell_fields.push_back(field);
  for (VolumeField& field : quality_fields(solid)) solid.cell_fields.push_back(std::move(field));
  return solid;
}

}  // namespace vdb_offset
