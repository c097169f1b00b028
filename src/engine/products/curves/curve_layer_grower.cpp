// SPDX-License-Identifier: Apache-2.0
#include "products/curves/curve_layer_grower.h"

#include <algorithm>

#include "ground/system/parallel.h"
#include "ground/system/progress_count.h"
#include "products/layers/layer_grower.h"
#include "products/layers/layer_wall.h"

namespace vdb_offset {
namespace {

/// Whether the turn from b to c, as seen from a, is counterclockwise by more than the least angle; or clockwise if the
/// sign is -1.
bool turns(const Vec3d& a, const Vec3d& b, const Vec3d& c, double sign) {
  const Vec3d ab = b - a, ac = c - a;
  return sign * (ab[0] * ac[1] - ab[1] * ac[0]) > kLeastLean * ab.length() * ac.length();
}

/// The curves that layers are grown on: columns stand on segments.
class CurveWall final : public LayerWall {
 public:
  CurveWall(const PlaneCurves& curves, CurveFaults& faults, RailStacks& stacks)
      : LayerWall(stacks), side_(stacks.asked().side), curves_(curves), faults_(faults) {}

 private:
  bool moves(std::uint32_t p) const override { return stacks_.asked().thickness(p) != 0; }

  /// False where curves branch.
  bool sees_all_faces(std::uint32_t p, const Vec3d& displacement) const override {
    const auto around = faults_.around(p);
    for (const auto s : around)
      if (!(side_ * curves_.line().triangle_normals[s].dot(displacement) > kLeastSlope * displacement.length()))
        return false;
    return around.size() <= 2;
  }
  Vec3d direction_of(std::uint32_t p) const override { return start_direction(curves_.line(), p); }

  std::size_t column_count() const override { return curves_.line().segments.size(); }
  std::span<const std::uint32_t> base(std::size_t s) const override { return curves_.line().segments[s]; }
  std::span<const std::uint32_t> columns_around(std::uint32_t p) const override { return faults_.around(p); }

  /// Every cell turns the right way at each corner that is not flat.
  bool is_valid(std::size_t s) const override {
    const auto a = stacks_.of(base(s)[0]), b = stacks_.of(base(s)[1]);
    const bool a_flat = a.front() == a.back(), b_flat = b.front() == b.back();
    if (a_flat && b_flat) return true;
    const double sign = -side_;  // outward is to the right
    for (std::size_t k = 1; k < a.size(); ++k) {
      if (!a_flat && !(turns(a[k - 1], b[k - 1], a[k], sign) && turns(a[k], a[k - 1], b[k], sign))) return false;
      if (!b_flat && !(turns(b[k - 1], b[k], a[k - 1], sign) && turns(b[k], a[k], b[k - 1], sign))) return false;
    }
    return true;
  }

  void put(const Indices& points) override {
    for_each_index(
        points.size(),
        [&](std::size_t i) {
          const std::uint32_t p = points[i];
          stacks_.flatten(p);
          if (stacks_.share(p) > 0)
            stacks_.put_down(p, 1, QueryDistance<CurveQuery>(curves_.query, faults_.around(p).front()),
                             [](std::size_t, double) { return true; });
        },
        64);
  }

  void find_faults(const Indices& points) override {
    std::vector<Vec2d> positions;
    positions.reserve(points.size());
    for (const auto p : points) positions.emplace_back(stacks_.outermost(p)[0], stacks_.outermost(p)[1]);
    faults_.move(points, positions);
  }
  Indices faulty_vertices() const override { return faults_.faulty_points(); }
  double distance_of(std::uint32_t p) const override { return faults_.distance_of(p); }

  int side_;
  const PlaneCurves& curves_;
  CurveFaults& faults_;
};

}  // namespace

LayerStack stack_curves(const PlaneCurves& curves, std::span<const Distances> heights, CurveFaults& faults,
                        Paths& paths, const ProgressCallback& callback) {
  // Half of the stage is shown as done after this many rounds. Not measured.
  constexpr std::size_t kExpectedRounds = 32;
  Progress progress(callback, Stage::Layers, kExpectedRounds, Units::Unknown);
  const double z = curves.line().vertices.front()[2] + curves.line().origin[2];
  std::vector<Vec3d> source;
  source.reserve(curves.source.size());
  for (const Vec2d& p : curves.source) source.emplace_back(p[0], p[1], z);
  AskedLayers asked(source, curves.line().origin, heights);
  asked.stretch_mitered(paths);
  RailStacks stacks(asked, paths);
  CurveWall wall(curves, faults, stacks);
  LayerStack stack = grow_on(wall, paths, {}, progress);
  round_layers(
      source, curves.precision, [](std::uint32_t) { return true; },
      [&](std::uint32_t p, const Vec3d& position) -> std::optional<double> {
        return curves.query(curves.in_frame({position[0], position[1]}), faults.around(p).front()).distance;
      },
      stack, paths);
  return stack;
}

}  // namespace vdb_offset
