#include "vdb_offset/interior.h"

#include <algorithm>
#include <cmath>

#include "vdb_offset/parallel.h"

namespace vdb_offset {

InteriorError measure_interior(const Body& body, std::span<const Vec3d> places, const Distances& distances,
                               std::size_t most) {
  const Surface& surface = body.surface;
  const Vec3d origin = body.front.surface().origin;
  const std::size_t all = surface.triangles.size(), count = most == 0 ? all : std::min(all, most);
  constexpr std::size_t kSamples = 4, kBlock = 8;
  constexpr double kLeftOut = -1;
  const double least_target = 1e-3 * distances.scale();
  std::vector<double> error(kSamples * count, kLeftOut);
  const auto look = [&](std::size_t block) {
    const std::size_t first = block * kBlock, last = std::min(first + kBlock, count);
    std::vector<Vec3d> points;
    std::vector<double> wanted;
    std::vector<std::uint32_t> hints;
    for (std::size_t i = first; i < last; ++i) {
      const auto t = static_cast<std::uint32_t>(i * all / count);
      if (!body.is_front(t)) continue;
      const auto& [a, b, c] = surface.triangles[t];
      const Vec3d samples[kSamples] = {(places[a] + places[b] + places[c]) / 3.0, (places[a] + places[b]) / 2.0,
                                       (places[b] + places[c]) / 2.0, (places[c] + places[a]) / 2.0};
      const double da = distances[a], db = distances[b], dc = distances[c];
      const double targets[kSamples] = {std::abs(da + db + dc) / 3, std::abs(da + db) / 2, std::abs(db + dc) / 2,
                                        std::abs(dc + da) / 2};
      for (std::size_t k = 0; k < kSamples; ++k) {
        if (targets[k] <= least_target) continue;
        points.push_back(samples[k] - origin);
        wanted.push_back(targets[k]);
        hints.push_back(body.hint(a));
      }
    }
    std::vector<Closest> closest(points.size());
    body.front.answer_together(points, hints, closest);
    for (std::size_t i = 0; i < points.size(); ++i)
      error[kSamples * first + i] = std::abs(closest[i].distance - wanted[i]) / wanted[i];
  };
  for_each_index((count + kBlock - 1) / kBlock, look, 8);
  std::erase(error, kLeftOut);
  return sum_up_errors(std::move(error));
}

InteriorError sum_up_errors(std::vector<double> errors) {
  if (errors.empty()) return {};
  InteriorError result;
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
