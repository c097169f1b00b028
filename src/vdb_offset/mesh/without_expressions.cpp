// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/distances.h"
#include "vdb_offset/error.h"

// Stands in for distance_expression.cpp where the library is built without muParser: any expression is refused.
namespace vdb_offset {

DistanceExpression::DistanceExpression(std::string text) {
  throw InvalidExpression("distance '" + text +
                          "': expected a number, as this build is without expressions (VDB_OFFSET_EXPRESSIONS)");
}

bool DistanceExpression::uses(std::string_view) const { return false; }

std::vector<double> DistanceExpression::operator()(const VertexVariables& at) const {
  return std::vector<double>(at.positions.size());
}

std::function<double(const Vec3d&, const Vec3d&, const Vec2d&)> DistanceExpression::at_points(double) const {
  return {};
}

}  // namespace vdb_offset
