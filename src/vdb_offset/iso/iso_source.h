#pragma once

#include <cstdint>
#include <optional>

#include "vdb_offset/iso/solid_boundary.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/query/closest_query.h"
#include "vdb_offset/surface/inside.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// The mesh, in the local frame, what is inside of it, and what distances are measured to.
struct IsoSource {
  Surface surface;  ///< All of the mesh.
  Inside inside;
  std::optional<Boundary> boundary;  ///< Of what is inside, if that is not all of the mesh and no more.
  ClosestQuery query;                ///< Asks the boundary, or else the mesh. Members refer to those before them.

  /// `solidity` tells of a mesh that is not plainly closed; holes as wide as `distance` (world units, below 0 inward),
  /// which a ball of this radius fits into, are filled for distances, too.
  IsoSource(Surface placed, const std::optional<Solidity>& solidity, double distance, Orient orient);
  IsoSource(const IsoSource&) = delete;
  IsoSource& operator=(const IsoSource&) = delete;

  /// The mesh's triangle that one of those asked is part of.
  std::uint32_t given(std::uint32_t triangle) const { return boundary ? boundary->given[triangle] : triangle; }
};

}  // namespace vdb_offset
