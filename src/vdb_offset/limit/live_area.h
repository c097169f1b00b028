#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_offset/base/index_set.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/parts/constrained_surface.h"

namespace vdb_offset {

/// How much of a surface's area falls short of its distance with each of its vertices.
///
/// A point of a face is live if it is the closest one of its image, which is as far along the face's normal as it is to
/// go: then nothing is in its way. What is at stake with a vertex is its third of the faces around it, as far as that
/// is live; of the rest, which fronts meet over, next to nothing. Faces that are no part of the front do not count.
class LiveArea {
 public:
  /// Keeps references to the body and the distances of its vertices.
  LiveArea(const ConstrainedSurface& constrained, const Distances& distances);

  /// Of the front's faces.
  double whole_area() const { return whole_area_; }
  /// A third of the faces around a vertex, live or not.
  double area(std::uint32_t vertex) const;

  /// Finds out about vertices of which that is not known yet.
  void measure(const Indices& vertices);
  /// What is at stake with a vertex that was measured.
  double operator[](std::uint32_t vertex) const { return stake_[vertex]; }

  /// Lines that places are looked for on, across a vertex's faces: only along the border, for one on it, which then
  /// stays in the plane across that; or to the faces' centres.
  enum class Lines { KeepBorder, All };

  /// The images of live points around a vertex, at its distance from the front, which has room for it there: of each of
  /// the faces, the largest first, that of the point nearest to the vertex on such a line. In the surface's frame. None
  /// where faces around the vertex do not agree about the outside.
  std::vector<Vec3d> places(std::uint32_t vertex, Lines lines) const;

 private:
  struct Image {
    Vec3d place;
    bool live;
  };
  bool counts(std::uint32_t triangle) const;
  double area_of(std::uint32_t triangle) const;
  double find(std::uint32_t vertex) const;
  Vec3d centre(std::uint32_t triangle) const;
  bool is_at_border(std::uint32_t vertex) const;
  bool faces_agree(std::uint32_t vertex) const;
  std::vector<Vec3d> ends_of_lines(std::uint32_t vertex, std::uint32_t triangle, Lines lines) const;
  Image image(std::uint32_t vertex, std::uint32_t triangle, const Vec3d& way, std::uint32_t& hint) const;
  std::optional<Vec3d> first_live(std::uint32_t vertex, std::uint32_t triangle, const Vec3d& way,
                                  std::uint32_t& hint) const;

  const ConstrainedSurface& constrained_;
  const Surface& surface_;
  const Distances& distances_;
  double whole_area_ = 0;
  std::vector<double> stake_;  // of each vertex; negative if it is not known
};

}  // namespace vdb_offset
