// SPDX-License-Identifier: Apache-2.0
// What vertices have achieved, in figures.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "vdb_offset/report.h"

namespace vdb_offset {
namespace {

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const auto at = std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

}  // namespace

AchievedSummary summarise(std::span<const VertexState> states, std::span<const double> all_achieved,
                          const Distances& distances) {
  AchievedSummary summary;
  std::vector<double> achieved;
  achieved.reserve(states.size());
  std::size_t reached = 0;
  double asked = 0;
  summary.asked_least = std::numeric_limits<double>::infinity();
  summary.asked_most = -summary.asked_least;
  const auto ask = [&](double distance) {
    summary.asked_least = std::min(summary.asked_least, distance);
    summary.asked_most = std::max(summary.asked_most, distance);
  };
  std::for_each(distances.at_corner().begin(), distances.at_corner().end(), ask);
  for (std::size_t v = 0; v < states.size(); ++v) {
    if (states[v] == VertexState::Unused) continue;
    achieved.push_back(all_achieved[v]);
    asked += distances[v];
    ask(distances[v]);
    reached += !falls_short(states[v]);
    if (states[v] != VertexState::Reached) continue;
    const double target = std::abs(distances[v]);
    if (target > 0)
      summary.worst_reached_error = std::max(summary.worst_reached_error, std::abs(achieved.back() - target) / target);
  }
  summary.vertices = achieved.size();
  if (achieved.empty()) return {};
  summary.asked_mean = asked / static_cast<double>(achieved.size());
  summary.share_reached = static_cast<double>(reached) / static_cast<double>(achieved.size());
  double sum = 0;
  for (const double x : achieved) sum += x;
  summary.mean = sum / static_cast<double>(achieved.size());
  const auto [least, most] = std::minmax_element(achieved.begin(), achieved.end());
  summary.least = *least;
  summary.most = *most;
  summary.quantile_01 = quantile(achieved, 0.01);
  summary.quantile_05 = quantile(achieved, 0.05);
  summary.median = quantile(achieved, 0.5);
  summary.quantile_95 = quantile(achieved, 0.95);
  return summary;
}

}  // namespace vdb_offset
