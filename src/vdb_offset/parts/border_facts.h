#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/surface/border_planes.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// What became of borders, and of what stays in planes.
struct BorderFacts {
  std::vector<SymmetryPlane> planes;  ///< World coordinates.
  std::size_t held_vertices = 0;      ///< Of the surface, that stay in them.
  std::size_t beyond = 0;             ///< Vertices of the surface that end beyond a plane which it lies on one side of.
  std::size_t across_vertices = 0;    ///< Other vertices at borders, which go in the plane across these if they can.
  std::size_t strayed_vertices = 0;   ///< Those of them that leave it by more than a degree,
  double worst_angle = 0;             ///< and the worst of all, in degrees.
};

/// \param way of each vertex of the surface
/// \param excepted of each vertex: 1 if it goes elsewhere for other reasons; empty: none
BorderFacts border_facts(const Surface& surface, std::span<const Vec3d> way, std::span<const std::uint8_t> excepted);

}  // namespace vdb_offset
