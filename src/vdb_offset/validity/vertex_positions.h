#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "vdb_offset/base/index_set.h"
#include "vdb_offset/base/rounding.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/parts/constrained_surface.h"

namespace vdb_offset {

struct Paths;

/// Where the vertices of an offset stand, as they are moved about, and where the front is from there.
///
/// All is told of places as they will be written, and by these alone: neither what was known of other places nor the
/// order of a search has a say. A place may be as near to several points of the front, as on the middle sheet of a
/// wall; what a face is to look away from there is each of them.
class VertexPositions {
 public:
  /// What is known of a vertex.
  struct VertexPosition {
    Vec3d place, written,
        away;  ///< `away` is the way there from the closest point; `written` only in a metric's space.
    double distance;
    std::uint32_t closest;
    std::uint8_t right_side, nearness;
  };

  /// The vertices stand at `source`, world coordinates. Keeps references to all but the last.
  VertexPositions(const ConstrainedSurface& constrained, std::span<const Vec3d> source, const Distances& distances,
                  Rounding precision);

  /// Moves vertices to place_of(vertex), world coordinates, which is called in parallel. Where they stand at the ends
  /// of paths, what is closest there is taken from those; where another point of the front may be as near, that is
  /// looked for when a face asks for it.
  void move(const Indices& vertices, const std::function<Vec3d(std::uint32_t)>& place_of, const Paths* ends);
  /// Has at least one corner of each of these triangles know all that is near: mostly that is enough.
  void look_around(const Indices& triangles);

  VertexPosition operator[](std::uint32_t vertex) const;
  void put_back(std::uint32_t vertex, const VertexPosition& stand);

  std::span<const Vec3d> places() const { return place_; }
  /// The same in the file, where that is another space.
  std::span<const Vec3d> in_file() const { return constrained_.file ? written_ : place_; }
  const Vec3d& place(std::uint32_t vertex) const { return place_[vertex]; }
  /// Whether a vertex stands elsewhere than where it stood, and than that is in a coarser format.
  bool has_moved(std::uint32_t vertex) const;
  bool has_moved_corner(std::uint32_t triangle) const;
  double distance(std::uint32_t vertex) const { return distance_[vertex]; }
  std::uint32_t closest(std::uint32_t vertex) const { return closest_[vertex]; }
  bool on_right_side(std::uint32_t vertex) const { return right_side_[vertex]; }
  /// How far the precision's rounding may have moved a vertex.
  double rounding(std::uint32_t vertex) const;
  /// Too far from the front, or on the wrong side of it.
  bool is_misplaced(std::uint32_t vertex) const;

  /// Whether a triangle of the front turns its back to the way that leads away from it, at each corner and at the
  /// centre as far as they are off the front: where several points are as near, to the way from any of them. With
  /// nothing off the front, whether it turns its back to its source.
  bool faces_against_front(std::uint32_t triangle) const;
  /// Twice its area, as a vector, where it stands.
  Vec3d twice_area(std::uint32_t triangle, std::span<const Vec3d> at) const;

 private:
  /// What is known of the front near a vertex: the closest point alone, of those around the triangle where a path has
  /// found it; that it is the only one as near; or that there are others.
  enum Nearness : std::uint8_t { Found, Sole, Tied };

  void put(std::uint32_t vertex, const Vec3d& place);
  void measure(std::span<const std::uint32_t> vertices, const Paths* ends);
  void look_closely(std::span<const std::uint32_t> vertices);
  bool is_known(std::uint32_t vertex, const Vec3d& x, const Paths& ends) const;
  void take(std::uint32_t vertex, const Vec3d& x, const Closest& closest, Nearness nearness);
  Vec3d in_frame(std::uint32_t vertex) const { return place_[vertex] - constrained_.front.surface().origin; }
  int side(std::uint32_t triangle) const;
  bool looks_away(const Vec3d& outward, const Vec3d& x, const Vec3d& away, double distance, bool tied) const;
  bool looks_away(const Vec3d& outward, std::uint32_t vertex) const;

  const ConstrainedSurface& constrained_;
  const Surface& surface_;
  std::span<const Vec3d> source_;
  const Distances& distances_;
  double near_;  // what is nearer to the front says nothing about sides
  Rounding precision_;
  std::vector<Vec3d> place_, away_;  // of each vertex, as the rest
  std::vector<Vec3d> written_;       // its place in the file, if that is another space
  std::vector<double> distance_;
  std::vector<std::uint32_t> closest_;
  std::vector<std::uint8_t> right_side_, nearness_;
};

}  // namespace vdb_offset
