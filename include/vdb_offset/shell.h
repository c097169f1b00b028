#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/options.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

enum class ShellPart : std::uint8_t { Outer, Inner, Rim };
inline constexpr std::size_t kShellPartCount = 3;
constexpr const char* name(ShellPart part) {
  constexpr const char* kNames[kShellPartCount] = {"outer", "inner", "rim"};
  return kNames[static_cast<std::size_t>(part)];
}

/// What a shell is, counted on its faces and by position: copies of a vertex, and vertices of both skins that stand at
/// one place, are one.
struct ShellFacts {
  std::size_t rim_quads = 0, rim_triangles = 0;
  std::size_t border_edges_left = 0;   ///< With one face.
  std::size_t non_manifold_edges = 0;  ///< With three faces or more.
  std::size_t pinched_vertices = 0;    ///< Of the mesh: inner and outer skin are at one place there, and touch.
  bool has_thickness = false;          ///< There are others.
  std::size_t junction_vertices = 0;   ///< Of the mesh: at junctions of sheets (see find_junctions()).
  std::size_t short_junctions = 0;     ///< Of these, where a corner has been held back from where it should be.
  // Pairs of triangles that meet but for shared edges and corners.
  std::size_t source_crossings = 0;       ///< Neither has moved: the mesh's own.
  std::size_t crossings_near_source = 0;  ///< Others within two rings of where the mesh crosses itself.
  std::size_t crossings = 0;              ///< All others.
  bool closed = false;                    ///< Every edge has an even number of faces.
  bool oriented = false;                  ///< As many faces run through every edge one way as the other.
  double volume = 0;  ///< World units^3, positive for faces that point outwards; of use if it is oriented.
};

/// Two skins over the same faces, and the rim that joins their borders.
///
/// With n vertices in the mesh that it is made of, and m faces in that mesh, or in the part of it that the shell is of:
/// vertices 0 .. n - 1 are those of the outer skin and n .. 2 n - 1 those of the inner one, in the mesh's order, and
/// splits of these behind them; faces 0 .. m - 1 are the mesh's, m .. 2 m - 1 the same from their back, and the rim is
/// behind them, in the order of the mesh's corners. Without splits, corners of the outer skin's faces are the mesh's.
struct Shell {
  /// The border edge that a face of the rim stands on: of the mesh's face, from one of its corners to the next.
  struct RimOrigin {
    std::uint32_t face, corner;  ///< `corner` indexes PolygonView::corners.
    bool at_corner = false;      ///< It closes what is between the rims there, and stands on that corner alone.
  };
  /// A vertex beside those of the skins: where more than two sheets' sides meet, each two that face each other have
  /// one of their own (see sheet_sides.h).
  struct Split {
    std::uint32_t vertex;  ///< Of the mesh.
    ShellPart skin;        ///< Whose attributes it has.
  };

  Polygons polygons;
  std::vector<std::uint32_t> faces;  ///< Of the mesh: those that it is made of, ascending. Empty: all are.
  std::vector<Split> splits;
  std::vector<RimOrigin> rim;
  /// Of each of the mesh's vertices: the share that it kept of its way to where the skins of sheets that meet should
  /// be, below 0 where it is as offset. Empty if nothing meets.
  std::vector<double> kept;
  std::vector<std::uint8_t> is_junction;  ///< Of each of these: 1 where sheets meet.
  ShellFacts facts;

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
  /// The face of the mesh that a face comes from; for the rim, the one at that border.
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

/// The other corner at which a border edge ends, as an index into the mesh's corners.
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

/// Joins two skins over a mesh's faces into one solid. `outer` and `inner` are positions of its vertices; either may be
/// the mesh's own. The rim has a quad for each edge that has one face by the mesh's own positions, over the vertices
/// that this face uses; a triangle where one end did not move apart, and nothing where neither did. Edges of three
/// faces or more have no rim. Inner faces start with the same corner as the mesh's, so that quads are split into the
/// same triangles.
/// The facts are those of coordinates rounded to `precision`.
/// \param only of each face: 1 if the shell is made of it, and has a rim where those faces end; empty: of all
/// \throw InvalidInput for a mesh that cannot be used, or skins that do not have one position for each of its vertices.
Shell make_shell(PolygonView mesh, std::span<const Vec3d> outer, std::span<const Vec3d> inner, const WeldOptions& weld,
                 const Precision& precision = {}, std::span<const std::uint8_t> only = {});

/// The same between a mesh and its offset, or the part of it that was offset: each vertex is where it was on one skin,
/// and where it went on the other. If that was made with OffsetOptions::off_source, junctions of sheets have vertices
/// of their own (see make_junction_shell()). Faces that were turned round for the offset have their sides on the skins
/// that those are part of, so that all agree about the outside.
/// \param inner an offset inward that the inner skin is, instead of the mesh
/// \param options those that the offset was made with
Shell shell_of(PolygonView mesh, const OffsetResult& result, const OffsetOptions& options,
               const OffsetResult* inner = nullptr);

/// Puts the states of vertices at junctions, and near them, into a result: they have reached the distance if all their
/// corners are where they should be. What they have achieved is the share of it that all have kept.
void tell_states(const Shell& shell, OffsetResult& result);

}  // namespace vdb_offset
