// SPDX-License-Identifier: Apache-2.0
// Reads distances as users write them: numbers, percentages and expressions.
#include <fmt/format.h>

#include <string_view>

#include "vdb_offset/distances.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

GivenDistance parse_distance(const std::string& text) {
  GivenDistance distance;
  std::string_view number = text;
  if (number.ends_with('%')) {
    distance.percent = true;
    number.remove_suffix(1);
  }
  const auto value = decimal<double>(number);
  if (!value)
    throw InvalidInput(
        fmt::format("distance: expected a number of world units, or of percent as in '1.5%', got '{}'", text));
  distance.value = *value;
  return distance;
}

GivenDistance parse_distance_or_expression(const std::string& text) {
  try {
    return parse_distance(text);
  } catch (const InvalidInput&) {
    GivenDistance distance;
    distance.expression.emplace(text);
    return distance;
  }
}

Distances distances_of(const GivenDistance& distance, PolygonView mesh, const VariableSources& sources) {
  if (!distance.expression) {
    const double diagonal = distance.percent ? used_diagonal(mesh) : 0, length = distance.in_world_units(diagonal);
    if (length == 0 && distance.value != 0 && diagonal > 0)
      throw InvalidInput(
          fmt::format("distance: expected a share of the diagonal that is a number, got {:g} % of {:.3g} "
                      "(scale the model)",
                      distance.value, diagonal));
    return length;
  }
  const DistanceExpression& expression = *distance.expression;
  std::vector<Vec3d> normals;
  std::vector<Vec2d> texture;
  std::vector<double> edges;
  if (expression.uses_normals()) normals = sources.normals();
  if (expression.uses_texture()) texture = sources.texture();
  if (expression.uses_edges()) edges = sources.edges();
  return Distances(
      expression({mesh.positions, normals, texture, expression.is_percent() ? used_diagonal(mesh) : 0, edges}));
}

double GivenDistance::in_world_units(double diagonal) const { return percent ? value / 100 * diagonal : value; }

}  // namespace vdb_offset
