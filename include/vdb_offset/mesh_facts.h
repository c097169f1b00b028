// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Which vertices move as one. Bit-equal positions (hard edges, UV seams, STL corners) by default.
struct WeldOptions {
  bool enabled = true;
  double tolerance = 0;      ///< World units, >= 0. Vertices closer than this get the position of the first one.
  bool close_seams = false;  ///< Without a tolerance: also what is one but for rounding (see seams.h).
  double precision = 0;      ///< For that: of a coordinate, relative to the largest; 0: as the coordinates have it.
  /// Also, within the tolerance or as seams are: borders that run along each other, but have vertices where the other
  /// has none (T-junctions). Such hanging vertices become corners of the faces beside them as far as the offset goes.
  bool join_hanging = false;

  /// Equal positions, seams, slivers and hanging vertices.
  static WeldOptions automatic() { return {true, 0, true, 0, true}; }
  /// The same, but hanging vertices are left hanging.
  WeldOptions without_joins() const { return {enabled, tolerance, close_seams, precision, false}; }
};

/// Borders that all but meet, and what was done about them: see seams.h. Lengths in world units.
struct SeamFacts {
  std::size_t vertices = 0;       ///< Positions on borders that were moved to another one.
  double widest = 0;              ///< The largest distance by which one was moved.
  std::size_t near_vertices = 0;  ///< Positions on borders that run along another one, close by, and stay.
  double widest_near = 0;         ///< How far apart these are at most.
  std::size_t hanging = 0;    ///< Positions on edges of faces that have no corner there, which were joined to these.
  double widest_hanging = 0;  ///< The largest distance between such a position and such an edge.
  std::size_t slivers =
      0;  ///< Positions that were moved to the other end of an edge that single precision cannot hold.
  double widest_sliver = 0;  ///< The largest distance by which one was moved.
};

/// Which side of a closed component is outward.
enum class Orient {
  Keep,              ///< Where its faces point.
  FixDirectionOnly,  ///< Out of the solid that it encloses, wherever its faces point. They stay as they are.
  FixCavities,  ///< The same, and what lies directly inside of a solid is a cavity in it, and never a solid itself.
};

/// One component of a mesh, by which it can be found.
struct PieceFacts {
  std::size_t vertices = 0;      ///< After welding.
  Vec3d lower{0.0}, upper{0.0};  ///< Bounding box, world units.
  std::uint32_t face = 0;        ///< A face of the input that is part of it.
};

/// What a mesh is made of, counted on its polygons after welding.
struct VDB_OFFSET_API MeshFacts {
  std::size_t vertices = 0;         ///< Vertices of the input.
  std::size_t unused_vertices = 0;  ///< In no face.
  std::size_t welded_vertices = 0;  ///< Distinct positions among the used ones.
  SeamFacts seams;
  std::map<std::size_t, std::size_t> faces_by_corners;
  std::size_t components = 0;          ///< Of faces, joined over edges.
  std::size_t boundary_edges = 0;      ///< With one face.
  std::size_t non_manifold_edges = 0;  ///< With three faces or more.
  std::size_t repeated_faces = 0;      ///< Over the corners of an earlier face, either way round: left out inside.
  std::size_t folded_triangles = 0;    ///< Of bent faces, over the corners of another triangle: left out too.
  std::size_t boundary_left = 0;       ///< Boundary and non-manifold edges without all these.
  std::size_t non_manifold_left = 0;
  std::size_t degenerate_faces = 0;       ///< With a repeated corner or no area.
  std::size_t orientation_conflicts = 0;  ///< Edges that both faces run through in the same direction.
  std::size_t turned_triangles = 0;       ///< Turned round, for the distance's sign alone, to settle such conflicts.
  std::size_t unsettled_conflicts = 0;    ///< Left over: on surfaces with one side only.
  std::size_t closed_components = 0;  ///< Components in which all edges have two faces that agree about the outside.
  std::size_t inside_out_components = 0;  ///< Closed ones that face the wrong way as a whole (see orientation.h).
  PieceFacts largest_inside_out;          ///< That of most triangles among these, if there is any.
  /// Closed ones that lie directly inside of a solid and point outward like it: solids, or cavities that face the wrong
  /// way. With Orient::FixCavities they count as the latter above.
  std::size_t enclosed_components = 0;
  Vec3d lower{0.0}, upper{0.0};  ///< Bounding box of the vertices in use, world units.
  double diagonal = 0;           ///< Of that box.
  double area = 0;
  double median_edge = 0;        ///< Median edge length of the triangulated surface.
  std::size_t sliver_edges = 0;  ///< Shorter than kSliver of that.
  double longest_sliver = 0;     ///< The longest of those edges.

  /// Share of the median edge below which an edge counts as a sliver: such edges hold back what is around them. Not
  /// measured beside other shares.
  static constexpr double kSliver = 1e-5;

  /// A tolerance (a power of ten) that welds vertices no farther apart than `length`.
  static double tolerance_above(double length);

  bool closed() const { return boundary_left == 0 && non_manifold_left == 0; }
  /// Whether each edge has two faces, of opposite directions, and no face had to be left out or turned round for that.
  bool two_sided() const {
    return components > 0 && boundary_edges == 0 && non_manifold_edges == 0 && orientation_conflicts == 0 &&
           repeated_faces == 0 && folded_triangles == 0 && degenerate_faces == 0;
  }
  bool oriented() const { return unsettled_conflicts == 0 && non_manifold_left == 0; }
};

/// A plane: all x with normal . x = offset; the normal has unit length.
struct VDB_OFFSET_API SymmetryPlane {
  Vec3d normal{0.0};
  double offset = 0;

  /// Signed height of a position above the plane, world units.
  double height(const Vec3d& x) const;
};

struct SymmetryOptions {
  bool find = true;  ///< Borders stay in the planes that they lie in.
  std::vector<SymmetryPlane>
      planes;  ///< World coordinates. All vertices on one of these stay in it, whatever is around them.
};

/// Diagonal of the bounding box of the vertices that faces use, which percentages of a distance refer to.
VDB_OFFSET_API double used_diagonal(PolygonView mesh);

/// Unit normals of the mesh's vertices, outward: of the welded surface and weighted by angles, as the offset itself
/// takes them. Zero for a vertex that no face uses, and where the faces around have no normals or these cancel out.
/// \throw InvalidInput as build_surface()
VDB_OFFSET_API std::vector<Vec3d> vertex_normals(PolygonView polygons, const WeldOptions& weld = {},
                                                 Orient orient = Orient::Keep);

/// 1 for a point on the outer side of the mesh, -1 for one on its inner side, by the face, edge or vertex that is
/// closest to it. \throw InvalidInput as build_surface(), for a mesh without faces, and for a point on the surface
VDB_OFFSET_API int side_of_point(PolygonView polygons, const Vec3d& point, const WeldOptions& weld = {},
                                 Orient orient = Orient::Keep);

/// Mean length of the sides of the faces around each vertex, of the welded surface; 0 for a vertex that no face uses.
/// \throw InvalidInput as build_surface()
VDB_OFFSET_API std::vector<double> mean_edges(PolygonView polygons, const WeldOptions& weld = {});

}  // namespace vdb_offset
