// SPDX-License-Identifier: Apache-2.0
// Distances by axis: the values of --distance-xy and --distance-z.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "request/option_values.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

// Largest ratio of the two distances, which a distance of 0 also gets: beyond this, the lesser distance drowns in the
// rounding of the larger one. Not measured.
constexpr double kMostRatio = 1000;

GivenDistance parse_one(const char* option, const std::string& text) {
  try {
    return parse_distance(text);
  } catch (const InvalidInput&) {
    throw UsageError(fmt::format("{}: expected a number of world units or percent, got '{}'", option, text));
  }
}

GivenDistance least_beside(GivenDistance other) {
  other.value /= kMostRatio;
  return other;
}

}  // namespace

std::optional<AxisDistances> parse_axes(const std::string& xy, const std::string& z) {
  if (xy.empty()) return std::nullopt;
  AxisDistances axes{parse_one("--distance-xy", xy), parse_one("--distance-z", z)};
  if (axes.xy.value == 0 && axes.z.value == 0)
    throw UsageError(fmt::format("--distance-z: expected one that is not 0, as --distance-xy is, got '{}'", z));
  if (axes.xy.value == 0) axes.xy = least_beside(axes.z);
  if (axes.z.value == 0) axes.z = least_beside(axes.xy);
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
