// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ground/numbers/index_set.h"
#include "ground/numbers/rounding.h"
#include "motion/parts/constrained_surface.h"
#include "valid/faults/face_faults.h"
#include "valid/faults/pair_faults.h"
#include "valid/faults/rim_crossings.h"
#include "valid/faults/vertex_positions.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

struct Paths;

/// Finds the faults of an offset of a surface, as its vertices are moved about: faces that are inverted, collapsed or
/// crowded (FaceFaults), triangles that meet anew (PairFaults), what the rim of a shell meets (RimCrossings), and
/// vertices that are misplaced (VertexPositions).
///
/// All is judged on coordinates as they will be written, and by these alone, whatever path led there: vertices that are
/// moved to the same positions again have the same faults. Only faces around moved vertices are judged anew. The
/// result does not depend on the number of threads.
///
/// Calls: move_to_ends() or move_all() once; then, in any order, move(), or try_out() and what is taken back of that
/// trial. The queries see where the vertices stand at the time.
class FaultFinder {
 public:
  class Trial;
  /// Which crossings of moved triangles are found: All, or at least one of each triangle, and none of triangles that
  /// have to be taken back for other faults. That is enough to know which vertices have to go back: if all of those are
  /// taken back, until there are no more, no crossing is missed in the end.
  enum class Crossings { All, OneOfEach };
  /// Where a vertex is to stand, world coordinates. Called in parallel.
  using PositionOf = std::function<Vec3d(std::uint32_t)>;

  /// The vertices begin at the source. Keeps references to all but the last two.
  /// \param source positions of the constrained surface's vertices in the input, world coordinates
  /// \param distances of these vertices; those of vertices that are not on the moving part do not matter
  /// \param precision that positions are rounded to
  /// \param source_crossings of the source, if they are known; else they are found
  FaultFinder(const ConstrainedSurface& constrained, std::span<const Vec3d> source, const Distances& distances,
              const Rounding& precision, std::optional<SelfCrossings> source_crossings = {});

  /// Moves some vertices, and finds the faults around them. `ends`, if they are given, are paths at whose ends vertices
  /// stand: what is known of the ends need not be found again. \pre `moved` is sorted, each once; no trial is open
  void move(const Indices& moved, const PositionOf& position_of, const Paths* ends = nullptr);
  /// Moves some vertices, all or some of which can be taken back by the trial that is returned.
  /// \pre `moved` is sorted, each once; no other trial is open
  [[nodiscard]] Trial try_out(const Indices& moved, const PositionOf& position_of,
                              Crossings crossings = Crossings::All);
  /// Moves some vertices to the ends of their paths, by a trial that finds one crossing of each triangle at least.
  [[nodiscard]] Trial try_ends(const Paths& paths, const Indices& moved);
  /// Moves all vertices, and finds all faults.
  void move_all(const PositionOf& position_of);
  /// Moves all vertices to the ends of their paths, and finds all faults.
  void move_to_ends(const Paths& paths);
  /// Moves some vertices there, and finds the faults around them. \pre `moved` is sorted, each once; no trial is open
  void move_to_ends(const Paths& paths, const Indices& moved);

  /// Whether any face is faulty or any triangles meet anew; misplaced vertices do not count.
  bool any() const;
  FaultCounts count() const;
  /// Vertices that are too far from the moving part, or on the wrong side of it or of a wall (see border_planes.h).
  const Indices& misplaced() const { return parts_->misplaced; }
  /// Pairs that meet where the source's do not, away from where those do.
  const std::vector<TrianglePair>& crossings() const { return parts_->pairs.faulty(); }
  /// Calls visit(vertex) for each corner of each faulty face, and of each face of a crossing: not of faces that
  /// is_left_out(triangle) is true of, nor of crossings both of whose faces are left out. Always for the corners of
  /// what a rim meets. A vertex is visited as often as it is such a corner.
  template <class Visit, class LeftOut>
  void for_each_faulty_corner(Visit&& visit, LeftOut&& is_left_out) const;
  template <class Visit>
  void for_each_faulty_corner(Visit&& visit) const {
    for_each_faulty_corner(visit, [](std::uint32_t) { return false; });
  }
  /// Calls visit(s, t) for each pair of triangles that cross, and visit(t, t) for each faulty face; not for what a rim
  /// meets.
  template <class Visit>
  void for_each_fault(Visit&& visit) const {
    for (const auto t : parts_->faces.faulty()) visit(t, t);
    for (const auto& [s, t] : parts_->pairs.faulty()) visit(s, t);
  }
  /// What is wrong with each of the input's `count` faces; empty if nothing is. What a rim meets does not count.
  std::vector<FaceFault> of_faces(std::size_t count) const;
  /// Folded vertices (see is_folded()) whose faces cross the source; only putting them back on the source removes that.
  Indices unmovable_folds() { return parts_->faces.unmovable_folds(); }
  /// Misplaced vertices, and corners of all faults.
  Indices faulty_vertices();

  /// Exact distance of a vertex from the moving part.
  double distance_of(std::uint32_t vertex) const { return parts_->positions.distance(vertex); }
  /// The moving part's triangle that is closest to a vertex; kNone if the vertex is where it was, or not on the moving
  /// part.
  std::uint32_t closest_to(std::uint32_t vertex) const { return parts_->positions.closest(vertex); }
  /// How far the precision's rounding may have moved a vertex, world units.
  double rounding(std::uint32_t vertex) const { return parts_->positions.rounding(vertex); }
  bool on_right_side(std::uint32_t vertex) const { return parts_->positions.on_right_side(vertex); }
  /// World coordinates of all vertices, as they will be written.
  std::span<const Vec3d> positions() const { return parts_->positions.all(); }
  const SourceCrossings& source_crossings() const { return parts_->pairs.source_crossings(); }
  /// New pairs near crossings of the source, which have to slide (see source_crossings.h): they are no faults. None if
  /// the source has more crossings than are listed.
  std::vector<TrianglePair> crossings_near_source() { return parts_->pairs.near_source(); }

 private:
  /// What a trial has done with a vertex.
  enum class Mark : std::uint8_t { AsBefore, Moved, ToTakeBack };

  /// The parts refer to each other, and stay where they are when the finder is moved.
  struct Parts {
    Parts(const ConstrainedSurface& constrained_surface, std::span<const Vec3d> source, const Distances& distances,
          const Rounding& precision, std::optional<SelfCrossings> source_crossings);
    Parts(const Parts&) = delete;
    Parts& operator=(const Parts&) = delete;

    bool has(std::uint32_t triangle, Mark mark) const;
    Indices triangles_around(const Indices& vertices);
    void find_misplaced(const Indices& moved);
    void find_rim_crossings(const Indices& moved, const Indices& touched);

    const ConstrainedSurface& constrained;
    const Surface& surface;
    std::vector<Vec3d> rewritten;    // the source as it is written, if that is another than the source
    std::span<const Vec3d> staying;  // where vertices that do not move stand: either of these
    VertexPositions positions;
    PairFaults pairs;
    FaceFaults faces;
    std::optional<RimCrossings> rim;
    Indices misplaced;
    IndexGatherer triangles, vertices;  // empty between uses
    std::vector<Mark> mark;             // of each vertex, by the open trial; AsBefore if there is none
    bool trial_is_open = false;
  };

  void move(const Indices& moved, const PositionOf& position_of, const Paths* ends, Crossings crossings);

  std::span<const Vec3d> source_;
  std::unique_ptr<Parts> parts_;
};

/// A move of some vertices that can be taken back, all of it or some vertices. What is not taken back is kept when the
/// trial ends. While it lasts, its finder must not be moved, nor its vertices by other calls.
class [[nodiscard]] FaultFinder::Trial {
 public:
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;
  ~Trial();

  /// Puts some of the trial's vertices back where they were before it, and knows again the faults that were there.
  /// \pre sorted, each once; vertices of the trial
  void take_back(const Indices& vertices);

 private:
  friend class FaultFinder;
  Trial(FaultFinder& finder, const Indices& moved, const PositionOf& position_of, Crossings crossings);

  Parts& parts_;
  Indices vertices_, triangles_;  // that were moved, and those around them
  // How both were before the trial; and all pairs that were faulty then.
  std::vector<VertexPositions::Standing> standings_;
  std::vector<FaceFaults::Fault> faults_;
  std::vector<TrianglePair> pairs_;
};

template <class Visit, class LeftOut>
void FaultFinder::for_each_faulty_corner(Visit&& visit, LeftOut&& is_left_out) const {
  const auto visit_corners = [&](std::uint32_t t) {
    for (const auto v : parts_->surface.triangles[t]) visit(v);
  };
  for (const auto t : parts_->faces.faulty())
    if (!is_left_out(t)) visit_corners(t);
  for (const auto& [s, t] : parts_->pairs.faulty()) {
    if (is_left_out(s) && is_left_out(t)) continue;
    visit_corners(s);
    visit_corners(t);
  }
  if (parts_->rim) parts_->rim->for_each_corner(visit);
}

}  // namespace vdb_offset
