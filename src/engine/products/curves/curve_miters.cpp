// SPDX-License-Identifier: Apache-2.0
#include "products/curves/curve_miters.h"

#include <numeric>
#include <vector>

#include "motion/paths/miters.h"

namespace vdb_offset {
namespace {

/// Moves some points to the ends of their paths.
void move_to_path_ends(const PlaneCurves& curves, const Paths& paths, const Indices& points, CurveFaults& faults) {
  std::vector<Vec2d> ends;
  ends.reserve(points.size());
  for (const auto p : points)
    ends.push_back(curves.source[p] + Vec2d(paths.displacement[p][0], paths.displacement[p][1]));
  faults.move(points, ends);
}

}  // namespace

void miter_sound_corners(const PlaneCurves& curves, Paths& paths) {
  if (curves.miters.empty()) return;
  MiteredPaths mitered(curves.miters, paths);
  CurveFaults faults(curves);
  Indices all(curves.source.size());
  std::iota(all.begin(), all.end(), 0u);
  move_to_path_ends(curves, paths, all, faults);
  for (Indices back = mitered.take_back(faults.faulty_points(), paths); !back.empty();
       back = mitered.take_back(faults.faulty_points(), paths))
    move_to_path_ends(curves, paths, back, faults);
  // Those whose faults are not theirs, one by one.
  for (const auto p : mitered.taken_back()) {
    const std::size_t before = faults.total();
    move_to_path_ends(curves, paths, mitered.miter_again({p}, paths), faults);
    if (faults.total() > before) move_to_path_ends(curves, paths, mitered.take_back({p}, paths), faults);
  }
}

}  // namespace vdb_offset
