// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "products/iso/solid_boundary.h"
#include "space/query/closest_query.h"
#include "space/surface/inside.h"
#include "space/surface/surface.h"
#include "vdb_offset/iso_surface.h"

namespace vdb_offset {

/// The source of an iso-surface: the mesh in the local frame, its inside, and the surface that distances are measured
/// to.
struct IsoSource {
  Surface surface;  ///< All of the mesh.
  Inside inside;
  std::optional<Boundary> boundary;  ///< The boundary of the inside, if it is not the mesh itself.
  ClosestQuery query;                ///< Of the boundary, or else of the mesh. Members refer to those before them.

  /// \param solidity of a mesh that is not plainly closed
  /// \param distance world units, below 0 inward: holes that a ball of this radius fits into are filled for distances,
  /// too
  IsoSource(Surface placed, const std::optional<Solidity>& solidity, double distance, Orient orient);
  IsoSource(const IsoSource&) = delete;
  IsoSource& operator=(const IsoSource&) = delete;

  /// The mesh's triangle that a triangle of the query's surface is part of.
  std::uint32_t given(std::uint32_t triangle) const { return boundary ? boundary->given[triangle] : triangle; }
};

}  // namespace vdb_offset
