#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/offset.h"
#include "vdb_offset/precision.h"
#include "vdb_offset/surface.h"

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
/// With n vertices and m faces in the mesh that it is made of: vertices 0 .. n - 1 are those of the outer skin and
/// n .. 2 n - 1 those of the inner one, in the mesh's order; faces 0 .. m - 1 are the mesh's, m .. 2 m - 1 the same
/// from their back, and the rim is behind them, in the order of the mesh's corners.
struct Shell {
  /// The border edge that a face of the rim stands on: of the mesh's face, from one of its corners to the next.
  struct RimOrigin {
    std::uint32_t face, corner;  ///< `corner` indexes PolygonView::corners.
  };

  Polygons polygons;
  std::vector<RimOrigin> rim;
  ShellFacts facts;

  std::size_t source_vertices() const { return polygons.positions.size() / 2; }
  std::size_t source_faces() const { return (polygons.face_count() - rim.size()) / 2; }
  std::span<const Vec3d> outer() const { return std::span(polygons.positions).first(source_vertices()); }
  std::span<const Vec3d> inner() const { return std::span(polygons.positions).last(source_vertices()); }

  ShellPart part(std::size_t face) const {
    const std::size_t faces = source_faces();
    return face < faces ? ShellPart::Outer : face < 2 * faces ? ShellPart::Inner : ShellPart::Rim;
  }
  /// The face of the mesh that a face comes from; for the rim, the one at that border.
  std::uint32_t source_face(std::size_t face) const {
    const std::size_t faces = source_faces();
    return face < 2 * faces ? static_cast<std::uint32_t>(face % faces) : rim[face - 2 * faces].face;
  }
  /// The corner of source_face() that corner k of a face comes from, as an index into the mesh's corners.
  std::uint32_t source_corner(PolygonView mesh, std::size_t face, std::size_t k) const;
};

/// The other corner at which a border edge ends, as an index into the mesh's corners.
inline std::uint32_t next_corner(PolygonView mesh, const Shell::RimOrigin& edge) {
  return edge.corner + 1 < mesh.face_begin[edge.face + 1] ? edge.corner + 1 : mesh.face_begin[edge.face];
}

inline std::uint32_t Shell::source_corner(PolygonView mesh, std::size_t face, std::size_t k) const {
  const std::size_t faces = source_faces();
  if (face < faces) return mesh.face_begin[face] + static_cast<std::uint32_t>(k);
  if (face < 2 * faces) {
    const std::uint32_t begin = mesh.face_begin[face - faces], size = mesh.face_begin[face - faces + 1] - begin;
    return begin + (size - static_cast<std::uint32_t>(k)) % size;
  }
  const RimOrigin& edge = rim[face - 2 * faces];
  const std::size_t vertex = polygons.view().face(face)[k] % source_vertices();
  return vertex == mesh.corners[edge.corner] ? edge.corner : next_corner(mesh, edge);
}

/// Joins two skins over a mesh's faces into one solid. `outer` and `inner` are positions of its vertices; either may be
/// the mesh's own. The rim has a quad for each edge that has one face by the mesh's own positions, over the vertices
/// that this face uses; a triangle where one end did not move apart, and nothing where neither did. Edges of three
/// faces or more have no rim. Inner faces start with the same corner as the mesh's, so that quads are split into the
/// same triangles.
/// The facts are those of coordinates rounded to `precision`.
/// \throw InvalidInput for a mesh that cannot be used, or skins that do not have one position for each of its vertices.
Shell make_shell(PolygonView mesh, std::span<const Vec3d> outer, std::span<const Vec3d> inner, const WeldOptions& weld,
                 const Precision& precision = {});

/// The same between a mesh and its offset: each vertex is where it was on one skin, and where it went on the other.
/// \param inner an offset inward that the inner skin is, instead of the mesh
/// \param options those that the offset was made with
Shell shell_of(PolygonView mesh, const OffsetResult& result, const OffsetOptions& options,
               const OffsetResult* inner = nullptr);

}  // namespace vdb_offset
