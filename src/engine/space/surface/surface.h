// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "ground/mesh/point_triangle.h"
#include "ground/mesh/repeated_faces.h"
#include "space/surface/border_planes.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// A triangle of a face that was split where vertices hang on its sides (see weld.h), in the direction of its pieces.
struct SplitTriangle {
  std::array<std::uint32_t, 3> corners;
  std::vector<std::uint32_t> pieces;  ///< Triangles of the surface, in ascending order.
};

/// The surface that is offset, as the stages see it: welded vertices and triangles in a local frame.
///
/// Half-edge 3 t + k runs from corner k to corner k + 1 of triangle t. Lengths are in world units; positions are
/// relative to `origin`, which to_local_frame() puts on the voxel grid, so that every later figure is the same for a
/// mesh that is moved by whole voxels.
struct Surface {
  Vec3d origin{0.0};
  std::vector<Vec3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Sorted along a space-filling curve, as are the vertices.
  std::vector<std::uint32_t> face;                      ///< The input's face that each triangle is part of.
  std::vector<RepeatedFace> repeated;                   ///< Faces of the input that have no triangles for that.
  std::vector<SplitTriangle> split;
  /// For each triangle the one in `split` that it is a piece of; kNone for others. Empty if none was split.
  std::vector<std::uint32_t> piece_of;
  std::vector<std::uint8_t>
      turned;  ///< Of each triangle: 1 if it runs against its face. Empty if none was turned round.
  /// The next half-edge around the same edge, cyclic: itself at a border, the twin on a manifold.
  std::vector<std::uint32_t> next_around_edge;
  std::vector<Vec3d> triangle_normals;  ///< Unit length; zero for a needle (see is_needle).
  std::vector<Vec3d> vertex_normals;    ///< Sum of the incident triangles' normals times their angles there.
  /// For a vertex on a border, the unit vector that leads from the surface over the border's edges there, in the plane
  /// of their faces; zero for the others, and where borders meet. For a vertex that stays in a plane that plane's
  /// normal, either way round. Empty if nothing has a border, or stays in a plane.
  std::vector<Vec3d> conormals;
  /// Planes that vertices stay in (see border_planes.h), in this frame.
  std::vector<SymmetryPlane> planes;
  std::size_t named_planes = 0;  ///< How many of them, the first ones, the user has named.
  /// Planes that borders lie in whose faces rise from them by too little to stay there, and the vertices of these.
  std::vector<std::pair<SymmetryPlane, std::vector<std::uint32_t>>> left_planes;
  /// Of each vertex, how many planes hold it, 0 .. 3. Empty if there are no planes.
  std::vector<std::uint8_t> held;
  /// Of vertices that two planes hold, a second conormal, at right angles to the first one. Sorted by vertex.
  std::vector<std::pair<std::uint32_t, Vec3d>> second_conormals;
  /// Planes that vertices may not pass. Sorted by vertex.
  std::vector<Wall> walls;
  /// Triangles around vertex v: incident[incident_begin[v] .. incident_begin[v + 1]).
  std::vector<std::uint32_t> incident, incident_begin;
  std::vector<std::uint32_t> component;       ///< Of each surface vertex, 0 .. facts.components - 1.
  std::vector<std::uint32_t> representative;  ///< For each surface vertex the input vertex that gives its position.
  std::vector<std::uint32_t> welded;          ///< Surface vertex of each input vertex; kNone if no face uses it.
  MeshFacts facts;
  /// How far rounding to the digits of the input's coordinates may have moved a vertex; see unit_in_last_place().
  double vertex_error = 0;

  std::span<const std::uint32_t> triangles_around(std::uint32_t vertex) const {
    return std::span(incident).subspan(incident_begin[vertex], incident_begin[vertex + 1] - incident_begin[vertex]);
  }
  std::uint32_t from(std::uint32_t half_edge) const { return triangles[half_edge / 3][half_edge % 3]; }
  std::uint32_t to(std::uint32_t half_edge) const { return triangles[half_edge / 3][(half_edge % 3 + 1) % 3]; }
  bool is_turned(std::uint32_t triangle) const { return !turned.empty() && turned[triangle]; }
  /// What a triangle is a piece of; nothing if it is whole.
  const SplitTriangle* whole_of(std::uint32_t triangle) const {
    return piece_of.empty() || piece_of[triangle] == kNone ? nullptr : &split[piece_of[triangle]];
  }
  TrianglePoint closest_on(std::uint32_t triangle, const Vec3d& x) const {
    const auto& t = triangles[triangle];
    return closest_on_triangle(x, vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  }
  /// How large a triangle is beside others: twice its area.
  double extent(std::uint32_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    return (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]).length();
  }
  /// Goes from triangle to triangle, across the edge or around the vertex that the closest point lies on, for as long
  /// as that leads nearer to x: a local minimum of the distance. `triangle` is where to start, and becomes where the
  /// walk ended.
  TrianglePoint walk_to_closest(const Vec3d& x, std::uint32_t& triangle) const;
  /// Removes from a vector at a vertex the component that leads over the border there, if the vertex is on one, or out
  /// of planes that hold it.
  Vec3d along_border(std::uint32_t vertex, const Vec3d& v) const {
    if (conormals.empty()) return v;
    const Vec3d along = v - conormals[vertex] * conormals[vertex].dot(v);
    return held.empty() || held[vertex] < 2 ? along : along_line(vertex, along);
  }
  /// The conormal of a vertex on a border by its faces alone, whether or not a plane holds it; zero where several
  /// borders meet, or one turns back on itself.
  Vec3d own_conormal(std::uint32_t vertex) const;
  /// Of a vertex that one plane holds, and at which the border leaves that plane: the unit vector in the plane that
  /// leads over the border beside it; else zero. Without it, such a corner has nothing to keep it from leaning out
  /// there.
  Vec3d over_border_beside_plane(std::uint32_t vertex) const;
  /// Sine of the angle by which the errors of its corners may tilt a triangle.
  double tilt(std::uint32_t triangle) const;
  /// Whether a vertex must not leave the plane that along_border() keeps to.
  bool is_held(std::uint32_t vertex) const { return !held.empty() && held[vertex] > 0; }
  /// Projects a vector that lies in one of the planes that hold a vertex into all of them.
  Vec3d along_line(std::uint32_t vertex, const Vec3d& v) const;
  /// The part of a displacement that changes the distance from the closest feature, from which `away` leads: all of it
  /// from a corner, what is across an edge, what is along `away` from a face.
  Vec3d across(std::uint32_t triangle, Feature feature, const Vec3d& away, const Vec3d& displacement) const;
  /// Not normalised; its dot product with x - closest point has the sign of the side that x lies on
  /// (Baerentzen and Aanaes, Signed distance computation using the angle weighted pseudonormal, 2005).
  Vec3d pseudonormal(std::uint32_t triangle, Feature feature) const;
};

/// Builds the surface of polygons: welds, triangulates, joins hanging vertices, connects faces, counts, and settles
/// which side is outward (see orientation.h). Origin and normals are left to to_local_frame(). \throw InvalidInput if
/// there is no face, an index is out of range, a coordinate is not finite, or there are 2^31 triangles or more.
Surface build_surface(PolygonView polygons, const WeldOptions& weld, Orient orient = Orient::Keep);

/// \throw InvalidInput if none of the surface's faces has an area: such a mesh has no side to go to
void require_area(const Surface& surface);

/// Which vertices of a mesh are one.
struct Welding {
  /// For each vertex the one that gives the position of all that are welded with it; kNone for one in no face.
  std::vector<std::uint32_t> first;
  SeamFacts seams;
  /// How far a border's vertex may be from another border's edge to count as on it; none: such are not joined.
  std::optional<double> hanging;
};
/// Finds which vertices are one, in polygons with any number of corners. \throw InvalidInput as build_surface(), or for
/// a tolerance or a precision that cannot be used
Welding find_welding(PolygonView polygons, const WeldOptions& weld);
/// Builds the surface of all or some of a mesh's faces, welded as the whole mesh is. \throw InvalidInput as
/// build_surface()
Surface build_welded(PolygonView faces, const Welding& of_all, Orient orient);

/// For each vertex the first one at its position; kNone for one that is in no face.
std::vector<std::uint32_t> first_at_position(const Surface& surface);
/// For each vertex of polygons with any number of corners the first one that is welded with it; kNone for one that is
/// in no face. \throw InvalidInput as build_surface()
std::vector<std::uint32_t> weld_by_position(PolygonView polygons, const WeldOptions& weld);

/// Moves the surface into a frame whose origin is the corner of a leaf node (8 voxels) at or below its bounding
/// box, and computes its normals there. \pre voxel_size > 0, called once.
void to_local_frame(Surface& surface, double voxel_size);
/// Moves the surface into the frame of another one, which has this origin, and computes its normals there. \pre called
/// once, in place of to_local_frame()
void to_frame(Surface& surface, const Vec3d& origin);

/// Computes the normals of triangles and vertices from their present positions.
void find_normals(Surface& surface);

/// Lists the triangles around each vertex from the present corners.
void list_incident_triangles(Surface& surface);

/// Puts another surface beside one, without joining them. \pre both stand in one frame. Facts, and what is said of the
/// input's vertices, stay those of the first; the other's have no representative (kNone).
void append(Surface& surface, const Surface& other);

}  // namespace vdb_offset
