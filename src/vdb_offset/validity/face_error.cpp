// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/validity/face_error.h"

#include <algorithm>
#include <cmath>

#include "vdb_offset/base/assert.h"
#include "vdb_offset/base/parallel.h"

namespace vdb_offset {

FaceInteriorError measure_interior(const ConstrainedSurface& constrained, std::span<const Vec3d> positions,
                                   const Distances& distances, std::size_t most) {
  const Surface& surface = constrained.surface;
  const Vec3d origin = constrained.moving_part.surface().origin;
  const std::size_t all = surface.triangles.size(), count = most == 0 ? all : std::min(all, most);
  constexpr std::size_t kSamples = 4;  // of a triangle
  constexpr double kLeftOut = -1;      // the error of a sample that is left out
  // Share of the largest distance below which a sample counts as asked to stay. Reasoned: errors are relative.
  constexpr double kLeastTarget = 1e-3;
  VDB_OFFSET_ASSERT(positions.size() == surface.vertices.size());
  const double least_target = kLeastTarget * distances.scale();
  std::vector<double> error(kSamples * count, kLeftOut);
  const auto measure = [&](std::size_t i) {
    const auto t = static_cast<std::uint32_t>(i * all / count);
    if (!constrained.triangle_on_part(t)) return;
    const auto& [a, b, c] = surface.triangles[t];
    const double da = distances[a], db = distances[b], dc = distances[c];
    const Vec3d samples[kSamples] = {
        (positions[a] + positions[b] + positions[c]) / 3.0 - origin, (positions[a] + positions[b]) / 2.0 - origin,
        (positions[b] + positions[c]) / 2.0 - origin, (positions[c] + positions[a]) / 2.0 - origin};
    const double wanted[kSamples] = {std::abs(da + db + dc) / 3, std::abs(da + db) / 2, std::abs(db + dc) / 2,
                                     std::abs(dc + da) / 2};
    const std::uint32_t hint = constrained.hint_of_triangle(t), hints[kSamples] = {hint, hint, hint, hint};
    Closest closest[kSamples];
    constrained.moving_part.answer_together(samples, hints, closest);
    for (std::size_t k = 0; k < kSamples; ++k)
      if (wanted[k] > least_target) error[kSamples * i + k] = std::abs(closest[k].distance - wanted[k]) / wanted[k];
  };
  for_each_index(count, measure, 64);
  std::erase(error, kLeftOut);
  return sum_up_errors(std::move(error));
}

FaceInteriorError sum_up_errors(std::vector<double> errors) {
  if (errors.empty()) return {};
  FaceInteriorError result;
  result.samples = errors.size();
  for (const double e : errors) {
    result.mean += e / static_cast<double>(errors.size());
    result.worst = std::max(result.worst, e);
  }
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(99 * errors.size() / 100);
  std::nth_element(errors.begin(), at, errors.end());
  result.quantile_99 = *at;
  return result;
}

}  // namespace vdb_offset
