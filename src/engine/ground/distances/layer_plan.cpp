// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/layer_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "ground/system/parallel.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// The thickness of the outermost of so many layers, the first of which has a thickness of 1, and of all together.
struct Stack {
  double last, total;
};

Stack stack_of(std::size_t count, double growth) {
  Stack stack{1, 1};
  for (std::size_t k = 1; k < count; ++k) stack.total += stack.last *= growth;
  return stack;
}

// How far lengths that are to be the same may be apart. Reasoned: users write five digits.
constexpr double kSame = 1e-6;

/// The growth with which what rises with it has a value, by bisection: products and sums alone are the same on every
/// machine, other than powers and logarithms. NaN if it would have to be above kMostGrowth.
double growth_with(double wanted, const std::function<double(double)>& rising) {
  double low = 0, high = kMostGrowth;
  if (!(rising(high) >= wanted)) return std::nan("");
  for (double middle = 1; middle != low && middle != high; middle = (low + high) / 2)
    (rising(middle) < wanted ? low : high) = middle;
  return high;
}

/// What is known at one vertex, without its sign.
struct Known {
  double first = 0, total = 0, last = 0;
};

/// Makes heights of a plan. Lengths are those of the vertices that have any.
class LayerPlanner {
 public:
  explicit LayerPlanner(const LayerPlan& plan) : plan_(plan), count_(plan.count.value_or(0)) {
    const std::optional<Distances>* const lengths[] = {&plan.first, &plan.total, &plan.last};
    const auto known =
        std::count_if(std::begin(lengths), std::end(lengths), [](auto* each) { return each->has_value(); });
    const bool by_count = plan.count && known + (plan.growth ? 1 : 0) == 2 && known > 0,
               by_growth = !plan.count && plan.growth && plan.first && known == 2;
    if (!by_count && !by_growth)
      throw InvalidInput(
          "layers: expected their number with two of the first height, the total thickness, the last height and the "
          "growth, or the first height, one of the other two and the growth");
    if (plan.count && (*plan.count < 1 || *plan.count > kMostLayers))
      throw InvalidInput(fmt::format("layers: expected 1 to {}, got {}", kMostLayers, *plan.count));
    if (plan.growth && !(*plan.growth > 0 && *plan.growth <= kMostGrowth))
      throw InvalidInput(
          fmt::format("layers: expected a growth above 0, up to {:g}, got {:g}", kMostGrowth, *plan.growth));
    for (const auto* each : lengths) add_vertices_of(*each);
  }

  std::vector<Distances> operator()() {
    const std::size_t rows = std::max<std::size_t>(vertices_, 1);
    for (std::size_t v = 0; v < rows; ++v)
      if (has_layers(v)) require_lengths(v);
    if (count_ == 0)
      for (std::size_t v = 0; v < rows; ++v)
        if (has_layers(v)) count_ = std::max(count_, count_at(v));
    count_ = std::max<std::size_t>(count_, 1);
    std::vector<double> growth(rows, 0.0);
    for_each_index(
        rows, [&](std::size_t v) { growth[v] = has_layers(v) ? growth_at(v) : 0; }, 64);
    for (std::size_t v = 0; v < rows; ++v) require_growth(v, growth[v]);
    return with_growth(growth);
  }

 private:
  void add_vertices_of(const std::optional<Distances>& lengths) {
    if (!lengths || lengths->uniform()) return;
    if (vertices_ != 0 && vertices_ != lengths->count())
      throw InvalidInput(
          fmt::format("layers: expected lengths of as many vertices, got {} and {}", vertices_, lengths->count()));
    vertices_ = lengths->count();
  }

  static double at(const std::optional<Distances>& lengths, std::size_t v) { return lengths ? (*lengths)[v] : 0; }

  bool has_layers(std::size_t v) const {
    for (const auto* each : {&plan_.first, &plan_.total, &plan_.last})
      if (each->has_value() && (**each)[v] == 0) return false;
    return true;
  }

  std::string place(std::size_t v) const {
    return vertices_ == 0 ? "layers" : fmt::format("layers at vertex {} (counted from 0)", v);
  }

  Known known_at(std::size_t v) const {
    return {std::abs(at(plan_.first, v)), std::abs(at(plan_.total, v)), std::abs(at(plan_.last, v))};
  }

  /// \throw InvalidInput for lengths of both signs, and one that is not less than that of all layers
  void require_lengths(std::size_t v) const {
    bool outward = false, inward = false;
    for (const auto* each : {&plan_.first, &plan_.total, &plan_.last}) {
      outward = outward || at(*each, v) > 0;
      inward = inward || at(*each, v) < 0;
    }
    if (outward && inward)
      throw InvalidInput(place(v) + ": expected lengths of one sign: all above 0, or all below for layers inward");
    const Known known = known_at(v);
    if (!plan_.total || count_ == 1) return;
    if (plan_.first) require_below_total(v, "first height", known.first, known.total);
    if (plan_.last) require_below_total(v, "last height", known.last, known.total);
  }

  /// The least number of layers that grow by no more than is allowed.
  std::size_t count_at(std::size_t v) const {
    const Known known = known_at(v);
    const double wanted = (plan_.total ? known.total : known.last) / known.first * (1 - kSame);
    Stack stack{1, 1};
    for (std::size_t count = 1; count <= kMostLayers; ++count) {
      if ((plan_.total ? stack.total : stack.last) >= wanted) return count;
      stack.total += stack.last *= *plan_.growth;
    }
    throw InvalidInput(fmt::format(
        "{}: expected a growth with which {} layers or less come from a first height of {:g} to {:g}, got {:.10g}",
        place(v), kMostLayers, known.first, plan_.total ? known.total : known.last, *plan_.growth));
  }

  /// The growth of all layers at a vertex; NaN if it would have to be too large.
  double growth_at(std::size_t v) const {
    if (plan_.count && plan_.growth) return *plan_.growth;
    const Known known = known_at(v);
    if (plan_.first && plan_.total)
      return grown(known.total / known.first, [&](double g) { return stack_of(count_, g).total; });
    if (plan_.first) return grown(known.last / known.first, [&](double g) { return stack_of(count_, g).last; });
    // From the outermost layer inward.
    return 1 / grown(known.total / known.last, [&](double g) { return stack_of(count_, g).total; });
  }

  double grown(double wanted, const std::function<double(double)>& rising) const {
    if (count_ == 1) return std::abs(wanted - 1) <= kSame ? 1 : std::nan("");
    return growth_with(wanted, rising);
  }

  void require_below_total(std::size_t v, const char* what, double one, double total) const {
    // One layer may be as thick as all are.
    if (!(count_ == 0 ? one <= total : one < total))
      throw InvalidInput(
          fmt::format("{}: expected a {} below the total thickness of {:g}, got {:g}", place(v), what, total, one));
  }

  void require_growth(std::size_t v, double growth) const {
    if (growth <= kMostGrowth && !std::isfinite(stack_of(count_, growth).total))
      throw InvalidInput(
          fmt::format("{}: expected fewer layers, or a growth below {:g}: {} of them are thicker than a number can say",
                      place(v), growth, count_));
    if (growth <= kMostGrowth) return;
    throw InvalidInput(
        count_ == 1
            ? place(v) +
                  ": expected lengths that are the same for one layer, and a last height above the first for more"
            : fmt::format(
                  "{}: expected lengths between which {} layers grow by no more than {:g} (more layers grow less)",
                  place(v), count_, kMostGrowth));
  }

  std::vector<Distances> with_growth(const std::vector<double>& growth) const {
    std::vector<Distances> heights;
    for (std::size_t k = 1; k <= count_; ++k) {
      std::vector<double> height(growth.size(), 0.0);
      for_each_index(height.size(),
                     [&](std::size_t v) { height[v] = growth[v] == 0 ? 0 : height_at(v, k, growth[v]); });
      heights.push_back(vertices_ == 0 ? Distances(height[0]) : Distances(std::move(height)));
    }
    return heights;
  }

  /// The height of the top of layer k, counted from 1. What is given is kept to the last bit.
  double height_at(std::size_t v, std::size_t k, double growth) const {
    if (k == count_ && plan_.total) return at(plan_.total, v);
    const double share = stack_of(k, growth).total;
    if (plan_.first) return at(plan_.first, v) * share;
    const Stack all = stack_of(count_, growth);
    return plan_.total ? at(plan_.total, v) * (share / all.total) : at(plan_.last, v) * (share / all.last);
  }

  const LayerPlan& plan_;
  std::size_t count_, vertices_ = 0;
};

}  // namespace

std::vector<Distances> plan_layers(const LayerPlan& plan) { return LayerPlanner(plan)(); }

LayerGrowth growth_of(std::span<const Distances> heights) {
  LayerGrowth growth;
  std::size_t vertices = 1;
  for (const Distances& each : heights) vertices = std::max(vertices, each.count());
  for (std::size_t v = 0; v < vertices; ++v)
    for (std::size_t k = 1; k < heights.size(); ++k) {
      const double below = heights[k - 1][v] - (k > 1 ? heights[k - 2][v] : 0);
      if (below == 0) continue;
      const double each = (heights[k][v] - heights[k - 1][v]) / below;
      growth.least = growth.least == 0 ? each : std::min(growth.least, each);
      growth.largest = std::max(growth.largest, each);
    }
  // Heights are sums, whose last bits say nothing.
  constexpr double kDigits = 1e6;
  return {std::round(growth.least * kDigits) / kDigits, std::round(growth.largest * kDigits) / kDigits};
}

double height_of_y_plus(double y_plus, double reynolds) {
  const auto require = [](const char* what, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw InvalidInput(fmt::format("{}: expected a number above 0, got {:g}", what, value));
  };
  require("y+", y_plus);
  require("Reynolds number", reynolds);
  const double laminar = 0.664 / std::sqrt(reynolds), digits = 2 * std::log10(reynolds) - 0.65,
               turbulent = digits > 0 ? std::pow(digits, -2.3) : 0;
  // The law of turbulent layers is for large numbers: towards 2 it grows without bounds.
  constexpr double kLeastTurbulent = 1000;
  const double friction = reynolds < kLeastTurbulent ? laminar : std::max(laminar, turbulent),
               height = y_plus / (reynolds * std::sqrt(friction / 2));
  // Powers and logarithms differ in their last bits between machines.
  return decimal<double>(fmt::format("{:.6g}", height)).value_or(height);
}

}  // namespace vdb_offset
