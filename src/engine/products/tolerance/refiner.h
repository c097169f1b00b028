// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "ground/numbers/rounding.h"
#include "products/tolerance/interpolated_targets.h"
#include "products/tolerance/refined_triangles.h"
#include "valid/proof/certified_faces.h"

namespace vdb_offset {

/// A vertex of the source: how far it is to go, where it goes, and the tolerance around it.
struct RefinedVertex {
  double asked = 0, tolerance = 0;  ///< World units; the distance is negative inward, the tolerance above 0.
  VertexTarget target;
  VertexState otherwise = VertexState::Limited;  ///< What it is if it does not get there.
  double bulge = 0;                              ///< Of the edge that it was added on (see Refiner), in tolerances,
  int kept = 0;  ///< and how many times in a row such edges have bulged nearly as much as before they were halved.
};

struct RefinerOptions {
  Corners corners = Corners::Round;
  std::size_t most_faces;  ///< No more are made.
  std::size_t mesh_faces;  ///< Of the mesh.
  Rounding precision;      ///< What those of added vertices are rounded to.
  /// Edges of faces that the surface has no triangles of, and triangles that cross others in the source, which are not
  /// split: the former could not be, and the latter would cross in all their pieces.
  std::vector<Edge> whole_edges;
  std::vector<std::uint32_t> whole_triangles;
};

/// Splits the faces of a mesh until its offset is proven to be at its distance between the vertices, too.
///
/// In stages, the first with a tolerance of a tenth of the distance: what cannot be proven with that, as nothing there
/// has room, is not split any more. In rounds, each of which can be done again without what has turned out to be
/// faulty: each triangle whose vertices all get to their distance is proven right, found to be off, or left open. Of
/// those that are not right the edges are split between whose ends the offset bulges by most of the tolerance, or the
/// one where it bulges the most. Where an edge has an end that does not get to its distance, it is split if its middle
/// gets there, down to a length at which that is little area; where no vertex gets there, nothing is split.
class Refiner {
 public:
  /// Keeps references. \param vertices of the surface's vertices, as `triangles` has them
  Refiner(const MeshParts& parts, const ClosestQuery& query, const InterpolatedTargets& targets,
          RefinedTriangles& triangles, std::vector<RefinedVertex> vertices, const RefinerOptions& options);

  /// The tolerance of the first stage, in units of the tolerance that is asked for; 1 if there is only one.
  double loosest() const;
  /// Begins a stage with a tolerance so many times as large, at least 1, and gives up what is not proven of the stage
  /// before.
  void begin_stage(double loosened);
  /// Begins a round. False if there is nothing to be split any more. \param tell receives the share of triangles that
  /// are settled
  bool begin_round(const std::function<void(double)>& tell);
  /// Splits what this round asks for, and what its pieces ask for in turn: halves of a corner may be folded that
  /// quarters are not. False if that is nothing.
  bool split();
  /// Undoes this round's splits, and has the triangles stay whole that some of the present ones are pieces of; the
  /// first time in a round, those whose pieces were split in turn be split once only. Returns false, and undoes
  /// nothing, if none of them is a piece of another one.
  bool keep_whole(std::span<const std::uint32_t> triangles);

  /// Of all vertices, the added ones last.
  const std::vector<RefinedVertex>& vertices() const { return vertices_; }
  /// Whether more triangles were asked for than may be made.
  bool is_cut_short() const { return is_cut_short_; }

 private:
  enum class State : std::uint8_t {
    New,      // not looked at
    Settled,  // proven, or does not move
    GivenUp,  // nothing can be gained, but neighbours may split its edges
    Whole,    // its pieces would be faulty: its edges are not split, either
    Off,      // all vertices get there, but not all points between them
    Mixed,    // some vertex does not get there
  };
  /// What the target of a vertex that would be added depends on.
  struct Question {
    SurfacePlace place;
    Vec3d position;
    double asked;
    std::optional<Vec3d> between;  // the middle of the edge in the offset, if both of its ends get there
    bool is_by_miter = false;      // one of them by a miter
    bool operator==(const Question&) const = default;
  };
  /// A vertex that would be added.
  struct Candidate {
    Edge edge;
    Question question;
    RefinedVertex vertex;
    bool stays_whole = false;  // a triangle there has to
    bool operator<(const Candidate& other) const { return edge < other.edge; }
  };
  using Corners3 = std::array<std::uint32_t, 3>;

  void look_at_fresh();
  bool split_once();
  bool moves(const RefinedTriangles::Triangle& triangle) const;
  State judge(const RefinedTriangles::Triangle& triangle) const;
  double length_of(const Edge& edge) const;
  bool is_torn(const Candidate& one) const;
  bool is_narrow_piece(const RefinedTriangles::Triangle& triangle) const;
  void propose(const std::vector<std::uint32_t>& triangles);
  Candidate candidate(const Edge& edge, std::uint32_t source) const;
  VertexTarget target_of(const Question& question) const;
  template <class Condition>
  void take_out(Condition&& condition);
  const Candidate* find(const Edge& edge) const;
  void mark(std::uint32_t triangle, std::vector<std::uint8_t>& marked) const;
  template <class Split>
  void mark_off(const std::array<const Candidate*, 3>& of_edge, Split&& split) const;
  void find_whole_edges();
  void keep_to_limit(std::vector<std::uint8_t>& marked);
  void split(const std::vector<std::uint8_t>& marked);

  const MeshParts& parts_;
  const OffsetProver prover_;
  const InterpolatedTargets& targets_;
  RefinedTriangles& triangles_;
  std::vector<RefinedVertex> vertices_;
  RefinerOptions options_;
  std::vector<State> state_;           // of each triangle
  std::vector<Candidate> candidates_;  // of edges that are not split, sorted by edge
  std::vector<std::uint8_t> marked_;   // of each candidate: 1 if this round splits its edge
  /// Answers for candidates of this round that are gone, sorted by place: a round that is done again asks for most of
  /// them again. A prism over a star of 500 corners takes 0.6 of the time with them, other models 0.9 to 1.
  std::vector<std::pair<Question, VertexTarget>> answered_;
  int round_ = 0;                     // of the present stage
  std::vector<std::uint32_t> fresh_;  // triangles that this round is to look at
  /// At the start of the present round; and of each triangle now, the one then that it is a piece of.
  struct {
    std::size_t vertices = 0;
    std::vector<State> state;
    std::optional<RefinedTriangles> triangles;
    std::vector<std::uint32_t> fresh;
  } then_;
  std::vector<std::uint32_t> piece_of_;
  // Of each triangle then: whether its pieces may not be split in turn, and whether any of them have been.
  std::vector<std::uint8_t> halved_once_, halved_twice_;
  bool is_second_ = false;  // pieces are split in turn
  bool is_undone_ = false;  // splits of this round have been undone
  double loosened_ = 1;     // how many times the tolerance is that of the present stage
  bool is_cut_short_ = false;
};

}  // namespace vdb_offset
