#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/base/index_set.h"
#include "vdb_offset/base/rounding.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/parts/constrained_surface.h"
#include "vdb_offset/statistics.h"
#include "vdb_offset/validity/clearance.h"
#include "vdb_offset/validity/rim_crossings.h"
#include "vdb_offset/validity/source_crossings.h"
#include "vdb_offset/validity/triangle_crossings.h"
#include "vdb_offset/validity/vertex_positions.h"

namespace vdb_offset {

struct Paths;

/// What is wrong with an offset of a surface, as its vertices are moved about.
///
/// A face is inverted if it faces against the direction away from the front at its centre and at each corner (there,
/// its distance has folded over; see VertexPositions) or, being no part of the front, against its own source; collapsed
/// if its area is below 1e-6 of the source's, crowded if it is too near to an obstacle or meets the source where it
/// must not: anywhere but where sheets of the source cross (see source_crossings.h). Of a shell, the other skin must
/// not be met either, and the rim is judged as well (see rim_crossings.h). Crossings are found with exact predicates.
/// All is judged on coordinates as they will be written, by these alone, whatever way led there: another look at the
/// same places finds the same. Only what is around what has moved is judged anew. The result does not depend on the
/// number of threads.
class FaultFinder {
 public:
  /// `source` holds where the body's vertices stand in the input, world coordinates; they begin there. `distances` are
  /// theirs; those that are not on the front do not matter. Places are rounded to `precision`.
  /// Keeps references to all but the last.
  /// `source_crossings`, if they are known of the same source already, need not be looked for again.
  FaultFinder(const ConstrainedSurface& constrained, std::span<const Vec3d> source, const Distances& distances,
              Rounding precision, std::optional<SelfCrossings> source_crossings = {});

  /// Moves vertices to place_of(vertex), world coordinates, which is called in parallel, and finds what is wrong around
  /// them. Where they stand at the ends of paths, what is known of those need not be found again.
  void look(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of, const Paths* ends = nullptr);
  /// The same, for vertices of which some may be taken back.
  void try_out(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of);
  /// The same, but of the crossings of each face around them at least one is found, not all; none of what has to be
  /// taken back for other faults. Enough to tell which of these vertices have to go back: those are to be taken back,
  /// so that none is missed in the end.
  void glance(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of);
  /// Puts some of those that were last tried out, or glanced at, back where they were before, and knows again what was
  /// wrong there.
  void take_back(const Indices& vertices);
  /// The same as look(), for all vertices.
  void look_everywhere(const std::function<Vec3d(std::uint32_t)>& place_of);
  /// Puts all vertices to the ends of their paths, and finds what is wrong there.
  void look_at_ends(const Paths& paths);

  bool any() const { return !faces_.empty() || !crossings_.empty() || (rim_ && rim_->count() > 0); }
  FaultCounts count() const;
  /// Vertices that are too far from the surface, or on the wrong side of it or of a wall (see border_planes.h).
  const Indices& misplaced() const { return misplaced_; }
  /// Pairs that meet where the source's do not, away from where those do.
  const std::vector<TrianglePair>& crossings() const { return crossings_; }
  /// Calls visit(vertex) for each corner of each face that is wrong, and of each that crosses another; not of those
  /// that are left out (triangle), or of which both are, but always of what a rim meets.
  template <class Visit, class LeftOut>
  void for_each_faulty_corner(Visit&& visit, LeftOut&& is_left_out) const;
  template <class Visit>
  void for_each_faulty_corner(Visit&& visit) const {
    for_each_faulty_corner(visit, [](std::uint32_t) { return false; });
  }
  /// Calls visit(s, t) for each pair of triangles that cross, and visit(t, t) for each that is wrong by itself; not for
  /// what a rim meets.
  template <class Visit>
  void for_each_fault(Visit&& visit) const {
    for (const auto t : faces_) visit(t, t);
    for (const auto& [s, t] : crossings_) visit(s, t);
  }
  /// Folded vertices (see is_folded()) whose faces meet the source around them, which only ends where they stay on it.
  Indices caught();
  /// All vertices that something is wrong with.
  Indices faulty_vertices();

  /// Exact distance of a vertex as it was last looked at.
  double distance_of(std::uint32_t vertex) const { return stands_.distance(vertex); }
  /// The front's triangle that is closest to it; kNone if it is where it was, or not on the front.
  std::uint32_t closest_to(std::uint32_t vertex) const { return stands_.closest(vertex); }
  /// How far the precision's rounding may have moved a vertex.
  double rounding(std::uint32_t vertex) const { return stands_.rounding(vertex); }
  bool on_right_side(std::uint32_t vertex) const { return stands_.on_right_side(vertex); }
  /// World coordinates, as they will be written.
  std::span<const Vec3d> places() const { return stands_.places(); }
  const SourceCrossings& source_crossings() const { return *source_crossings_; }
  /// New pairs within two rings of one of those, which has to slide: as things stand. Looks for them, unless there are
  /// more crossings of the source than are listed.
  std::size_t crossings_near_source();

 private:
  enum class Fault : std::uint8_t { None, Inverted, Collapsed, Crowded };

  /// How things were before vertices were moved. Sorted, as are the triangles around them.
  struct Before {
    Indices vertices, triangles;
    std::vector<VertexPositions::VertexPosition> stands;
    std::vector<Fault> faults;
    std::vector<TrianglePair> crossings;  // all
  };

  void find_folded();
  /// What decides where triangles meet.
  std::span<const Vec3d> in_file() const { return stands_.in_file(); }
  Indices triangles_around(const Indices& vertices);
  enum class Crossings { All, OneOfEach };
  enum class Position : std::uint8_t { AsBefore, Out, ToTakeBack };
  void look_everywhere(const std::function<Vec3d(std::uint32_t)>& place_of, const Paths* ends);
  void look(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of, const Paths* ends,
            Crossings crossings);
  void remember(const Indices& moved);
  bool is_misplaced(std::uint32_t vertex) const;
  bool is_beyond_wall(std::uint32_t vertex) const;
  Fault judge(std::uint32_t triangle) const;
  bool has_bound(std::uint32_t triangle) const;
  bool goes_along(std::uint32_t resting, std::uint32_t other) const;
  bool is_crowded(std::uint32_t triangle) const;
  bool is_near_obstacle(std::uint32_t triangle) const;
  bool meets_source(std::uint32_t triangle) const;
  bool meets_other_skin(std::uint32_t triangle) const;
  bool is_fault(const TrianglePair& pair) const;
  bool still_touches(const TrianglePair& pair) const;
  bool matters(std::uint32_t triangle) const;
  bool is_out(std::uint32_t triangle) const;
  void mark_to_take_back();
  bool is_to_take_back(std::uint32_t triangle) const;
  void update_finder(const Indices& touched);
  void forget_crossings_of_updated();
  void add_crossings_of_updated();
  void look_at_rim(const Indices& moved, const Indices& touched);
  void take_back_crossings(const Indices& touched);
  void look_for_crossings(const Indices& moved, const Indices& touched, Crossings crossings);

  const ConstrainedSurface& constrained_;
  const Surface& surface_;
  std::span<const Vec3d> source_;
  std::vector<Vec3d> rewritten_;    // the source as it is written, if that is another than it is
  std::span<const Vec3d> staying_;  // where what does not move stands: either
  VertexPositions stands_;
  std::vector<std::uint8_t> folded_;  // of each vertex; empty until something may be caught
  std::vector<Fault> fault_;          // of each triangle
  IndexGatherer touched_;             // triangles
  IndexGatherer wrong_;               // vertices
  Indices faces_, misplaced_;
  std::vector<TrianglePair> crossings_;
  Before before_;
  std::vector<Position> position_;        // of each vertex, beside what was before
  std::optional<CrossingFinder> finder_;  // from the first look on
  std::optional<SourceCrossings> source_crossings_;
  std::optional<CrossingFinder> source_finder_;      // where what has moved must not meet the source
  std::optional<CrossingFinder> other_skin_finder_;  // where a shell's other skin is not the source
  std::optional<RimCrossings> rim_;
  std::optional<ClearanceFinder> clearance_;
};

template <class Visit, class LeftOut>
void FaultFinder::for_each_faulty_corner(Visit&& visit, LeftOut&& is_left_out) const {
  const auto visit_corners = [&](std::uint32_t t) {
    for (const auto v : surface_.triangles[t]) visit(v);
  };
  for (const auto t : faces_)
    if (!is_left_out(t)) visit_corners(t);
  for (const auto& [s, t] : crossings_) {
    if (is_left_out(s) && is_left_out(t)) continue;
    visit_corners(s);
    visit_corners(t);
  }
  if (rim_) rim_->for_each_corner(visit);
}

}  // namespace vdb_offset
