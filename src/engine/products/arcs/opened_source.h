// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "motion/paths/propagate.h"
#include "products/arcs/opened_vertex.h"
#include "products/arcs/ridge_fan.h"
#include "products/offset/prepared_mesh.h"
#include "products/offset/vertex_targets.h"
#include "valid/proof/certified_faces.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

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
  /// Keeps a reference to the mesh. \param distances of all vertices \param plain where vertices go that are not opened
  /// \param tolerance how far the faces over ridges may be off the distance, as a share of it \param longest the most
  /// that a copy goes, in distances \param most_faces that may be made \throw OutOfBudget before more are
  OpenedSource(const PreparedMesh& mesh, const Distances& distances, const Paths& plain, double tolerance,
               double longest, std::size_t most_faces);

  /// Whether no ridge is opened.
  bool empty() const;
  /// Leaves the ridges at some vertices closed. \param vertices of the surface, sorted
  void close(const std::vector<std::uint32_t>& vertices);

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
  void lay(const RidgeFinder& finder, std::size_t most_faces);
  void find_ends(double longest);

  const PreparedMesh& mesh_;
  const Distances& distances_;
  const Paths& plain_;
  double tolerance_;
  std::vector<OpenedVertex> opened_;   // that are opened, or were
  std::vector<std::uint32_t> number_;  // of each vertex of the surface: in opened_; kNone if it is not opened
  std::vector<std::uint32_t> first_;   // of each that is opened: its first copy
  std::vector<Copy> copies_;
};

}  // namespace vdb_offset
