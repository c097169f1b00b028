// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Distances of vertices: one for all, or one for each. World units; negative is inward, 0 leaves a vertex where it is.
class VDB_OFFSET_API Distances {
 public:
  Distances(double uniform = 0);  // NOLINT(google-explicit-constructor): one number is the usual case
  /// One number a vertex. \throw InvalidInput for one that is not finite, by its index.
  explicit Distances(std::vector<double> each);
  /// And a number for each corner of the mesh's faces, for those whose distance at a vertex is another than the
  /// vertex's, as beside a sharp edge between faces of different distances: miters are of these. Empty: none has.
  Distances(std::vector<double> each, std::vector<double> at_corner);

  double operator[](std::size_t vertex) const { return each_.empty() ? uniform_ : each_[vertex]; }
  bool uniform() const { return each_.empty(); }
  /// How many vertices have a distance of their own; 0 if all have the same.
  std::size_t count() const { return each_.size(); }
  /// The same without those of corners.
  Distances of_vertices() const { return each_.empty() ? Distances(uniform_) : Distances(each_); }
  /// One number for each corner of the mesh, or none: the distances of vertices are those of faces.
  std::span<const double> at_corner() const { return at_corner_; }

  /// The largest distance outward, and inward; both at least 0.
  double outward() const { return outward_; }
  double inward() const { return inward_; }
  /// The largest distance without its sign: what is small is small compared to this.
  double scale() const { return outward_ > inward_ ? outward_ : inward_; }
  /// The largest distance with its sign.
  double farthest() const { return outward_ >= inward_ ? outward_ : -inward_; }

 private:
  void extend(double distance);

  double uniform_ = 0, outward_ = 0, inward_ = 0;
  std::vector<double> each_, at_corner_;
};

/// Distances that faces ask for at their corners, which may be different ones at a vertex that they share.
struct FaceDistances {
  std::vector<double> at_corner;     ///< World units: one for each corner of the mesh, face by face.
  std::vector<std::uint32_t> part;   ///< Of each face: faces of one part ask for the same where they meet.
  std::vector<std::uint32_t> piece;  ///< Of each face: parts of one piece are blended with each other; empty: all are.
  double blend = 0;                  ///< World units, 0 or more: see vertex_distances().
};

/// One distance for each vertex of a mesh. At a distance s from the edge of another part, that part's distance at the
/// closest point of its edge has the weight S(1 - s / blend) beside the vertex's own part with a weight of 1, where S
/// rises from 0 to 1 with two derivatives of 0 at both ends: on the edge both count the same, and beyond `blend` only
/// the own. Where parts, or pieces, meet at a vertex, it has their mean, and corners their own (Distances::at_corner())
/// but where they are joined. Vertices at one position have the same. \throw InvalidInput if there is not a distance
/// for each corner, or not a part for each face
VDB_OFFSET_API Distances vertex_distances(PolygonView mesh, const FaceDistances& faces);

/// How lengths count along the axes: distances are those of a space in which coordinates are so many times as large.
/// A ball of radius d is an ellipsoid of half axes d / scale in the file's units.
struct VDB_OFFSET_API Metric {
  Vec3d scale{1.0};  ///< Each above 0.

  /// Half axes xy, xy and z, of one sign and not 0: distances are measured as those in the plane.
  static Metric of_half_axes(double xy, double z);

  bool even() const;
  /// From a position in the file to the metric's space, and back.
  Vec3d to(const Vec3d& p) const;
  Vec3d from(const Vec3d& q) const;
};

/// What the names of an expression stand for: one of each for every vertex, or none of what is not used.
struct VertexVariables {
  std::span<const Vec3d> positions;  ///< x, y, z: world units.
  std::span<const Vec3d> normals;    ///< nx, ny, nz: unit length (see vertex_normals() in mesh_facts.h).
  std::span<const Vec2d> texture;    ///< u, v (see io::vertex_texture() in io/mesh_file.h).
  double diagonal = 0;  ///< Diagonal of the bounding box of the vertices in use, which percentages refer to.
  std::span<const double> edges{};  ///< edge: mean length of a vertex's edges (see mean_edges() in mesh_facts.h).
};

/// The same of one point.
struct PointVariables {
  Vec3d position{0.0}, normal{0.0};
  Vec2d texture{0.0};
  double edge = 0;
};

/// What finds them for a mesh: each is called only if an expression uses it.
struct VariableSources {
  std::function<std::vector<Vec3d>()> normals;
  std::function<std::vector<Vec2d>()> texture;
  std::function<std::vector<double>()> edges;
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
  bool uses_edges() const { return uses("edge"); }

  /// The distance at every vertex, world units. The result does not depend on the number of threads.
  /// \throw InvalidInput if what is used was not given for every vertex, or names the first vertex (an index, counted
  /// from 0) at which the result is a NaN or an infinity.
  std::vector<double> operator()(const VertexVariables& at) const;

  /// The distance at single points: for many calls from one thread. What is returned throws InvalidInput where the
  /// result is a NaN or an infinity.
  std::function<double(const PointVariables&)> at_points(double diagonal) const;

 private:
  std::string text_;
  std::string code_;                // the text as muParser takes it, without the percent sign
  std::vector<std::string> names_;  // of variables and constants, as they occur
  bool percent_ = false;
};

/// A distance as users write it: world units ("0.1"), or a share of the bounding-box diagonal of the vertices in
/// use ("1.5%"); or an expression that gives each vertex its own.
struct VDB_OFFSET_API GivenDistance {
  double value = 0;
  bool percent = false;
  std::optional<DistanceExpression> expression;  ///< If set, value and percent do not count.

  double in_world_units(double diagonal) const;
};
/// \throw InvalidInput unless the text is a finite number, with or without a percent sign behind it.
VDB_OFFSET_API GivenDistance parse_distance(const std::string& text);
/// Parses a number as parse_distance() does, or else an expression. \throw InvalidExpression
VDB_OFFSET_API GivenDistance parse_distance_or_expression(const std::string& text);

/// The distances of a mesh's vertices, or of curves' points. \throw InvalidInput, see DistanceExpression
VDB_OFFSET_API Distances distances_of(const GivenDistance& distance, PolygonView mesh, const VariableSources& sources);

}  // namespace vdb_offset
