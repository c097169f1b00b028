// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vdb_offset/base/rounding.h"
#include "vdb_offset/proof/certified_faces.h"
#include "vdb_offset/refine/interpolated_targets.h"
#include "vdb_offset/refine/refined_triangles.h"

namespace vdb_offset {

/// A vertex of the source: how far it is to go, where it goes, and the tolerance around it.
struct RefinedVertex {
  double asked = 0, tolerance = 0;  ///< World units; the distance is negative inward, the tolerance above 0.
  VertexTarget target;
};

struct RefinerOptions {
  Corners corners = Corners::Round;
  std::size_t most_triangles;  ///< No more are made.
  Rounding precision;          ///< Of the source's coordinates, which those of added vertices are rounded to.
};

/// Splits the faces of a mesh until its offset is proven to be at its distance between the vertices, too.
///
/// In rounds: each triangle whose vertices all get to their distance is proven right, found to be off, or left open. Of
/// those that are not right the edges are split between whose ends the offset bulges by most of the tolerance, or the
/// one where it bulges the most. Where a vertex that gets to its distance has a neighbour that does not, the edge
/// between them is split as well, down to a length at which that is little area, and so are long edges none of whose
/// ends gets there, if their middle does; where no vertex gets there, nothing is split.
class Refiner {
 public:
  /// Keeps references. \param vertices of the surface's vertices, as `triangles` has them
  Refiner(const MeshParts& parts, const ClosestQuery& query, const InterpolatedTargets& targets,
          RefinedTriangles& triangles, std::vector<RefinedVertex> vertices, const RefinerOptions& options);

  /// Carries out all rounds. \param tell is called before each, with the share of triangles that are settled
  void run(const std::function<void(double)>& tell);

  /// Of all vertices, the added ones last.
  const std::vector<RefinedVertex>& vertices() const { return vertices_; }
  /// Whether more triangles were asked for than may be made.
  bool is_cut_short() const { return is_cut_short_; }

 private:
  enum class State : std::uint8_t {
    New,      // not looked at
    Settled,  // proven, or nothing can be gained
    Off,      // all vertices get there, but not all points between them
    Mixed,    // some vertex does not get there
  };
  /// A vertex that would be added.
  struct Candidate {
    Edge edge;
    SurfacePlace place;
    Vec3d position;
    RefinedVertex vertex;
    double bulge;  // of the offset between the ends of the edge, in tolerances; 0 where an end does not get there
    bool operator<(const Candidate& other) const { return edge < other.edge; }
  };
  using Corners3 = std::array<std::uint32_t, 3>;

  bool moves(const RefinedTriangles::Triangle& triangle) const;
  State judge(const RefinedTriangles::Triangle& triangle) const;
  double length_of(const Edge& edge) const;
  void propose(const std::vector<std::uint32_t>& triangles);
  Candidate candidate(const Edge& edge, std::uint32_t source) const;
  const Candidate& find(const Edge& edge) const;
  void mark(std::uint32_t triangle, std::vector<std::uint8_t>& marked) const;
  template <class Split>
  void mark_off(const std::array<const Candidate*, 3>& of_edge, Split&& split) const;
  void keep_to_limit(std::vector<std::uint8_t>& marked);
  std::vector<std::uint32_t> split(const std::vector<std::uint8_t>& marked);

  const MeshParts& parts_;
  const OffsetProver prover_;
  const InterpolatedTargets& targets_;
  RefinedTriangles& triangles_;
  std::vector<RefinedVertex> vertices_;
  RefinerOptions options_;
  std::vector<State> state_;           // of each triangle
  std::vector<Candidate> candidates_;  // of this round and those before, sorted by edge
  bool is_cut_short_ = false;
};

}  // namespace vdb_offset
