// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "ground/numbers/index_set.h"
#include "ground/numbers/rounding.h"
#include "motion/parts/constrained_surface.h"
#include "vdb_offset/distances.h"

namespace vdb_offset {

struct Paths;

/// Twice a triangle's area, as a vector along its normal, with its corners at some positions.
inline Vec3d twice_area(const std::array<std::uint32_t, 3>& triangle, std::span<const Vec3d> at) {
  const auto& [a, b, c] = triangle;
  return (at[b] - at[a]).cross(at[c] - at[a]);
}

/// Where the vertices of an offset stand, as they are moved about, and where the moving part is from there.
///
/// Everything is evaluated at positions as they will be written, and at these alone: neither what was known of other
/// positions nor the order of a search has an influence. A position may be as near to several points of the moving
/// part, as on the middle sheet of a wall: then a face is to look away from each of them, and a vertex counts as
/// outside if any of these points has it outside.
class VertexPositions {
 public:
  /// What is known of the moving part near a vertex: Found, the closest point of the triangles around the one that a
  /// path has found; Sole, the closest point of all, with none as near; Tied, with others as near.
  enum class Nearness : std::uint8_t { Found, Sole, Tied };

  /// What is known of a vertex.
  struct Standing {
    Vec3d position, written;  ///< World coordinates, and those in the file: another space if there is a metric.
    Vec3d away;               ///< From the closest point to the position.
    double distance;
    std::uint32_t closest;
    std::uint8_t right_side;
    Nearness nearness;
  };

  /// The vertices stand at `source`, world coordinates. Keeps references to all but the last.
  VertexPositions(const ConstrainedSurface& constrained, std::span<const Vec3d> source, const Distances& distances,
                  Rounding precision);

  /// Moves vertices to position_of(vertex), world coordinates, which is called in parallel. Where they stand at the
  /// ends of paths, the closest triangle is taken from those; whether another point of the moving part is as near is
  /// found when a face asks for it.
  void move(const Indices& vertices, const std::function<Vec3d(std::uint32_t)>& position_of, const Paths* ends);
  /// Finds for at least one corner of each of these triangles whether several points are as near: all of those that
  /// faces will ask for, in most cases, together.
  void find_ties_around(const Indices& triangles);

  Standing operator[](std::uint32_t vertex) const;
  /// Puts a vertex back to where it had this standing.
  void put_back(std::uint32_t vertex, const Standing& standing);

  /// World coordinates of all vertices, as they will be written.
  std::span<const Vec3d> all() const { return position_; }
  /// Coordinates in the file, which are those of another space if there is a metric. They decide where triangles meet.
  std::span<const Vec3d> in_file() const { return constrained_.file ? written_ : position_; }
  const Vec3d& at(std::uint32_t vertex) const { return position_[vertex]; }
  /// Whether a vertex stands elsewhere than in the source, and than the source is in a coarser format.
  bool has_moved(std::uint32_t vertex) const;
  bool has_moved_corner(std::uint32_t triangle) const;
  /// Exact distance from the moving part; 0 of a vertex that has not moved, or is not on the moving part.
  double distance(std::uint32_t vertex) const { return distance_[vertex]; }
  /// The closest triangle of the moving part; kNone of a vertex that has not moved, or is not on the moving part.
  std::uint32_t closest(std::uint32_t vertex) const { return closest_[vertex]; }
  bool on_right_side(std::uint32_t vertex) const { return right_side_[vertex] && !is_beyond_wall(vertex); }
  /// How far the precision's rounding may have moved a vertex, world units.
  double rounding(std::uint32_t vertex) const;
  /// Whether a vertex is too far from the moving part, or on the wrong side of it or of a wall.
  bool is_misplaced(std::uint32_t vertex) const;

  /// Whether a triangle of the moving part turns its back to the direction that leads away from the part, at each
  /// corner and at the centre, as far as these are off the part: where several points are as near, to the direction
  /// from any of them. With nothing off the part, whether the triangle turns its back to its source.
  bool faces_against_part(const std::array<std::uint32_t, 3>& triangle) const;

 private:
  void put(std::uint32_t vertex, const Vec3d& position);
  void measure(std::span<const std::uint32_t> vertices, const Paths* ends);
  void measure_exactly(std::span<const std::uint32_t> vertices);
  bool is_known(std::uint32_t vertex, const Vec3d& x, const Paths& ends) const;
  void take(std::uint32_t vertex, const Vec3d& x, const Closest& closest, Nearness nearness);
  bool is_on_side(int side, const Vec3d& x, const Closest& closest) const;
  bool is_beyond_wall(std::uint32_t vertex) const;
  Vec3d in_frame(std::uint32_t vertex) const { return position_[vertex] - constrained_.moving_part.surface().origin; }
  bool looks_away(const Vec3d& outward, const Vec3d& x, const Vec3d& away, double distance, bool tied) const;
  bool looks_away(const Vec3d& outward, std::uint32_t vertex) const;

  const ConstrainedSurface& constrained_;
  const Surface& surface_;
  std::span<const Vec3d> source_;
  const Distances& distances_;
  double near_;  // world units: a position that is nearer to the moving part says nothing about sides
  Rounding precision_;
  // Of each vertex.
  std::vector<Vec3d> position_, away_;
  std::vector<Vec3d> written_;  // its coordinates in the file, if those are of another space
  std::vector<double> distance_;
  std::vector<std::uint32_t> closest_;
  std::vector<std::uint8_t> right_side_;
  std::vector<Nearness> nearness_;
};

}  // namespace vdb_offset
