// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// A polygon mesh as plain spans; nothing is copied and nothing need be manifold.
/// Face f has the corners `corners[face_begin[f]] .. corners[face_begin[f + 1] - 1]`, each an index into
/// `positions` (world units). `face_begin` has one entry more than there are faces and starts with 0.
struct VDB_OFFSET_API PolygonView {
  std::span<const Vec3d> positions;
  std::span<const std::uint32_t> corners;
  std::span<const std::uint32_t> face_begin;
  /// The triangles that stand for the faces, over the same vertices, face by face: n - 2 for one of n corners. Empty:
  /// those of split_polygons() at these positions. Positions that moved keep the triangles of the source.
  std::span<const std::array<std::uint32_t, 3>> triangles = {};

  /// The triangles of a face, if they are given.
  std::span<const std::array<std::uint32_t, 3>> triangles_of(std::size_t f) const {
    return triangles.subspan(face_begin[f] - 2 * f, face_begin[f + 1] - face_begin[f] - 2);
  }
  std::size_t face_count() const { return face_begin.empty() ? 0 : face_begin.size() - 1; }
  std::span<const std::uint32_t> face(std::size_t f) const {
    return corners.subspan(face_begin[f], face_begin[f + 1] - face_begin[f]);
  }
};

/// A polygon mesh that owns its arrays; the layout is that of PolygonView.
struct VDB_OFFSET_API Polygons {
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> face_begin{0};

  PolygonView view() const { return {positions, corners, face_begin}; }
  std::size_t face_count() const { return face_begin.size() - 1; }

  /// Ends the face whose corners were pushed since the last call.
  void close_face() { face_begin.push_back(static_cast<std::uint32_t>(corners.size())); }
  void add_face(std::initializer_list<std::uint32_t> face) {
    corners.insert(corners.end(), face);
    close_face();
  }
};

/// Splits the faces of a mesh into the triangles that are offset, judged, and written in formats of triangles, as
/// PolygonView::triangles has them: the fan around a face's first corner; ears of a flat face of five corners or more
/// that its fan does not cover once; and where a triangle would be a line, another split. \pre faces of three corners
/// or more
VDB_OFFSET_API std::vector<std::array<std::uint32_t, 3>> split_polygons(PolygonView mesh);

/// Curves in the layout of a polygon mesh: "face" f lists the points that curve f runs through, at least one. It is
/// closed if it ends where it begins. Curves that meet end to end at one position go on as one.
using CurvesView = PolygonView;
using Curves = Polygons;

/// Unit normals of the points, outward, in the plane: halfway between those of the segments that meet there. Zero for
/// points on no curve, and where segments turn back on each other. \throw InvalidInput as plane_of()
VDB_OFFSET_API std::vector<Vec3d> curve_normals(CurvesView curves);

/// Mean length of the segments that meet at each point; 0 for points on no curve. \throw InvalidInput as plane_of()
VDB_OFFSET_API std::vector<double> curve_edges(CurvesView curves);

/// An open curve, and how far its ends are apart.
struct VDB_OFFSET_API OpenCurve {
  std::uint32_t first, last;  ///< Points of the input.
  double length, gap;         ///< World units.

  /// Whether the ends are so near each other that a base may have been left out between them.
  bool is_nearly_closed() const;
  /// Share of the length up to which a gap between ends counts as a base that was left out. Blunt trailing edges are a
  /// percent or so of an airfoil's length; not measured beside other shares.
  static constexpr double kNearlyClosed = 0.1;
};

/// The curves with two ends, in the order of their chains. \throw as chains_in_plane()
VDB_OFFSET_API std::vector<OpenCurve> open_curves(CurvesView curves);

/// Closes the curves that are nearly closed, by a straight segment, and leaves other open ones. Returns the former, as
/// they were. \throw InvalidInput where all curves are open afterwards, as chains_in_plane()
VDB_OFFSET_API std::vector<OpenCurve> close_curves(Curves& curves);

/// The surface that a mesh is a tessellation of, as far as an offset needs it: that of a CAD model. All spans are as
/// long as the mesh asks for.
class VDB_OFFSET_API ExactSurface {
 public:
  ExactSurface() = default;
  ExactSurface(const ExactSurface&) = delete;
  ExactSurface& operator=(const ExactSurface&) = delete;
  virtual ~ExactSurface() = default;

  /// The surface's normal at each corner of each face: of unit length, outward; zero where it has none.
  virtual std::span<const Vec3d> corner_normals() const = 0;
  /// Of each face the piece of the surface that it is of. Pieces end at sharp edges, not at smooth ones.
  virtual std::span<const std::uint32_t> piece_of_face() const = 0;
  /// The most distance between a face and the surface, world units, > 0.
  virtual double deflection() const = 0;
  /// Moves points that are near the offset of vertices to where they are at the vertices' distances from all faces of
  /// the model that these are on, each measured to the face as it goes on beyond its edges; or as near to that as one
  /// point can be.
  /// \param vertices of the mesh
  /// \param distances of each of them, world units; negative is inward
  /// \param at_corner of each corner of the mesh the distance from its face that counts in place of the vertex's; or
  /// empty
  /// \param points of each of them: where to begin, and where it ends
  virtual void bring_to_distances(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                                  std::span<const double> at_corner, std::span<Vec3d> points) const = 0;
  /// Of each point, the most by which its distance from one of these faces is another than the vertex's, or the
  /// corner's, world units.
  virtual std::vector<double> distance_errors(std::span<const std::uint32_t> vertices,
                                              std::span<const double> distances, std::span<const double> at_corner,
                                              std::span<const Vec3d> points) const = 0;
  /// Of each point, by how much its distance from the model's face that a face of the mesh is of is another than asked,
  /// world units.
  /// \param feet points of the mesh's faces, near which the closest ones of the model's are
  virtual std::vector<double> distance_errors_near(std::span<const std::uint32_t> faces, std::span<const Vec3d> feet,
                                                   std::span<const double> distances,
                                                   std::span<const Vec3d> points) const = 0;
};

/// Where a vertex that was added lies in the source: on an edge of a face, or inside of a triangle that the face is
/// made of.
struct VertexOrigin {
  std::uint32_t face;                   ///< A face of the source that it lies on; on an edge, one of those there.
  std::array<std::uint32_t, 3> vertex;  ///< Corners of that face, vertices of the source; on an edge its ends first.
  std::array<double, 3> share;  ///< Barycentric: not below 0, their sum is 1 exactly; on an edge the last one is 0.
};

/// A mesh whose faces are split, on the same surface: no vertex of the source is moved, and no face leaves its plane,
/// but for what rounding does (see Tolerance::precision), and where vertices hang on its sides, by how far off these
/// are.
struct VDB_OFFSET_API Refinement {
  /// The source's vertices in their order, then the ones that were added. In the place of each face of the source there
  /// are its pieces, in a row and the same way round: triangles, or the face itself where it is not split. Where
  /// vertices of the source hang on the sides of a face (see WeldOptions::join_hanging), its pieces have vertices of
  /// their own that were added at the same positions.
  Polygons polygons;
  std::vector<std::uint32_t> parent;  ///< Of each face: the source's face that it is a piece of; ascending.
  std::vector<VertexOrigin> added;    ///< Of each vertex that was added, in order.
  /// With Corners::Arc: how many of the last faces lie over ridges, and of these over corners. They have no area in the
  /// source, and for a parent a face beside them: ascending along the strips, and again along the patches.
  std::size_t over_ridges = 0, over_corners = 0;

  std::size_t source_vertices() const { return polygons.positions.size() - added.size(); }
  /// Faces in the place of the source's.
  std::size_t faces_in_place() const { return parent.size() - over_ridges; }
};

}  // namespace vdb_offset
