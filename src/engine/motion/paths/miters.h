// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "ground/mesh/planes_around.h"
#include "ground/numbers/index_set.h"
#include "motion/paths/exact_corners.h"
#include "motion/paths/own_distances.h"
#include "motion/paths/propagate.h"
#include "space/curve/curve_query.h"
#include "space/query/closest_query.h"
#include "space/query/obstacles.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/options.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// The miter of a vertex: its displacement to where the planes around it meet that are moved by its distance.
struct Miter {
  std::uint32_t vertex;
  Vec3d displacement;     ///< World units; rounded as those of paths are.
  double distance;        ///< Exact unsigned distance to the surface there; to the exact one, where that is known.
  double nearer;          ///< That to the triangles, if they are nearer than the exact surface is; else 0.
  std::uint32_t closest;  ///< The triangle of the surface that is closest there.
  VertexState state;      ///< Reached, where the end is at the distance as well; Mitered; or Cut.
  double excess;          ///< By how much more than its distance a plane is moved, as a share of the distance.
  /// What is closest there is neither of the vertex's corner nor goes on in its planes: of miters that get into each
  /// other's way those do not stay.
  bool gives_way = false;
};

/// Planes through a vertex at the edge of what is offset that its miter has to lie in: those of the faces beside it
/// that stay.
struct MiterWalls {
  std::uint32_t vertex;
  std::vector<Vec3d> normals;  ///< One or two, of unit length.
};

/// The miter of a vertex among some that are sorted by vertex; nullptr if it has none.
const Miter* find_miter(std::span<const Miter> miters, std::uint32_t vertex);

/// Finds the miters of the vertices on creases, of a Surface and of a Polyline alike.
///
/// Distinct planes around a vertex move along their normals by its distance; its miter is the smallest displacement to
/// a point on all of them, or beyond (see miter_point()); if that moves a plane much too far, or is not proven, with
/// Corners::Miter that on the planes of most of the area (see prevailing_point()); at a border, of those that keep to
/// it, or to walls. A miter is proven by exact distances: the surface is no nearer to its end than the distance, and
/// what is nearest there is one of the faces around the vertex, goes on in the plane of one, or is a detail of the
/// corner; or no surface stands between, as is found by going back from the end to where the vertex's faces are nearest
/// (Miter::gives_way). Vertices whose miter is not proven have none, nor have those
/// on edges of more than two faces. With Corners::Round, miters are those whose ends are at the distance themselves, as
/// inward at convex edges: of all positions that are, the one with the faces at the distance, too.
///
/// Where the exact surface is known, its normals are the planes, and all vertices have miters: one that is not on a
/// crease goes along the normal. There, what is nearest to the end may be nearer than the distance by the deflection,
/// if it is of the surface around the vertex.
///
/// Where faces have distances of their own, of one sign, each plane moves by its own, or stays if that is 0.
template <class Query>
class MiterFinder {
 public:
  /// Finds creases, and the miters for a distance of 1. Keeps references.
  /// \param longest a miter may be so many distances long, at least 1, if its end is farther than the distance
  /// \param obstacles to keep off; nullptr without any
  /// \param walls of some vertices, sorted by vertex; referred to
  /// \param exact of the surface, if it is known; not of curves
  MiterFinder(const Query& query, Corners corners, double longest, const Obstacles* obstacles,
              std::span<const MiterWalls> walls = {}, const ExactCorners* exact = nullptr);

  /// The miters that are proven for some distances of the surface's vertices, sorted by vertex. `facts` receives how
  /// many were tried and why others were not kept. The result does not depend on the number of threads.
  /// \param own of the surface's triangles, if faces have distances of their own
  std::vector<Miter> operator()(const Distances& distances, MiterFacts& facts, const OwnDistances* own = nullptr) const;
  /// Of each vertex of the surface: whether it is on a crease.
  const std::vector<std::uint8_t>& on_crease() const { return on_crease_; }
  /// All miters that are no nearer to the surface than the distance, proven or not: to recognise those in an offset
  /// that another program has made.
  std::vector<Miter> all(const Distances& distances, const OwnDistances* own = nullptr) const;

 private:
  struct UnitMiter {
    std::uint32_t vertex;
    Vec3d end;
    double excess;
    std::array<bool, 2> is_above_face;  // inward, outward: the end is at the distance, as far as its own faces show
    bool on_crease;
    bool is_exact;  // its planes are those of the exact surface
    bool at_walls = false;
    bool is_own = false;  // of its faces' own distances
  };

  /// What is asked of the vertices.
  struct Asked {
    const Distances& distances;
    const OwnDistances* own;  // nullptr without any
  };

  /// Where a miter ends for a distance of 1 to the side of `distance`, and whether it is cut there; zero if nowhere.
  std::pair<Vec3d, bool> end_of(const UnitMiter& miter, double distance) const;

  /// Miters, and of each whether it is proven: of a vertex whose planes have no miter that is, on most of them.
  std::pair<std::vector<Miter>, std::vector<std::uint8_t>> prove(const Asked& asked) const;
  std::pair<std::vector<Miter>, std::vector<std::uint8_t>> prove(std::span<const UnitMiter> units,
                                                                 const Asked& asked) const;
  void prove(std::span<const UnitMiter> some, const Asked& asked, std::span<Miter> miters,
             std::span<std::uint8_t> proven) const;
  bool is_proven(Miter& miter, const UnitMiter& unit, const Vec3d& end, const Closest& closest,
                 const Asked& asked) const;
  void bring_to_exact(std::span<const UnitMiter> units, const Asked& asked, std::span<Miter> miters) const;
  std::vector<UnitMiter> unit_miters_of(const Asked& asked) const;
  UnitMiter own_miter(const UnitMiter& even, double distance, const OwnDistances& own) const;
  const MiterWalls* walls_of(std::uint32_t vertex) const;
  PlanesAround planes_to_meet(std::uint32_t vertex, const ExactCorners* exact) const;
  UnitMiter unit_miter(std::uint32_t vertex, bool on_crease) const;
  UnitMiter prevailing_miter(const UnitMiter& even) const;

  const Query& query_;
  const Corners corners_;
  const double longest_;
  const Obstacles* obstacles_;
  std::span<const MiterWalls> walls_;
  const ExactCorners* exact_;
  std::vector<std::uint8_t> on_crease_;
  std::vector<UnitMiter> miters_;  // of all vertices on creases or known, sorted; `end` is zero of one without a miter
};

extern template class MiterFinder<ClosestQuery>;
extern template class MiterFinder<CurveQuery>;

/// Counts what became of proven miters in the end, by the states of the vertices.
void count_miters(std::span<const Miter> miters, std::span<const VertexState> states, MiterFacts& facts);

/// Vertices whose paths lead to the ends of their miters, and can be given back the paths that they had before.
class MiteredPaths {
 public:
  MiteredPaths() = default;
  /// Gives vertices their miters for paths: straight ones. \pre the miters are sorted by vertex, which paths have
  MiteredPaths(std::span<const Miter> miters, Paths& paths);

  bool empty() const { return others_.empty(); }
  /// Of each vertex of the paths: the distance of its end from the surface if that is farther than was asked, as it is
  /// mitered; 0 of the others. Empty if no vertex is mitered.
  std::span<const double> farther() const { return farther_; }
  /// Of each vertex of the paths: the distance of its end from the triangles, if that is less than was asked, and less
  /// than it is from the exact surface; 0 of the others. Empty if no vertex is mitered.
  std::span<const double> nearer() const { return nearer_; }
  /// Whether a vertex's path leads to the end of its miter now.
  bool is_mitered(std::uint32_t vertex) const;
  /// The displacement of a vertex to the end of its miter, whether or not its path leads there now; nullptr without
  /// one.
  const Vec3d* miter_of(std::uint32_t vertex) const;
  /// Whether a displacement of a vertex is its miter's.
  bool is_miter(std::uint32_t vertex, const Vec3d& displacement) const;
  /// The vertices whose miters have been taken back.
  Indices taken_back() const;
  /// Gives those of some vertices that are mitered the paths back that they had before, and returns them.
  Indices take_back(const Indices& vertices, Paths& paths) { return exchange(vertices, paths, true); }
  /// Gives those of some vertices whose miters have been taken back these again, and returns them.
  Indices miter_again(const Indices& vertices, Paths& paths) { return exchange(vertices, paths, false); }
  /// Leaves out some vertices whose miters have been taken back: they are not to have these again.
  void forget(const Indices& vertices);

 private:
  /// The other path of a vertex: that before it was mitered, or where that has been given back, the miter.
  struct Other {
    std::uint32_t vertex;
    Vec3d displacement;
    double achieved;
    VertexState state;
    std::uint32_t closest;
    std::vector<Vec3d> trace;
    double farther, nearer;  // of the miter, always
    Vec3d miter;             // its displacement
    bool is_mitered = true;
  };

  std::vector<Other>::const_iterator find(std::uint32_t vertex) const;
  Indices exchange(const Indices& vertices, Paths& paths, bool are_mitered);

  std::vector<Other> others_;  // sorted by vertex
  std::vector<double> farther_, nearer_;
};

}  // namespace vdb_offset
