// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "ground/system/assert.h"

namespace vdb_offset {

/// Dot product, by four sums at a time: a single sum would wait for each addition before the next. \pre equal sizes
inline double dot(std::span<const double> a, std::span<const double> b) {
  constexpr std::size_t kSums = 4;
  VDB_OFFSET_ASSERT(a.size() == b.size());
  std::array<double, kSums> sum{};
  std::size_t i = 0;
  for (; i + kSums <= a.size(); i += kSums)
    for (std::size_t k = 0; k < kSums; ++k) sum[k] += a[i + k] * b[i + k];
  for (; i < a.size(); ++i) sum[0] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// L-BFGS: descent directions of a function, with what its last steps show about its curvature (Nocedal and Wright,
/// Numerical Optimization, 2006, algorithm 7.4). remember() each step, then ask for the next one by descend().
class QuasiNewton {
 public:
  /// How many steps are remembered. Not measured.
  static constexpr std::size_t kMemory = 8;

  /// Remembers a step from x, where the gradient is g, to next_x; not one along which the gradient does not grow, as
  /// such a step would spoil the model. \pre equal sizes, those of all steps before
  void remember(std::span<const double> x, std::span<const double> next_x, std::span<const double> g,
                std::span<const double> next_g) {
    VDB_OFFSET_ASSERT(next_x.size() == x.size() && g.size() == x.size() && next_g.size() == x.size());
    VDB_OFFSET_ASSERT(steps_.empty() || steps_.front().s.size() == x.size());
    // Cosine of the angle between step and change of gradient below which the change is no more than rounding.
    constexpr double kLeastCurvature = 1e-12;
    Step step{std::vector<double>(x.size()), std::vector<double>(x.size()), 0};
    for (std::size_t k = 0; k < x.size(); ++k) {
      step.s[k] = next_x[k] - x[k];
      step.y[k] = next_g[k] - g[k];
    }
    const double curvature = dot(step.s, step.y);
    if (!(curvature > kLeastCurvature * std::sqrt(dot(step.s, step.s) * dot(step.y, step.y)))) return;
    step.rho = 1 / curvature;
    steps_.push_back(std::move(step));
    if (steps_.size() > kMemory) steps_.pop_front();
  }

  /// The step to where the gradient g would vanish, were the function as it was along the steps remembered; without
  /// any, -g. \pre equal sizes
  void descend(std::span<const double> g, std::span<double> step) const {
    VDB_OFFSET_ASSERT(step.size() == g.size() && (steps_.empty() || steps_.front().s.size() == g.size()));
    for (std::size_t k = 0; k < g.size(); ++k) step[k] = -g[k];
    std::array<double, kMemory> alpha{};
    for (std::size_t p = steps_.size(); p-- > 0;) {
      alpha[p] = steps_[p].rho * dot(steps_[p].s, step);
      add(-alpha[p], steps_[p].y, step);
    }
    if (steps_.empty()) return;
    const double scale = 1 / (steps_.back().rho * dot(steps_.back().y, steps_.back().y));
    for (double& s : step) s *= scale;
    for (std::size_t p = 0; p < steps_.size(); ++p)
      add(alpha[p] - steps_[p].rho * dot(steps_[p].y, step), steps_[p].s, step);
  }

 private:
  struct Step {
    std::vector<double> s, y;  // differences of positions and of gradients
    double rho;                // 1 / (s . y)
  };
  static void add(double factor, std::span<const double> a, std::span<double> sum) {
    for (std::size_t k = 0; k < a.size(); ++k) sum[k] += factor * a[k];
  }

  std::deque<Step> steps_;
};

}  // namespace vdb_offset
