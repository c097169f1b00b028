// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "ground/numbers/disjoint_sets.h"
#include "ground/numbers/index_set.h"
#include "motion/paths/propagate.h"
#include "products/arcs/opened_vertex.h"
#include "products/arcs/ridge_fan.h"
#include "products/offset/prepared_mesh.h"
#include "products/offset/vertex_targets.h"
#include "valid/proof/certified_faces.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Which edges are opened, and how.
struct Opening {
  double least_bend;  ///< Above which a convex edge is a ridge, radians.
  double step;        ///< The most angle between neighbouring copies of a vertex, radians.
  /// Where sectors go to where the planes of their faces meet: how far that may be, in distances; beyond, all convex
  /// edges of the sector are opened, as at the tip of a cone. Without it, all copies go to the distance itself.
  std::optional<double> farthest_plane;
  double longest = std::numeric_limits<double>::infinity();  ///< The most that a copy goes, in distances.
  /// How near to an opened vertex others go straight away from their own faces, where there is room, in distances along
  /// edges: a march would spread them around the ridge, where copies go. 0: none do.
  double straight_within = 0;
  /// Ridges that lead to each other stay closed where they are shorter than so many median edges of the mesh for each
  /// of their ends: those of scans' noise.
  double edges_for_end = 0;
  bool at_borders = false;  ///< Vertices on borders are opened, too, along these.
  bool quads =
      false;  ///< Strips are of quads wherever both of their ends have as many copies; else between such faces.
  std::size_t most_faces = std::numeric_limits<std::size_t>::max();  ///< That may be made.
};
/// Ridges of which one vertex would not serve within a tolerance, a share of the distance, as arcs that do.
Opening opening_within(double tolerance);

/// A source whose ridges are opened, so that faces lie over them in its offset.
///
/// Each vertex on a ridge has a copy for each sector of faces around it, and between two sectors as many more as the
/// angle between the directions of those asks for. Along each edge of a ridge there is a strip of faces between the
/// copies at its ends, and over each vertex at which three sectors or more meet a patch. All copies of a vertex stand
/// where it stands, and each has a displacement of its own: the copies of sectors go to where the planes of their faces
/// meet that are moved by the distance, all others along a ray to where the distance is the vertex's. In the normal
/// cone of a convex edge or corner that is straight away from it.
///
/// A vertex is not opened where that makes no faces that all face outward: strips end there in a point.
class OpenedSource {
 public:
  /// Keeps references to the mesh, the distances and the paths. \param distances of all vertices \param plain where
  /// vertices go that are not opened \throw OutOfBudget before more faces are made than may be
  OpenedSource(const PreparedMesh& mesh, const Distances& distances, const Paths& plain, const Opening& opening);

  /// Whether no ridge is opened.
  bool empty() const;
  /// Leaves the ridges at some vertices closed. \param vertices of the surface, sorted
  void close(const Indices& vertices);

  /// The opened vertices on ridges that lead to some of these. Both sorted.
  Indices connected(const Indices& vertices) const;

  /// The opened mesh as faces: those of the mesh in their order, strips edge by edge, and patches.
  struct Faces {
    Refinement refinement;                ///< At the positions of the mesh.
    std::vector<std::uint32_t> vertex;    ///< Of each of its vertices: that of the surface; kNone if it has none.
    std::vector<std::uint8_t> is_opened;  ///< Of each of its vertices.
    VertexTargets targets;                ///< Of each of its vertices.
    std::vector<OffsetFace> triangles;    ///< Of the faces that move, over its vertices.
  };
  Faces faces() const;

 private:
  friend class OpenedFaceMaker;
  /// A copy of a vertex.
  struct Copy {
    std::uint32_t vertex;
    Vec3d displacement;
    VertexState state;
  };

  void find_vertices(const RidgeFinder& finder);
  void open_further(const RidgeFinder& finder);
  void lay(const RidgeFinder& finder);
  void find_ends();
  Indices near_fans() const;
  void find_straight();
  void close_here(const Indices& vertices);
  Indices scraps() const;
  DisjointSets ridges() const;

  const PreparedMesh& mesh_;
  const Distances& distances_;
  const Paths& plain_;
  Opening opening_;
  std::vector<OpenedVertex> opened_;   // that are opened, or were
  std::vector<std::uint32_t> number_;  // of each vertex of the surface: in opened_; kNone if it is not opened
  std::vector<std::uint32_t> first_;   // of each that is opened: its first copy
  std::vector<Copy> copies_;
  std::vector<Vec3d> straight_;  // displacements of vertices that are not opened and may go straight; else zero
  std::vector<std::uint8_t> goes_straight_;  // of each vertex of the surface; empty if none does
};

}  // namespace vdb_offset
