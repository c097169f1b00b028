// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// The parts of a shell.
enum class ShellPart : std::uint8_t { Outer, Inner, Rim };
inline constexpr std::size_t kShellPartCount = 3;
constexpr const char* name(ShellPart part) {
  constexpr const char* kNames[kShellPartCount] = {"outer", "inner", "rim"};
  return kNames[static_cast<std::size_t>(part)];
}

/// Facts about a shell, counted on its faces and by position: copies of a vertex, and vertices of both skins at one
/// position, count as one.
struct ShellFacts {
  std::size_t rim_quads = 0, rim_triangles = 0;
  std::size_t border_edges_left = 0;   ///< Edges with one face.
  std::size_t non_manifold_edges = 0;  ///< Edges with three faces or more.
  std::size_t pinched_vertices = 0;    ///< Vertices of the mesh at which inner and outer skin touch.
  bool has_thickness = false;          ///< There are vertices at which the skins do not touch.
  std::size_t junction_vertices = 0;   ///< Vertices of the mesh at junctions of sheets (see find_junctions()).
  std::size_t short_junctions = 0;     ///< Junction vertices at which a corner is held back from where it should be.
  // Pairs of triangles that meet elsewhere than in shared edges and corners.
  std::size_t source_crossings = 0;       ///< Pairs of which neither has moved: the mesh's own.
  std::size_t crossings_near_source = 0;  ///< Other pairs within two rings of where the mesh crosses itself.
  std::size_t crossings = 0;              ///< All other pairs.
  bool closed = false;                    ///< Every edge has an even number of faces.
  bool oriented = false;                  ///< As many faces run through every edge one way as the other.
  double volume = 0;  ///< World units^3, positive for faces that point outwards; meaningful if the shell is oriented.
};

/// Two skins over the same faces, and the rim that joins their borders.
///
/// The mesh that it is made from has n vertices, and m faces, or the part of it that the shell is made from has m.
/// Vertices 0 .. n - 1 are those of the outer skin and n .. 2 n - 1 those of the inner skin, in the mesh's order, with
/// splits of both behind them. Faces 0 .. m - 1 are the mesh's, m .. 2 m - 1 the mesh's turned round, and behind them
/// are those of the rim, in the order of the mesh's corners. Without splits, corners of the outer skin's faces are the
/// mesh's.
struct VDB_OFFSET_API Shell {
  /// The border edge that a face of the rim stands on, as a side of one of the mesh's faces: from a corner to the next.
  struct RimOrigin {
    std::uint32_t face, corner;  ///< `corner` indexes PolygonView::corners.
    bool at_corner = false;      ///< The face closes the hole between rims at that corner, and stands on no edge.
  };
  /// A vertex in addition to those of the skins: where more than two sheets meet, each wedge has a vertex of its own
  /// (see sheet_sides.h).
  struct Split {
    std::uint32_t vertex;  ///< The mesh's vertex that it comes from.
    ShellPart skin;        ///< The skin whose attributes it has.
  };

  Polygons polygons;
  /// As PolygonView::triangles: faces of the skins are split as they are in the mesh, those of the rim by themselves.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> faces;  ///< The mesh's faces that the shell is made from, ascending. Empty: all of them.
  std::vector<Split> splits;
  std::vector<RimOrigin> rim;
  /// Of each of the mesh's vertices: the share that it kept of its displacement to where the skins of sheets that meet
  /// should be; below 0 where it is as offset. Empty if no sheets meet.
  std::vector<double> kept;
  std::vector<std::uint8_t> is_junction;  ///< Of each of the mesh's vertices: 1 where sheets meet. Empty likewise.
  ShellFacts facts;

  PolygonView view() const { return {polygons.positions, polygons.corners, polygons.face_begin, triangles}; }
  /// Vertices of the mesh.
  std::size_t source_vertices() const { return (polygons.positions.size() - splits.size()) / 2; }
  /// Faces of each skin.
  std::size_t skin_faces() const { return (polygons.face_count() - rim.size()) / 2; }
  std::span<const Vec3d> outer() const { return std::span(polygons.positions).first(source_vertices()); }
  std::span<const Vec3d> inner() const {
    return std::span(polygons.positions).subspan(source_vertices(), source_vertices());
  }

  ShellPart part(std::size_t face) const {
    const std::size_t count = skin_faces();
    return face < count ? ShellPart::Outer : face < 2 * count ? ShellPart::Inner : ShellPart::Rim;
  }
  /// The face of the mesh that a face comes from; for a face of the rim, the mesh's face at that border.
  std::uint32_t source_face(std::size_t face) const {
    const std::size_t count = skin_faces();
    if (face >= 2 * count) return rim[face - 2 * count].face;
    return faces.empty() ? static_cast<std::uint32_t>(face % count) : faces[face % count];
  }
  /// The outer skin's face over one of the mesh's; kNone if that is not part of the shell.
  std::uint32_t skin_face(std::uint32_t source_face) const {
    if (faces.empty()) return source_face;
    const auto found = std::lower_bound(faces.begin(), faces.end(), source_face);
    return found != faces.end() && *found == source_face ? static_cast<std::uint32_t>(found - faces.begin()) : kNone;
  }
  /// The mesh's vertex that one comes from.
  std::uint32_t source_vertex(std::uint32_t vertex) const {
    const std::size_t count = source_vertices();
    return vertex < 2 * count ? static_cast<std::uint32_t>(vertex % count) : splits[vertex - 2 * count].vertex;
  }
  /// The skin whose attributes a vertex has.
  ShellPart skin_of(std::uint32_t vertex) const {
    const std::size_t count = source_vertices();
    return vertex < count ? ShellPart::Outer : vertex < 2 * count ? ShellPart::Inner : splits[vertex - 2 * count].skin;
  }
  /// The corner of source_face() that corner k of a face comes from, as an index into the mesh's corners.
  std::uint32_t source_corner(PolygonView mesh, std::size_t face, std::size_t k) const;
};

/// The corner at which a border edge ends, as an index into the mesh's corners.
inline std::uint32_t next_corner(PolygonView mesh, const Shell::RimOrigin& edge) {
  return edge.corner + 1 < mesh.face_begin[edge.face + 1] ? edge.corner + 1 : mesh.face_begin[edge.face];
}

inline std::uint32_t Shell::source_corner(PolygonView mesh, std::size_t face, std::size_t k) const {
  const std::size_t count = skin_faces();
  const std::uint32_t from = source_face(face), begin = mesh.face_begin[from];
  if (face < count) return begin + static_cast<std::uint32_t>(k);
  if (face < 2 * count) {
    const std::uint32_t size = mesh.face_begin[from + 1] - begin;
    return begin + (size - static_cast<std::uint32_t>(k)) % size;
  }
  const RimOrigin& edge = rim[face - 2 * count];
  const std::uint32_t vertex = source_vertex(polygons.view().face(face)[k]);
  return edge.at_corner || vertex == mesh.corners[edge.corner] ? edge.corner : next_corner(mesh, edge);
}

/// Joins two skins over a mesh's faces into one solid. The rim has a quad for each edge that has one face by the mesh's
/// own positions, over the vertices that this face uses; a triangle where the skins touch at one end of the edge, and
/// nothing where they touch at both. Edges of three faces or more have no rim. Inner faces start with the same corner
/// as the mesh's, so that quads are split into the same triangles. The facts are those of coordinates rounded to
/// `precision`.
/// \param outer positions of the mesh's vertices on the outer skin; may be the mesh's own
/// \param inner positions of the mesh's vertices on the inner skin; may be the mesh's own
/// \param only of each face: 1 if the shell is made of it, and has a rim where those faces end; empty: of all
/// \throw InvalidInput for a mesh that cannot be used, or skins that do not have one position for each of its vertices.
VDB_OFFSET_API Shell make_shell(PolygonView mesh, std::span<const Vec3d> outer, std::span<const Vec3d> inner,
                                const WeldOptions& weld, const Precision& precision = {},
                                std::span<const std::uint8_t> only = {});

/// Makes the shell between a mesh and its offset, or the offset of a part of it: each vertex is at its position in the
/// mesh on one skin, and at that in the offset on the other. Vertices that count as one are at one position. If the
/// offset was made with OffsetOptions::off_source, junctions of sheets have vertices of their own (see
/// make_junction_shell()). The sides of faces that were turned round for the offset are on the skins that they belong
/// to, so that all faces of the shell agree about the outside. \param inner an offset inward that is the inner skin
/// instead of the mesh \param options those that the offset was made with
VDB_OFFSET_API Shell shell_of(PolygonView mesh, const OffsetResult& result, const OffsetOptions& options,
                              const OffsetResult* inner = nullptr);

/// Updates the states and distances of vertices at junctions, and near them, in a result: they have reached the
/// distance if all of their corners are where they should be. Else their distance is the share of it that all corners
/// have kept.
VDB_OFFSET_API void report_states(const Shell& shell, OffsetResult& result);

/// A solid with a cavity: the faces of an outer surface in their order, then those of an inner surface, turned round.
struct Hollow {
  enum class Source { Neither, Outer, Inner };  ///< The surface that is the mesh which the other was made from.

  Polygons polygons;  ///< Vertices and faces of the outer surface, then of the inner one.
  std::size_t outer_vertices = 0, outer_faces = 0;
  Source source = Source::Neither;
  ShellFacts facts;  ///< There is no rim. A crossing counts as the source's if both triangles are from it.
};

/// Puts two surfaces together, one of which lies within the other, both with faces that point outward. The facts are
/// those of unrounded positions. \param weld vertices of the source that count as one, which are put at one position
/// \throw InvalidInput for meshes that cannot be used, or too many vertices.
VDB_OFFSET_API Hollow make_hollow(PolygonView outer, PolygonView inner, Hollow::Source source,
                                  const WeldOptions& weld = {});

}  // namespace vdb_offset
