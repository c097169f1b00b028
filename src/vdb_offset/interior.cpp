#include "vdb_offset/interior.h"

#include <algorithm>
#include <cmath>

#include "vdb_offset/parallel.h"

namespace vdb_offset {

InteriorError measure_interior(const ClosestQuery& query, std::span<const Vec3d> places, double target,
                               std::size_t most) {
  const Surface& surface = query.surface();
  const std::size_t all = surface.triangles.size(), count = most == 0 ? all : std::min(all, most);
  constexpr std::size_t kSamples = 4;
  std::vector<double> error(kSamples * count);
  const auto look = [&](std::size_t i) {
    const auto t = static_cast<std::uint32_t>(i * all / count);
    const auto& [a, b, c] = surface.triangles[t];
    const Vec3d samples[kSamples] = {(places[a] + places[b] + places[c]) / 3.0, (places[a] + places[b]) / 2.0,
                                     (places[b] + places[c]) / 2.0, (places[c] + places[a]) / 2.0};
    for (std::size_t k = 0; k < kSamples; ++k)
      error[kSamples * i + k] = std::abs(query(samples[k] - surface.origin, t).distance - target) / target;
  };
  for_each_index(count, look, 64);
  InteriorError result;
  result.samples = error.size();
  for (const double e : error) {
    result.mean += e / static_cast<double>(error.size());
    result.worst = std::max(result.worst, e);
  }
  const auto at = error.begin() + static_cast<std::ptrdiff_t>(99 * error.size() / 100);
  std::nth_element(error.begin(), at, error.end());
  result.quantile_99 = *at;
  return result;
}

}  // namespace vdb_offset
