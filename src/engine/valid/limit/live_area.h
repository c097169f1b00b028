// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ground/numbers/index_set.h"
#include "motion/parts/constrained_surface.h"
#include "vdb_offset/distances.h"

namespace vdb_offset {

/// How much of a surface's area falls short of its distance with each of its vertices.
///
/// The image of a point of a face is the point straight above it, along the face's normal, at the distance. A point is
/// live if it is the closest one to its image: then nothing is in its way. The live area of a vertex is its third of
/// the faces around it, as far as that is live, and next to nothing of the rest, which fronts meet over. Faces that are
/// not on the moving part do not count.
class LiveArea {
 public:
  /// Keeps references to the constrained surface and the distances of its vertices.
  LiveArea(const ConstrainedSurface& constrained, const Distances& distances);

  /// Area of the moving part's faces.
  double whole_area() const { return whole_area_; }
  /// A third of the area of the faces around a vertex, live or not.
  double area(std::uint32_t vertex) const { return area_[vertex]; }

  /// Measures the vertices whose live area is not known yet. \pre each once
  void measure(const std::vector<std::uint32_t>& vertices);
  /// The live area of a vertex; -1 if it was not measured.
  double operator[](std::uint32_t vertex) const { return live_[vertex]; }

  /// Lines across a vertex's faces that live points are looked for on. KeepBorder: for a vertex at a border, along the
  /// border alone, so that the vertex stays in the plane across it. All: to the faces' centres, as for all other
  /// vertices.
  enum class Lines { KeepBorder, All };

  bool is_at_border(std::uint32_t vertex) const;

  /// Positions at its distance that have room for a vertex: of each line, the larger faces' first, the image of the
  /// live point that is nearest to the vertex. In the surface's frame. None where faces around the vertex do not agree
  /// about the outside.
  std::vector<Vec3d> positions_with_room(std::uint32_t vertex, Lines lines) const;

 private:
  struct Image {
    Vec3d position;
    bool live;
  };
  bool counts(std::uint32_t triangle) const;
  double area_of(std::uint32_t triangle) const;
  double find(std::uint32_t vertex) const;
  Vec3d centre(std::uint32_t triangle) const;
  bool faces_agree(std::uint32_t vertex) const;
  std::vector<Vec3d> ends_of_lines(std::uint32_t vertex, std::uint32_t triangle, Lines lines) const;
  Image image(std::uint32_t vertex, std::uint32_t triangle, const Vec3d& along, std::uint32_t& hint) const;
  std::optional<Vec3d> first_live(std::uint32_t vertex, std::uint32_t triangle, const Vec3d& line,
                                  std::uint32_t& hint) const;

  const ConstrainedSurface& constrained_;
  const Surface& surface_;
  const Distances& distances_;
  double whole_area_ = 0;
  std::vector<double> live_;  // of each vertex; negative if it is not known
  std::vector<double> area_;  // of each vertex: a third of that of the faces around it
};

}  // namespace vdb_offset
