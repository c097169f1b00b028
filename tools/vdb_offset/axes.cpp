#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "args.h"

namespace vdb_offset::tool {
namespace {

// Beyond this, what is told of one axis drowns in the rounding of the other.
constexpr double kMostRatio = 1000;

scene::Distance parse_one(const char* option, const std::string& text) {
  scene::Distance distance;
  try {
    distance = scene::parse_distance(text);
  } catch (const InvalidInput&) {
    throw UsageError(fmt::format("{}: expected a number of world units or percent, got '{}'", option, text));
  }
  if (distance.value == 0)
    throw UsageError(
        fmt::format("{}: expected a distance other than 0, got '{}' (a thousandth of the other leaves that "
                    "direction next to as it is)",
                    option, text));
  return distance;
}

}  // namespace

std::optional<AxisDistances> parse_axes(const std::string& xy, const std::string& z) {
  if (xy.empty() && z.empty()) return std::nullopt;
  if (xy.empty() || z.empty())
    throw UsageError(
        fmt::format("--distance-{}: expected it with --distance-{}", xy.empty() ? "z" : "xy", xy.empty() ? "xy" : "z"));
  const AxisDistances axes{parse_one("--distance-xy", xy), parse_one("--distance-z", z)};
  if ((axes.xy.value < 0) != (axes.z.value < 0))
    throw UsageError(fmt::format("--distance-z: expected the sign of --distance-xy, got '{}' and '{}'", z, xy));
  return axes;
}

std::pair<Metric, double> settle_axes(const AxisDistances& axes, PolygonView mesh) {
  const double diagonal = axes.xy.percent || axes.z.percent ? used_diagonal(mesh) : 0;
  const double xy = axes.xy.in_world_units(diagonal), z = axes.z.in_world_units(diagonal), ratio = xy / z;
  if (!(std::max(ratio, 1 / ratio) <= kMostRatio * (1 + 1e-9)))
    throw UsageError(
        fmt::format("--distance-z: expected one within {} times --distance-xy, either way, got {:.6g} and "
                    "{:.6g}",
                    kMostRatio, z, xy));
  return {Metric::of_half_axes(xy, z), xy};
}

}  // namespace vdb_offset::tool
