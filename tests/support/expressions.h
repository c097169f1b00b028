// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/distances.h"
#include "vdb_offset/run.h"

namespace vdb_offset::test {

/// One vertex whose variables all differ: x y z = 1 2 3, nx ny nz = 0 0.6 0.8, u v = 0.25 0.75; a diagonal of 200.
inline double value_of(const std::string& expression) {
  const std::vector<Vec3d> position = {{1, 2, 3}}, normal = {{0, 0.6, 0.8}};
  const std::vector<Vec2d> texture = {{0.25, 0.75}};
  return DistanceExpression(expression)({position, normal, texture, 200}).at(0);
}

/// What the exception says; empty if there is none.
template <class Exception, class Work>
std::string message(Work&& work) {
  try {
    work();
  } catch (const Exception& error) {
    return error.what();
  }
  return {};
}

inline std::string complaint(const std::string& expression) {
  return message<InvalidExpression>([&] { DistanceExpression{expression}; });
}

}  // namespace vdb_offset::test
