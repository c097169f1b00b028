// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "space/surface/surface.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// An edge by its ends, the lower number first.
using Edge = std::pair<std::uint32_t, std::uint32_t>;

inline Edge edge_between(std::uint32_t a, std::uint32_t b) { return a < b ? Edge(a, b) : Edge(b, a); }

/// Where an added vertex lies in the surface: on an edge of a triangle, or inside of it.
struct SurfacePlace {
  std::uint32_t triangle;               ///< Of the surface; on an edge, one of those there.
  std::array<std::uint32_t, 3> vertex;  ///< Corners of that triangle; on an edge its ends first, then kNone.
  std::array<double, 3> share;          ///< As in VertexOrigin.

  bool on_edge() const { return vertex[2] == kNone; }
  bool operator==(const SurfacePlace&) const = default;
  bool operator<(const SurfacePlace& other) const {
    return std::tie(triangle, vertex, share) < std::tie(other.triangle, other.vertex, other.share);
  }
};

/// The triangles of a surface, split at the middles of edges, so that they still meet edge to edge. Its vertices come
/// first, then the ones that were added.
class RefinedTriangles {
 public:
  struct Triangle {
    std::array<std::uint32_t, 3> vertex;
    std::uint32_t source;  ///< The triangle of the surface that it is a piece of.
  };

  /// Keeps a reference. `positions` are those of the surface's vertices in the input, `count` its first triangles.
  RefinedTriangles(const Surface& surface, std::span<const Vec3d> positions, std::size_t count);

  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<Vec3d>& positions() const { return positions_; }
  const std::vector<SurfacePlace>& added() const { return added_; }
  std::size_t source_vertices() const { return positions_.size() - added_.size(); }

  /// The middle of an edge: its place, in a triangle of the surface that the edge is on.
  SurfacePlace middle(const Edge& edge, std::uint32_t source) const;

  /// Adds vertices on edges, and splits the triangles there in two, three or four; the first piece takes the place of
  /// the triangle, others come last.
  /// \param edges sorted, no two the same; \param places, positions of the vertices that are added on them
  /// \param split_from receives, if it is given, for each triangle beyond those there were the one that it was split
  /// from \returns the numbers of all new pieces, in ascending order
  std::vector<std::uint32_t> split(std::span<const Edge> edges, std::span<const SurfacePlace> places,
                                   std::span<const Vec3d> positions, std::vector<std::uint32_t>* split_from = nullptr);

  /// The faces of a refinement.
  struct FaceCount {
    std::size_t all = 0;
    /// Of each face of the mesh: its triangles, if none of them is split; else 1, as one more is for each split.
    std::vector<std::uint32_t> whole;
  };
  /// Of a mesh with so many faces.
  FaceCount face_count(std::size_t mesh_faces) const;
  std::uint32_t face_of(const Triangle& triangle) const { return surface_->face[triangle.source]; }
  /// How many faces of the mesh are split as a triangle is: its own, and those that repeat that one.
  std::size_t copies(const Triangle& triangle) const { return copies_.empty() ? 1 : copies_[triangle.source]; }
  /// Which vertices here are which in a refinement.
  struct Numbers {
    std::vector<std::uint32_t> of_vertex;  ///< For each vertex here one of those that it is; kNone for an obstacle's.
    std::vector<std::uint32_t> of_added;   ///< For each one that was added the vertex here.
  };
  /// The refinement of the mesh that the surface was built from. `triangle_of_face`, if given, receives for each of its
  /// faces the triangle here, or kNone for a face that is not split.
  Refinement of_mesh(PolygonView mesh, Numbers& numbers, std::vector<std::uint32_t>* triangle_of_face = nullptr) const;

 private:
  struct AddedCorner;
  struct ByFace;
  ByFace by_face(std::size_t mesh_faces) const;
  void add_piece(PolygonView mesh, std::uint32_t face, Triangle piece, Polygons& polygons,
                 std::vector<AddedCorner>& added) const;
  void number_added(PolygonView mesh, std::vector<AddedCorner>& added, Refinement& refinement, Numbers& numbers) const;
  std::uint32_t corner_of(PolygonView mesh, std::size_t face, std::uint32_t vertex) const;
  SurfacePlace place_in_face(std::uint32_t vertex, std::uint32_t source) const;
  std::array<double, 3> shares_on_side(const std::array<std::uint32_t, 3>& corners, std::uint32_t hanging) const;

  const Surface* surface_;
  std::vector<Vec3d> positions_;
  std::vector<SurfacePlace> added_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> copies_;  // of each triangle of the surface; empty if no face repeats another
};

}  // namespace vdb_offset
