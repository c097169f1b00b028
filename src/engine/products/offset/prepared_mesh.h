// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ground/distances/in_metric.h"
#include "ground/system/assert.h"
#include "motion/parts/border_slide.h"
#include "motion/parts/mesh_parts.h"
#include "motion/paths/exact_corners.h"
#include "motion/paths/miters.h"
#include "motion/paths/propagate.h"
#include "products/offset/field_stage.h"
#include "space/field/field_grids.h"
#include "space/query/closest_query.h"
#include "valid/faults/obstacle_facts.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/options.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

struct VertexTargets;

/// A mesh that is ready to be offset: the stages that all results of a run share, and that offset_several() and
/// grow_layers() have in common. "All vertices" are those of parts().surface(): of the mesh, then of the obstacles.
class PreparedMesh {
 public:
  /// Sorts the mesh into parts, and if any vertex has to move plans the grid and makes the field. Keeps references to
  /// `space` and `options`.
  /// \param farthest how far vertices go on each side, world units
  /// \throw InvalidInput for a mesh or options that cannot be used, OutOfBudget before work that would not fit
  PreparedMesh(const InMetric& space, const OffsetOptions& options, int threads, const Reach& farthest,
               const Yield& yield);
  PreparedMesh(const PreparedMesh&) = delete;
  PreparedMesh& operator=(const PreparedMesh&) = delete;

  const InMetric& space() const { return space_; }
  /// The mesh in the space in which distances are measured.
  PolygonView mesh() const { return mesh_; }
  const OffsetOptions& options() const { return options_; }
  /// What becomes of sharp corners, also where the options leave it open.
  Corners corners() const { return corners_; }
  const MeshParts& parts() const { return parts_; }
  const Surface& surface() const { return parts_.surface(); }
  bool has_turned_faces() const { return surface().facts.turned_triangles > 0; }
  /// Positions of all vertices, world coordinates. Empty if no vertex moves, and there are no obstacles.
  const std::vector<Vec3d>& source() const { return source_; }
  /// \pre some vertex moves
  const ClosestQuery& query() const {
    VDB_OFFSET_ASSERT(query_.has_value());
    return *query_;
  }
  DistanceField& field() { return field_; }
  /// What is known of the exact surface at the moving part's triangles; nullptr: nothing.
  const ExactCorners* exact() const { return exact_ ? &*exact_ : nullptr; }
  /// The mesh beside its obstacles; nullptr without any.
  const Surroundings* surroundings() const { return surroundings_ ? &*surroundings_ : nullptr; }
  const Obstacles* obstacles() const { return surroundings_ ? &surroundings_->obstacles() : nullptr; }
  /// How border vertices slide; nullptr if none does.
  const BorderSlides* slides() const { return slides_ ? &*slides_ : nullptr; }
  /// How many of the first faces distances are measured from: others lie over ridges.
  std::uint32_t measured_faces() const { return measured_faces_; }
  /// Figures of what has been done so far, which those of each result begin with.
  const OffsetStatistics& statistics() const { return statistics_; }

  /// Crossings of the source that are known: with obstacles. Else each result finds them.
  std::optional<SelfCrossings> known_crossings() const;
  /// The mean distances of all vertices that move together. `disagreeing` is set to how many of the input's vertices
  /// have another distance than the first of theirs.
  Distances distances_of_all(const Distances& of_input, std::size_t& disagreeing) const;

  /// Paths of all vertices, and which of these must keep to them.
  struct Marched {
    Paths paths;
    std::vector<std::uint8_t> bound;  ///< Of each vertex; empty if none must.
    std::vector<Miter> miters;        ///< With Corners::Miter, those that are proven.
    MiteredPaths mitered;             ///< The vertices whose paths are miters, with Corners::Round as well.
    MiterFacts miter_facts;           ///< What is known of them before the result is made valid.
    double vertex_error = 0;          ///< See ConstrainedSurface.
  };
  /// Marches once for several sets of distances of all vertices. \pre some vertex moves
  std::vector<Marched> march(std::span<const Distances> distances, Ridges ridges);
  /// Puts vertices to their targets, without a march or a search for miters. \pre some vertex moves
  Marched marched_to(const Distances& distances, const VertexTargets& targets);

  /// What must stay valid where vertices have these paths. Refers to this and to `marched`.
  ConstrainedSurface constrained(const Marched& marched, bool off_source, std::size_t resting_faces = 0) const;

  /// Room on either side of a part where much falls short. Paths and distances are those of all vertices. With
  /// `closed_too` of a closed part as well, whose inside often has less room because it is thin.
  SideRoom room(const Paths& paths, const Distances& distances, bool closed_too = false) const;
  /// What became of borders. Paths are those of all vertices.
  BorderFacts borders(const Paths& paths) const;

 private:
  std::vector<Paths> find_paths(std::span<const Distances> on_part, Ridges ridges);
  Marched of_all(const Distances& on_part, Paths of_part);
  void hold(const Distances& distances, Marched& marched) const;
  void miter(std::span<const Distances> on_part, std::span<Marched> marched, bool on_creases);
  void bring_to_distance(const Distances& distances, Marched& marched) const;

  const InMetric& space_;
  PolygonView mesh_;
  const OffsetOptions& options_;
  Corners corners_;
  std::uint32_t measured_faces_;
  OffsetStatistics statistics_;
  MeshParts parts_;
  DistanceField field_;
  std::optional<ClosestQuery> query_;
  std::optional<ExactCorners> exact_;  // of the moving part's triangles, if the exact surface is known
  std::vector<Vec3d> source_;
  std::optional<Surroundings> surroundings_;
  std::optional<BorderSlides> slides_;
  std::vector<std::uint8_t> on_crease_;  // of the moving part's vertices; empty if none was asked for yet
  bool has_edge_miters_ = false;         // of one offset; layers slide to each of their heights
};

/// The vertices of a mesh, as an InputVertices.
struct MeshVertices {
  PolygonView mesh;
  const Surface& surface;

  std::span<const Vec3d> positions() const { return mesh.positions; }
  std::uint32_t shape_vertex(std::size_t v) const { return surface.welded[v]; }
  /// Where the vertex stands that it is welded to.
  Vec3d start(std::size_t v) const { return mesh.positions[surface.representative[surface.welded[v]]]; }
  Vec3d to_input(const Vec3d& displacement) const { return displacement; }
};

/// \throw InvalidInput for distances that are not one for each vertex, or a clearance that is no length
void require_usable(PolygonView mesh, std::span<const Distances> distances, const OffsetOptions& options);

/// How the vertices of a mesh are welded: hanging ones are joined if all of it is offset, and whole faces are not
/// needed.
WeldOptions weld_for(const OffsetOptions& options, const Yield& yield);

/// The plan of the grid for parts of a mesh, with the bytes of all else that the run needs. \throw as plan_grid()
GridPlan plan_run(const MeshParts& parts, PolygonView mesh, const Reach& farthest, const OffsetOptions& options,
                  int threads, const Yield& yield);

}  // namespace vdb_offset
