// SPDX-License-Identifier: Apache-2.0
#include "page/page_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vdb_offset::io {
namespace {

constexpr std::size_t kSteps = 20;  // bars of a histogram from 0 to 1
constexpr std::size_t kStepsAbove = 12;
constexpr double kStepAbove = 0.25;

/// The step that a number falls into; the first or the last for one beyond them.
std::size_t step_of(double number, double step, std::size_t count) {
  return static_cast<std::size_t>(std::clamp(std::floor(number / step), 0.0, static_cast<double>(count - 1)));
}

}  // namespace

std::vector<float> shares_of(const PageSurface& surface, std::size_t vertices) {
  std::vector<float> shares(vertices, std::numeric_limits<float>::quiet_NaN());
  const bool is_known = !surface.achieved.empty() && surface.target;
  for (std::size_t v = 0; v < shares.size(); ++v) {
    if (is_known && (*surface.target)[v] != 0)
      shares[v] = static_cast<float>(surface.achieved[v] / std::abs((*surface.target)[v]));
    if (!is_known && !surface.share.empty()) shares[v] = static_cast<float>(surface.share[v]);
  }
  return shares;
}

nlohmann::json histogram_of_shares(std::span<const float> shares, std::span<const VertexState> states) {
  std::array<std::size_t, kSteps> below{};
  std::array<std::size_t, kStepsAbove> above{};
  std::size_t at = 0;
  for (std::size_t v = 0; v < shares.size(); ++v) {
    const double share = shares[v];
    const bool is_reached =
        std::abs(share - 1) <= kReachedTolerance || (!states.empty() && states[v] == VertexState::Reached);
    if (std::isnan(share) || (!states.empty() && states[v] == VertexState::Unused)) continue;
    if (is_reached) ++at;
    else if (share < 1) ++below[step_of(share, 1.0 / kSteps, kSteps)];
    else ++above[step_of(share - 1, kStepAbove, kStepsAbove)];
  }
  return {{"below", below}, {"at", at}, {"above", above}, {"step_above", kStepAbove}};
}

nlohmann::json histogram_of_quality(std::span<const float> scaled_jacobian) {
  std::array<std::size_t, kSteps> counts{};
  std::size_t invalid = 0;
  for (const float quality : scaled_jacobian) {
    if (quality > 0) ++counts[step_of(quality, 1.0 / kSteps, kSteps)];
    else ++invalid;
  }
  return {{"invalid", invalid}, {"counts", counts}};
}

nlohmann::json counts_of_states(std::span<const VertexState> states) {
  std::array<std::size_t, kVertexStateCount> counts{};
  for (const VertexState state : states) ++counts[static_cast<std::size_t>(state)];
  return counts;
}

}  // namespace vdb_offset::io
