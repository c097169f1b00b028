// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// What the names of an expression stand for: one of each for every vertex, or none of what is not used.
struct VertexVariables {
  std::span<const Vec3d> positions;  ///< x, y, z: world units.
  std::span<const Vec3d> normals;    ///< nx, ny, nz: unit length (see vertex_normals() in surface.h).
  std::span<const Vec2d> texture;    ///< u, v (see io::vertex_texture() in io/attributes.h).
  double diagonal = 0;  ///< Diagonal of the bounding box of the vertices in use, which percentages refer to.
};

/// A distance that differs from vertex to vertex, as users write it: world units ("0.1 + 0.05*sin(4*pi*z)"), or with a
/// percent sign behind the whole a share of the bounding-box diagonal of the vertices in use ("nz > 0 ? 1 : 0.5 %").
///
/// Numbers, the names of VertexVariables, the constants pi and e, + - * / ^ (powers, from the right), comparisons
/// (1 or 0), && || and `condition ? one : other`; the functions are those of muParser (log is the natural logarithm).
/// The decimal point is '.' in every locale.
class VDB_OFFSET_API DistanceExpression {
 public:
  /// \throw InvalidExpression with the column, counted from 1, what was expected there and what was found.
  explicit DistanceExpression(std::string text);

  const std::string& text() const { return text_; }
  bool is_percent() const { return percent_; }
  /// Whether the name of a variable or a constant occurs.
  bool uses(std::string_view name) const;
  bool uses_normals() const { return uses("nx") || uses("ny") || uses("nz"); }
  bool uses_texture() const { return uses("u") || uses("v"); }

  /// The distance at every vertex, world units. The result does not depend on the number of threads.
  /// \throw InvalidInput if what is used was not given for every vertex, or names the first vertex (an index, counted
  /// from 0) at which the result is a NaN or an infinity.
  std::vector<double> operator()(const VertexVariables& at) const;

 private:
  std::string text_;
  std::string code_;                // the text as muParser takes it, without the percent sign
  std::vector<std::string> names_;  // of variables and constants, as they occur
  bool percent_ = false;
};

}  // namespace vdb_offset
